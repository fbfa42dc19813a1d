//! A jump of paper B.

use super::{Args, Files, code};
use crate::cmd::failure::Failure;
use crate::cmd::folder::check_new;
use crate::humanoid::{json, report, strip, table};
use crate::report::{About, words};
use jump_lab::humanoid::{Task, execute, judge::Judged, log};
use jump_lab::lab::Lab;
use std::process::ExitCode;

/// Runs the jump.
pub(super) fn run(args: &Args, task: &Task) -> Result<ExitCode, Failure> {
    check_new(args.out.as_deref())?;
    let bar = args.output.spinner();
    bar.set_message("simulating");
    let disturbance = args.disturbance(Lab::Icub);
    let jump = |task: &Task| execute::run(task, args.sim, &disturbance, args.seed, |_, _| {});
    let run = jump(task)?;
    let judged = Judged::of(task, &run);
    let result = json::json(
        &judged,
        task,
        &run,
        (args.sim.name(), args.seed),
        &disturbance,
    );
    // Figure 6 of paper B compares a jump with one that leaves the angular momentum alone.
    let free = if task.momentum {
        bar.set_message("simulating without control of the angular momentum");
        Some(jump(&Task {
            momentum: false,
            ..*task
        })?)
    } else {
        None
    };
    bar.finish_and_clear();
    let table = table::table(&judged, task, &run, args.sim.name(), &disturbance);
    if args.output.is_text() {
        for (name, value, _) in &table {
            say!("{name:26} {value}");
        }
    }
    let log = log::table(&run.samples);
    let about = About {
        disturbance: &disturbance,
        verdict: words(&judged.verdict),
        result: result.clone(),
        table: &table,
    };
    let files = Files {
        task: task.name(),
        mcap: report::mcap(task, &run, &log).map_err(Failure::Outside)?,
        log: &log,
        report: report::html(task, &run, free.as_ref(), about)?,
        result: &result,
        strip: strip::svg(&run),
    };
    files.publish(args)?;
    Ok(code(judged.verdict.on_target()))
}
