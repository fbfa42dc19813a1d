//! Building the bare-metal images of `firmware/smoke`.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::bare::Bare;
use crate::board::Board;
use crate::run;

/// An image to build.
pub(crate) struct Image<'a> {
    pub(crate) board: &'a Board,
    pub(crate) name: &'a str,
    pub(crate) bare: &'a Bare,
}

/// Builds images side by side: linking takes most of the time, and uses one core. Errors come back from [`Image::command`].
pub(crate) fn build_ahead(board: &Board, bare: &Bare, names: &[&str]) -> Result<()> {
    let mut build = bare.build_with(board.rustflags);
    build
        .current_dir(run::root().join("firmware"))
        .args(["--locked", "--keep-going", "--package", "saltus-smoke"])
        .args(names.iter().flat_map(|name| ["--bin", name]))
        .env("SALTUS_BOARD", board.name);
    run::output(&mut build)?;
    Ok(())
}

impl Image<'_> {
    /// The command that builds the image.
    pub(crate) fn command(&self) -> Command {
        self.command_with(self.board.rustflags)
    }

    fn command_with(&self, rustflags: &[&str]) -> Command {
        let mut build = self.bare.build_with(rustflags);
        build
            .current_dir(run::root().join("firmware"))
            .args(["--locked", "--package", "saltus-smoke", "--bin", self.name])
            .env("SALTUS_BOARD", self.board.name);
        build
    }

    /// Builds the image and returns where it is.
    pub(crate) fn build(&self) -> Result<PathBuf> {
        self.build_with(self.board.rustflags, &[])
    }

    /// As [`Image::build`], with other compiler flags and with features.
    pub(crate) fn build_with(&self, rustflags: &[&str], features: &[&str]) -> Result<PathBuf> {
        let mut build = self.command_with(rustflags);
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
        executable.with_context(|| format!("cargo built no executable of {}", self.name))
    }
}
