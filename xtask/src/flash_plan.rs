//! `cargo xtask flash-plan`: plans `a1/double-backflip` anew and puts its `plan.bin` where the firmware's images read it from flash.
//!
//! The flights of the images change with it: afterwards run `cargo xtask firmware --overwrite`, and see that every goal is met.

use anyhow::{Context, Result};

use crate::run;

/// What the firmware flies, and where it stands.
const TASK: &str = "a1/double-backflip";
const FILE: &str = "firmware/probe/plans/a1-double-backflip.bin";

#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let folder = run::root().join("target/flash-plan");
    run::remove_folder(&folder)?;
    let mut plan = run::cargo();
    plan.args([
        "run",
        "--quiet",
        "--release",
        "--locked",
        "--package",
        "saltus",
    ]);
    plan.args(["--", "plan", TASK, "--out"]);
    run::succeed(plan.arg(&folder))?;
    std::fs::copy(folder.join("plan.bin"), run::root().join(FILE)).context(FILE)?;
    Ok(())
}
