//! The tables that Python makes: `tests/peers/*.py` with their peers from pip.

use std::env;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::run;

#[derive(clap::Args)]
pub(super) struct Args {
    /// One task and one repetition: that it works, not how fast.
    #[arg(long)]
    pub(super) short: bool,
}

/// A table of ratios.
#[derive(Clone, Copy)]
pub(super) enum Table {
    Qp,
    Srb,
    WholeBody,
    Wbc,
}

impl Table {
    pub(super) const ALL: [Self; 4] = [Self::Qp, Self::Srb, Self::WholeBody, Self::Wbc];

    /// Its name and its script.
    fn script(self) -> (&'static str, &'static str) {
        match self {
            Self::Qp => ("quadratic programs", "dense_qp.py"),
            Self::Srb => ("single rigid body", "srb_ratio.py"),
            Self::WholeBody => ("whole body", "wb_ratio.py"),
            Self::Wbc => ("whole-body control", "wbc.py"),
        }
    }
}

/// Prepares the peers and prints the table.
pub(super) fn run(table: Table, short: bool) -> Result<()> {
    let root = run::root();
    let peers = root.join("tests/peers");
    let (name, script) = table.script();
    println!("== {name}: tests/peers/{script}");
    let mut setup = Command::new("bash");
    run::succeed(setup.arg(peers.join("setup.sh")).arg("ratios"))?;
    let venv = env::var_os("SALTUS_VENV").map_or_else(|| root.join(".venv"), PathBuf::from);
    let mut python = Command::new(venv.join("bin/python"));
    python.current_dir(&root).arg(peers.join(script));
    if matches!(table, Table::Srb | Table::WholeBody) {
        python.arg("--saltus").arg(saltus()?);
        python.arg("--peer").arg(peers.join("a1_ipopt"));
        if short {
            python.args(["--task", "lateral", "--repeat", "1", "--peer-repeat", "1"]);
        }
    }
    if matches!(table, Table::WholeBody) {
        python
            .arg("--srb")
            .arg(root.join("reference-problems/data/srb"));
    }
    run::succeed(&mut python)
}

/// The program, built as a user builds it.
fn saltus() -> Result<PathBuf> {
    let mut build = run::cargo();
    build.args(["build", "--release", "--quiet", "--package", "saltus"]);
    run::succeed(&mut build)?;
    let metadata = run::stdout(run::cargo().args(["metadata", "--no-deps", "--format-version=1"]))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata)?;
    let target = metadata["target_directory"]
        .as_str()
        .context("no target directory")?;
    Ok(PathBuf::from(target).join("release/saltus"))
}
