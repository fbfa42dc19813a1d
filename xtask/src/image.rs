//! Building the bare-metal image of `firmware/smoke`.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::bare::{Bare, Choice};
use crate::board::Board;
use crate::run;

const PACKAGE: &str = "saltus-smoke";

/// The command that builds the image.
pub(crate) fn command(board: &Board, core: Choice) -> Result<Command> {
    command_with(board, core, board.rustflags)
}

fn command_with(board: &Board, core: Choice, rustflags: &[&str]) -> Result<Command> {
    let bare = Bare::find(board.target, core)?;
    println!("{}: {}; {bare}", board.name, board.processor);
    let mut build = bare.build_with(rustflags);
    build
        .current_dir(run::root().join("firmware"))
        .args(["--package", PACKAGE, "--locked"])
        .env("SALTUS_BOARD", board.name);
    Ok(build)
}

/// Builds the image and returns where it is.
pub(crate) fn build(board: &Board, core: Choice) -> Result<PathBuf> {
    build_with(board, core, board.rustflags, &[])
}

/// As [`build`], with other compiler flags and with features.
pub(crate) fn build_with(
    board: &Board,
    core: Choice,
    rustflags: &[&str],
    features: &[&str],
) -> Result<PathBuf> {
    let mut build = command_with(board, core, rustflags)?;
    build.args([
        "--quiet",
        "--message-format=json-render-diagnostics",
        "--features",
    ]);
    build.arg(features.join(",")).stderr(Stdio::inherit());
    let messages = run::stdout(&mut build)?;
    let executable = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .find_map(|message| message["executable"].as_str().map(PathBuf::from));
    executable.with_context(|| format!("cargo built no executable of {PACKAGE}"))
}
