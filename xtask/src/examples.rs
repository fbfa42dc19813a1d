//! `cargo xtask examples`: the examples that a user would copy, run. Each fails by itself when it is not true any more.

use std::process::Stdio;

use anyhow::{Context, Result};

use crate::run;

/// Crate and example.
const EXAMPLES: [(&str, &str); 13] = [
    ("so3", "attitude"),
    ("rbd-core", "double_pendulum"),
    ("dense-qp", "grip"),
    ("ocp-solver", "swing_up"),
    ("srb-opt", "thrust_vector_flip"),
    ("wb-opt", "hop"),
    ("wbc-qp", "squat"),
    ("landing", "drop"),
    ("jump-control", "track"),
    ("jump-machine", "faults"),
    ("state-est", "estimate"),
    ("contact-sim", "catch"),
    ("model-import", "describe"),
];

/// Arguments of `cargo xtask examples`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    for (package, example) in EXAMPLES {
        let mut cargo = run::cargo();
        cargo.args(["run", "--quiet", "--package", package]);
        cargo.args(["--example", example]).stdout(Stdio::null());
        run::succeed(&mut cargo).with_context(|| format!("{package}/examples/{example}.rs"))?;
        println!("{package}/examples/{example}.rs");
    }
    Ok(())
}
