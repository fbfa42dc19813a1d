//! `saltus reproduce`: both papers, item by item.

mod page;

use super::expected::{Expected, Found};
use super::failure::Failure;
use super::folder::{create, describe, write};
use super::interrupt;
use super::output::Output;
use crate::humanoid::{report as pushed, table};
use crate::quadruped::report as flown;
use crate::report::{About, Line, words};
use core::ops::ControlFlow;
use indicatif::ProgressBar;
use jump_lab::Sim;
use jump_lab::humanoid::execute::Run as Push;
use jump_lab::humanoid::{Task, judge};
use jump_lab::lab::Disturbance;
use jump_lab::papers::{self, Row, Watch};
use jump_lab::quadruped::Planned;
use jump_lab::quadruped::execute::Run;
use jump_lab::verdict::Verdict;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `saltus reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only the native simulator; the whole run adds MuJoCo, which needs a build with the feature `mujoco`.
    #[arg(long)]
    quick: bool,
    /// A file of expected verdicts: exit code 2 where an item does not come out as it says, whatever it is.
    #[arg(long)]
    expect: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
    /// New folder for the page and its reports; by default out/reproduce, or out/reproduce-2 and so on.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command. Exit code 0 when every claim that can be judged holds, 2 when one does not; Ctrl-C leaves the
/// page of the rows so far.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let sims: &[Sim] = match (args.quick, cfg!(feature = "mujoco")) {
        (true, _) => &[Sim::Native],
        (false, true) => &[Sim::Native, Sim::MUJOCO],
        (false, false) => {
            return Err(
                "this build has no MuJoCo: `--quick`, or `cargo xtask mujoco run --release -p saltus --features mujoco -- reproduce`"
                    .into(),
            );
        }
    };
    let expected = args.expect.as_deref().map(Expected::read).transpose()?;
    let folder = create(args.out.as_deref(), "reproduce")?;
    interrupt::listen()?;
    let bar = args.output.spinner();
    let mut reports = Reports {
        folder: &folder,
        bar: &bar,
        names: Vec::new(),
        failed: None,
    };
    let mut rows = Vec::new();
    let complete = papers::rows(sims, &mut rows, &mut reports).is_continue();
    bar.finish_and_clear();
    let Reports {
        mut names, failed, ..
    } = reports;
    names.sort();
    names.dedup();
    let report =
        json!({ "complete": complete, "rows": rows.iter().map(object).collect::<Vec<_>>() });
    write(
        &folder,
        "reproduce.json",
        format!("{report:#}\n").as_bytes(),
    )?;
    write(&folder, "index.html", page::html(&rows, &names).as_bytes())?;
    if args.output.json {
        say!("{report}");
    } else if !args.output.quiet {
        rows.iter().for_each(print);
        say!("page: {}", folder.join("index.html").display());
    }
    if let Some(failure) = failed {
        return Err(failure);
    }
    Ok(if !complete {
        ExitCode::from(interrupt::CODE)
    } else if let Some(expected) = expected {
        let found: Vec<Found> = rows.iter().map(found).collect();
        expected.compare_papers(&found)
    } else if rows.iter().any(Row::is_refuted) {
        ExitCode::from(2)
    } else {
        ExitCode::SUCCESS
    })
}

/// Writes a report of every run, in a folder of its own.
struct Reports<'a> {
    folder: &'a Path,
    bar: &'a ProgressBar,
    /// Folders that were written.
    names: Vec<String>,
    /// The first that could not be written; the rows go on.
    failed: Option<Failure>,
}

impl Reports<'_> {
    fn write(&mut self, name: &str, html: Result<String, String>) {
        let own = self.folder.join(name);
        let written = html.map_err(Failure::from).and_then(|html| {
            let outside = |error| Failure::Outside(describe(&own, &error));
            fs::create_dir_all(&own).map_err(outside)?;
            write(&own, "report.html", html.as_bytes())
        });
        match written {
            Ok(()) => self.names.push(name.to_owned()),
            Err(failure) => self.failed = self.failed.take().or(Some(failure)),
        }
    }
}

impl Watch for Reports<'_> {
    fn next(&mut self, what: &str) -> ControlFlow<()> {
        self.bar.set_message(what.to_owned());
        if interrupt::asked() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn flown(&mut self, name: &str, jump: &Planned, run: &Run, end: &str) {
        let table = [
            ("task", jump.task.name.clone(), None),
            ("result", end.to_owned(), None),
        ];
        let about = about(&jump.judge(run).verdict, &table);
        self.write(name, flown::html(&jump.task, &jump.reference, run, about));
    }

    fn pushed(&mut self, name: &str, task: &Task, sim: Sim, [held, free]: [&Push; 2]) {
        let judged = judge::Judged::of(task, held);
        let table = table::table(&judged, task, held, sim.name(), &Disturbance::NOMINAL);
        let about = about(&judged.verdict, &table);
        self.write(name, pushed::html(task, held, Some(free), about));
    }
}

/// Of a nominal run, which has no result of its own.
fn about<'a>(verdict: &Verdict, table: &'a [Line]) -> About<'a> {
    About {
        disturbance: &Disturbance::NOMINAL,
        verdict: words(verdict),
        result: Value::Null,
        table,
    }
}

/// A row of `--json`.
fn object(row: &Row) -> Value {
    json!({
        "paper": row.paper.to_string(),
        "item": row.item,
        "paper_value": row.theirs,
        "ours": row.ours,
        "simulator": row.sim.map(Sim::name),
        "holds": row.holds,
        "reason": row.reason,
    })
}

/// As the file of expected verdicts has it: `A: Table II, ...`, and `unjudged` where this program cannot judge.
fn found(row: &Row) -> Found {
    let outcome = row.mark();
    Found {
        name: format!("{}: {}", row.paper, row.item),
        sim: row.sim.map_or("any", Sim::name).to_owned(),
        outcome: outcome.to_owned(),
        words: format!("{outcome}: {} ({})", row.ours, row.reason),
    }
}

/// For a terminal.
fn print(row: &Row) {
    let sim = row.sim.map_or("", Sim::name);
    say!("{:3} {} {} [{sim}]", row.mark(), row.paper, row.item);
    say!("      paper: {}", row.theirs);
    say!("      here:  {}", row.ours);
    if !row.reason.is_empty() {
        say!("      {}", row.reason);
    }
}
