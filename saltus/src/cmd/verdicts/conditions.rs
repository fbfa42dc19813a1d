//! The table of conditions: a line per task and simulator, a column per condition, and what failed first.

use super::subject::{Cell, Condition, Subject};
use super::{Args, judge};
use crate::cmd::failure::Failure;
use crate::cmd::interrupt;
use core::fmt::Write;
use indicatif::ProgressBar;
use jump_lab::Sim;
use jump_lab::lab::Interface;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::process::ExitCode;

/// What each column sets: as `--plant` takes it, and how the motors are commanded.
const COLUMNS: [(&str, Interface); 8] = [
    ("", Interface::Torque),
    ("ground=firm", Interface::Torque),
    ("ground=soft", Interface::Torque),
    ("joint_friction=0.5", Interface::Torque),
    ("payload=2@0,0,0.05", Interface::Torque),
    ("com_x=0.02", Interface::Torque),
    ("", Interface::JointPd { rate: 1000 }),
    ("", Interface::JointPd { rate: 500 }),
];

/// One column: its title, and a cell of text per subject and simulator with whether it is good.
struct Column {
    title: String,
    cells: Vec<(String, bool)>,
}

/// Runs every column. Exit code 0 when the table is complete: what it says is the answer.
pub(super) fn run(
    args: &Args,
    subjects: &[Subject],
    sims: &[Sim],
    bar: &ProgressBar,
) -> Result<ExitCode, Failure> {
    let mut columns = Vec::new();
    for (plant, interface) in COLUMNS {
        let condition = Condition {
            plant: Some(plant.parse()?),
            interface,
            ..Condition::NOMINAL
        };
        let title = match (plant, interface) {
            ("", Interface::Torque) => "nominal".to_owned(),
            ("", interface) => interface.to_string(),
            (plant, _) => plant.to_owned(),
        };
        let cells = judge(subjects, sims, &condition, None, bar)?;
        let word = |cell: &Cell| {
            let word = if cell.on_target() {
                "yes"
            } else {
                cell.outcome()
            };
            (word.to_owned(), cell.on_target())
        };
        columns.push(Column {
            title,
            cells: cells.iter().map(word).collect(),
        });
        if interrupt::asked() {
            break;
        }
    }
    if args.lab > 0 && !interrupt::asked() {
        columns.push(lab(args.lab, subjects, sims, bar)?);
    }
    bar.finish_and_clear();
    let rows: Vec<(&str, Sim)> = subjects
        .iter()
        .flat_map(|subject| sims.iter().map(|sim| (subject.name.as_str(), *sim)))
        .collect();
    if args.output.json {
        say!("{}", json(&rows, &columns));
    } else if !args.output.quiet {
        put!("{}", markdown(&rows, &columns));
    }
    Ok(if interrupt::asked() {
        ExitCode::from(interrupt::CODE)
    } else {
        ExitCode::SUCCESS
    })
}

/// Causes of failure in the lab that are told by name, the most frequent first.
const TOLD: usize = 3;

/// So many seeds of the lab: how many are on target, and what failed first in the others.
fn lab(
    seeds: u64,
    subjects: &[Subject],
    sims: &[Sim],
    bar: &ProgressBar,
) -> Result<Column, Failure> {
    let mut good = vec![0_u64; subjects.len() * sims.len()];
    let mut failed = vec![BTreeMap::<String, u64>::new(); good.len()];
    let mut done = 0;
    for seed in 1..=seeds {
        if interrupt::asked() {
            break;
        }
        let condition = Condition {
            seed,
            ..Condition::NOMINAL
        };
        for (i, cell) in judge(subjects, sims, &condition, None, bar)?
            .iter()
            .enumerate()
        {
            if cell.on_target() {
                good[i] += 1;
            } else {
                *failed[i].entry(cell.outcome().to_owned()).or_insert(0) += 1;
            }
        }
        done = seed;
    }
    let cells = good.iter().zip(&failed).map(|(good, failed)| {
        let mut causes: Vec<(&String, &u64)> = failed.iter().collect();
        causes.sort_by(|a, b| b.1.cmp(a.1));
        let rest: u64 = causes.iter().skip(TOLD).map(|(_, n)| **n).sum();
        let told = causes.iter().take(TOLD);
        let mut causes: Vec<String> = told.map(|(name, n)| format!("{name} {n}")).collect();
        if rest > 0 {
            causes.push(format!("others {rest}"));
        }
        let text = format!("{good} of {done}");
        let text = if causes.is_empty() {
            text
        } else {
            format!("{text} ({})", causes.join(", "))
        };
        (text, *good == done)
    });
    Ok(Column {
        title: format!("{seeds} labs"),
        cells: cells.collect(),
    })
}

fn markdown(rows: &[(&str, Sim)], columns: &[Column]) -> String {
    let mut out = String::from("| task | simulator |");
    for column in columns {
        let _ = write!(out, " {} |", column.title);
    }
    out += &format!("\n|---|---|{}\n", "---|".repeat(columns.len()));
    for (i, (task, sim)) in rows.iter().enumerate() {
        let _ = write!(out, "| `{task}` | {} |", sim.name());
        for column in columns {
            let _ = write!(out, " {} |", column.cells[i].0);
        }
        out.push('\n');
    }
    out
}

fn json(rows: &[(&str, Sim)], columns: &[Column]) -> Value {
    let lines = rows.iter().enumerate().map(|(i, (task, sim))| {
        let cells = columns.iter().map(|column| {
            let (text, good) = &column.cells[i];
            json!({ "condition": column.title, "outcome": text, "good": good })
        });
        json!({ "task": task, "sim": sim.name(), "conditions": cells.collect::<Vec<_>>() })
    });
    json!({ "rows": lines.collect::<Vec<_>>() })
}
