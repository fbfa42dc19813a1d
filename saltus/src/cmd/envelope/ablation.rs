//! A study beside the same study without each measure: what each is worth.

use super::study::{Study, refuse_strangers};
use crate::cmd::failure::Failure;
use crate::cmd::folder::write;
use crate::cmd::interrupt;
use core::fmt::Write;
use indicatif::ProgressBar;
use jump_lab::quadruped::envelope::{Counts, rate, wilson};
use jump_lab::quadruped::measure::Measure;
use jump_planner::reference::Reference;
use serde_json::{Map, Value, json};

/// Name of the row with all measures, and of its folder.
const NONE: &str = "nothing";

/// One row: what was left out, and what came of it; without a plan nothing is executed.
pub(super) struct Row {
    without: &'static str,
    result: Result<Counts, String>,
}

/// The study with all measures and without each, in folders of their own, by what is left out.
pub(super) type Parts<'a> = Vec<(&'static str, Study<'a>)>;

/// The parts of a study. Fails where a folder holds something else.
pub(super) fn parts<'a>(study: &Study<'a>) -> Result<Parts<'a>, String> {
    let parts = core::iter::once(None).chain(Measure::ALL.map(Some));
    let parts = parts.map(|off| {
        let name = off.map_or(NONE, Measure::name);
        let part = Study {
            without: off.into_iter().collect(),
            folder: study.folder.join(format!("without-{name}")),
            ..study.clone()
        };
        (name, part)
    });
    let parts: Parts<'_> = parts.collect();
    refuse_strangers(&study.folder, "without-")?;
    for (_, part) in &parts {
        part.refuse_strangers()?;
    }
    Ok(parts)
}

/// Runs the parts, until Ctrl-C; `whole` is the plan with all measures.
pub(super) fn run(
    (study, parts): (&Study<'_>, Parts<'_>),
    whole: &Reference,
    bar: &ProgressBar,
) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (without, part) in parts {
        if interrupt::asked() {
            break;
        }
        bar.set_message(format!("without {without} "));
        let replanned = part.without.iter().any(|measure| measure.is_planned());
        let own = replanned.then(|| part.plan()).transpose();
        let result = match own {
            Ok(own) => Ok(Counts::of(&part.run(own.as_ref().unwrap_or(whole), bar)?)),
            Err(why) => Err(why.to_string()),
        };
        rows.push(Row { without, result });
    }
    if !rows.is_empty() {
        write(&study.folder, "ablation.csv", csv(&rows).as_bytes())?;
    }
    Ok(rows)
}

/// The rows as a file.
fn csv(rows: &[Row]) -> String {
    let mut out =
        String::from("without,samples,on_target,rate,low95,high95,failed_first,no_plan\n");
    for Row { without, result } in rows {
        let _ = match result {
            Ok(counts) => {
                let Counts {
                    samples, on_target, ..
                } = counts;
                let rate = rate(*on_target, *samples);
                let failed = counts.failures();
                writeln!(out, "{without},{samples},{on_target},{rate},\"{failed}\",")
            }
            Err(error) => {
                let error = error.replace('"', "'").replace('\n', " ");
                writeln!(out, "{without},0,0,,,,,\"{error}\"")
            }
        };
    }
    out
}

/// The rows for people.
pub(super) fn text(rows: &[Row]) -> String {
    let mut out = format!(
        "{:10} {:>9} {:>15}  failed first\n",
        "without", "on target", "95 %"
    );
    for Row { without, result } in rows {
        let _ = match result {
            Ok(counts) => {
                let [low, high] = wilson(counts.on_target, counts.samples);
                writeln!(
                    out,
                    "{without:10} {:>3} of {:<3} {:>4.0} to {:>3.0} %  {}",
                    counts.on_target,
                    counts.samples,
                    100.0 * low,
                    100.0 * high,
                    counts.failures()
                )
            }
            Err(error) => writeln!(out, "{without:10} no plan: {error}"),
        };
    }
    out
}

/// The rows as JSON.
pub(super) fn json(rows: &[Row]) -> Value {
    let rows = rows.iter().map(|Row { without, result }| match result {
        Ok(counts) => {
            let mut row = counts_json(counts);
            row.insert("without".into(), json!(without));
            Value::Object(row)
        }
        Err(error) => json!({ "without": without, "no_plan": error }),
    });
    rows.collect()
}

/// Counts as JSON, failures by what failed first.
pub(super) fn counts_json(counts: &Counts) -> Map<String, Value> {
    [
        ("done", json!(counts.samples)),
        ("on_target", json!(counts.on_target)),
        ("failed_first", json!(counts.failed)),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into_iter()
    .collect()
}
