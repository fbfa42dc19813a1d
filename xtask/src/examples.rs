//! `cargo xtask examples`: the examples that a user would copy, run. Each fails by itself when it is not true any more.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

use crate::run;

/// Crate and example.
const EXAMPLES: [(&str, &str); 17] = [
    ("so3", "attitude"),
    ("rbd-core", "double_pendulum"),
    ("dense-qp", "grip"),
    ("ocp-solver", "swing_up"),
    ("srb-opt", "thrust_vector_flip"),
    ("wb-opt", "hop"),
    ("wbc-qp", "squat"),
    ("wbc-qp", "arm"),
    ("wbc-qp", "trot"),
    ("wbc-qp", "slope"),
    ("landing", "drop"),
    ("jump-control", "track"),
    ("jump-machine", "faults"),
    ("state-est", "estimate"),
    ("robot-link", "cut_cable"),
    ("contact-sim", "catch"),
    ("model-import", "describe"),
];

/// Arguments of `cargo xtask examples`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let built = build()?;
    for (package, example) in EXAMPLES {
        let file = format!("{package}/examples/{example}.rs");
        let program = built
            .iter()
            .find(|path| path.file_stem() == Some(example.as_ref()));
        let mut command = Command::new(program.with_context(|| format!("{file} was not built"))?);
        command.current_dir(run::root());
        run::succeed(command.stdout(Stdio::null())).with_context(|| file.clone())?;
        println!("{file}");
    }
    Ok(())
}

/// Builds the examples of the whole workspace at once, as its tests do, so that a crate has the features that it has there and is
/// not compiled again; returns the programs.
fn build() -> Result<Vec<PathBuf>> {
    let mut cargo = run::cargo();
    cargo.args(["build", "--quiet", "--workspace", "--examples"]);
    cargo.arg("--message-format=json-render-diagnostics");
    Ok(run::executables(&run::stdout(&mut cargo)?).collect())
}
