//! `cargo xtask verdicts`: every task in both simulators ends as `jump-planner/tasks/expected.toml` says, and the document shows what came out.
//!
//! The same runs leave a gallery, so that nothing is simulated twice.
//!
//! A verdict that differs, for better or worse, fails and is named with its task: whoever changed it looks at the run and writes the new
//! one down.

use std::fs;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};

use crate::{mujoco, run};

/// The file of expected verdicts.
pub(crate) const EXPECTED: &str = "jump-planner/tasks/expected.toml";
/// Where the runs' reports and their page are left, which `cargo xtask report` looks at.
const GALLERY: &str = "target/verdicts-check";
/// Where the table of verdicts stands.
const DOCUMENT: &str = "docs/JUMPS.md";

/// Arguments of `cargo xtask verdicts`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let gallery = run::root().join(GALLERY);
    run::remove_folder(&gallery)?;
    let mut saltus = mujoco::saltus()?;
    saltus.args(["verdicts", "--expect", EXPECTED, "--out"]);
    saltus.arg(&gallery);
    let output = saltus.stderr(Stdio::inherit()).output()?;
    let table = String::from_utf8(output.stdout)?;
    print!("{table}");
    ensure!(
        output.status.success(),
        "a verdict changed: look at the run, and write the new one down if it is right"
    );
    let document = fs::read_to_string(run::root().join(DOCUMENT)).context(DOCUMENT)?;
    shows(&document, &table)
}

/// Every line of the document's table is one of those that were printed. It is the table with this one's head.
fn shows(document: &str, table: &str) -> Result<()> {
    let head = table.lines().next().unwrap_or_default();
    let below = document.lines().skip_while(|line| *line != head);
    let shown: Vec<&str> = below.skip(2).take_while(|line| !line.is_empty()).collect();
    let printed: Vec<&str> = table.lines().collect();
    ensure!(!shown.is_empty(), "{DOCUMENT} has no table of verdicts");
    for line in &shown {
        ensure!(
            printed.contains(line),
            "{DOCUMENT} shows what `saltus verdicts` does not print any more:\n{line}"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::shows;

    #[test]
    fn a_stale_line_is_found() {
        let table =
            "| task | m |\n|---|---|\n| `a1/lateral` | 0.007 |\n| `icub/torque` | 0.001 |\n";
        assert!(shows(table, table).is_ok());
        assert!(shows(&table.replace("0.007", "0.008"), table).is_err());
        assert!(shows("no table", table).is_err());
    }
}
