//! `cargo xtask verdicts`: every task in both simulators ends as `saltus/expected.toml` says.
//!
//! A verdict that differs, for better or worse, fails and is named with its task: whoever changed it looks at the run and writes the new
//! one down.

use anyhow::{Context, Result};

use crate::{mujoco, run};

/// The file of expected verdicts.
pub(crate) const EXPECTED: &str = "saltus/expected.toml";

/// Arguments of `cargo xtask verdicts`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let mut saltus = mujoco::saltus()?;
    run::succeed(saltus.args(["verdicts", "--expect", EXPECTED]))
        .context("a verdict changed: look at the run, and write the new one down if it is right")
}
