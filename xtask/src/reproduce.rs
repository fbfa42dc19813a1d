//! `cargo xtask reproduce`: both papers in both simulators; every item comes out as `jump-planner/tasks/expected.toml` says, and the page shows all.
//!
//! Whether the papers' claims hold is the answer of `saltus reproduce`; that the answer has not changed unseen is the check.

use std::fs;

use anyhow::{Context, Result, ensure};

use crate::verdicts::EXPECTED;
use crate::{mujoco, run};

/// Arguments of `cargo xtask reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let folder = run::root().join("target/reproduce-check");
    run::remove_folder(&folder)?;
    let mut saltus = mujoco::saltus()?;
    saltus.args(["reproduce", "--expect", EXPECTED, "--out"]);
    run::succeed(saltus.arg(&folder)).context(
        "an item changed: look at its row, and write the new answer down if it is right",
    )?;
    let page = fs::read_to_string(folder.join("index.html"))?;
    for report in page.split("src=\"").skip(1) {
        let name = report.split('"').next().unwrap_or_default();
        ensure!(
            folder.join(name).exists(),
            "the page shows {name}, which is not there"
        );
    }
    Ok(())
}
