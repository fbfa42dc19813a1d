//! `cargo xtask reproduce`: both papers at their quick size; every item is there, and none failed to run.
//!
//! Whether the papers' claims hold is the answer of `saltus reproduce`, not a check.

use std::fs;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::run;

/// Items that must be there: paper, and what the item's name holds.
const ITEMS: [(&str, &str); 24] = [
    ("A", "Table II, lateral jump 30 cm"),
    ("A", "Table II, lateral jump down"),
    ("A", "Table II, 90° spinning jump"),
    ("A", "Table II, diagonal jump"),
    ("A", "Table II, barrel roll"),
    ("A", "Table II, double barrel roll"),
    ("A", "Table II, double backflip"),
    ("A", "Fig. 1, 11"),
    ("A", "Fig. 4"),
    ("A", "Fig. 5"),
    ("A", "Fig. 6"),
    ("A", "Fig. 7, 8a"),
    ("A", "Fig. 8b, 8c"),
    ("A", "Fig. 9, 10"),
    ("A", "V-B"),
    ("A", "Remark 1"),
    ("A", "Remark 2"),
    ("A", "timings optimised on the whole body"),
    ("B", "Fig. 1, 5"),
    ("B", "Fig. 2"),
    ("B", "Fig. 3"),
    ("B", "Fig. 4"),
    ("B", "Fig. 6"),
    ("B", "√(2 g Δh)"),
];

/// Arguments of `cargo xtask reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let folder = run::root().join("target/reproduce-check");
    run::remove_folder(&folder)?;
    let mut saltus = run::cargo();
    saltus.args(["run", "--release", "--quiet", "--package", "saltus", "--"]);
    saltus.args(["reproduce", "--quick", "--json", "--out"]);
    // Exit code 2 tells that a claim does not hold, which is an answer too.
    let output = run::output(saltus.arg(&folder).stderr(Stdio::inherit()))?;
    let report: Value = serde_json::from_slice(&output.stdout)
        .with_context(|| format!("saltus reproduce ended with {}", output.status))?;
    let rows = report["rows"].as_array().context("no rows")?;
    for (paper, item) in ITEMS {
        let is_there = rows.iter().any(|row| {
            row["paper"] == paper && row["item"].as_str().is_some_and(|name| name.contains(item))
        });
        ensure!(is_there, "paper {paper} has no row `{item}`");
    }
    for row in rows {
        for key in ["paper_value", "ours", "simulator", "holds", "reason"] {
            ensure!(row.get(key).is_some(), "a row without {key}: {row}");
        }
        ensure!(row["ours"] != "failed", "a row failed: {row}");
    }
    let page = fs::read_to_string(folder.join("index.html"))?;
    for report in page.split("src=\"").skip(1) {
        let name = report.split('"').next().unwrap_or_default();
        ensure!(
            folder.join(name).exists(),
            "the page shows {name}, which is not there"
        );
    }
    let held = rows.iter().filter(|row| row["holds"] == true).count();
    println!("{} rows, {held} claims hold", rows.len());
    Ok(())
}
