//! A task, planned for execution: bounds, single rigid body, whole body, container, audit.
//!
//! Exit code 0 for a plan that passed its audit, 2 for a task that is refused or has no such plan, 1 for a plan that cannot be written.

use super::Args;
use super::layout::layout;
use crate::cmd::failure::{Failure, brief};
use crate::cmd::folder::{check_new, publish, write_file};
use core::ops::ControlFlow;
use core::time::Duration;
use indicatif::ProgressBar;
use jump_planner::audit::Audit;
use jump_planner::task::Task;
use jump_planner::whole_body::Attempt;
use jump_planner::{Options, Outcome, Step, Timing};
use serde_json::{Value, json};
use std::process::ExitCode;

/// How far planning came.
#[derive(Default)]
struct Report {
    task: Option<Task>,
    found: Outcome,
}

/// Runs the command.
pub(super) fn run(args: &Args, name: &str) -> ExitCode {
    let bar = args.output.spinner();
    let mut report = Report::default();
    let result = plan(args, name, &bar, &mut report);
    bar.finish_and_clear();
    let result = result.and_then(|()| write(args, &report));
    if args.output.json {
        let error = result.as_ref().err().map(Failure::message);
        say!("{}", report.json(&brief(name), error.as_ref()));
    } else if result.is_ok() && !args.output.quiet {
        report.print(name, args.explain);
    }
    match result {
        Ok(()) if report.found.answer.is_none() => ExitCode::SUCCESS,
        Ok(()) => ExitCode::from(2),
        Err(failure) => failure.tell(false),
    }
}

/// Plans, and leaves in the report how far that came.
fn plan(args: &Args, name: &str, bar: &ProgressBar, report: &mut Report) -> Result<(), Failure> {
    args.out
        .as_deref()
        .map_or(Ok(()), |out| check_new(Some(out)))?;
    let mut task = Task::load_for(name, args.robot.as_deref(), &args.lock)?;
    if let Some(timing) = &args.timing {
        task.fix_timing(timing)?;
    }
    let task = report.task.insert(task);
    args.output.warn_of(task);
    let timing = if args.direct {
        Timing::Free
    } else {
        Timing::Given
    };
    let within = args.within.map(Duration::from_secs_f64);
    let options = Options { timing, within };
    report.found = jump_planner::plan(task, &options, |step, progress| {
        let stage = match step {
            Step::Body => "body",
            Step::WholeBody => "whole body",
            Step::Relaxations => "looking for what would have to change",
        };
        let Some(progress) = progress else {
            bar.set_message(stage);
            return ControlFlow::Continue(());
        };
        bar.set_message(format!(
            "{stage}: iteration {}, violation {:.1e}",
            progress.iteration, progress.residual.primal
        ));
        args.observe(progress)
    })?;
    Ok(())
}

/// Writes what was asked for.
fn write(args: &Args, report: &Report) -> Result<(), Failure> {
    let (Some(task), Some(plan)) = (&report.task, &report.found.whole_body) else {
        return Ok(());
    };
    // What is no plan must not lie there like one.
    if report.found.answer.is_some() {
        return Ok(());
    }
    if let Some(path) = &args.solution {
        write_file(path, layout(&task.name, plan).to_string().as_bytes())?;
    }
    let Some(folder) = &args.out else {
        return Ok(());
    };
    let mut json = report.json(&task.name, None);
    if let Some(audit) = &report.found.audit {
        json["audit"] = audit.details(&task.robot);
    }
    let text = format!("{json:#}\n");
    let scene = jump_planner::scene::mjcf(task);
    let files = [
        ("plan.bin", report.found.bytes.as_slice()),
        ("plan.json", text.as_bytes()),
        ("scene.xml", scene.as_bytes()),
    ];
    publish(Some(folder), &task.name, &files).map(|_| ())
}

impl Report {
    fn status(&self) -> &'static str {
        match (&self.found.answer, &self.found.audit) {
            (Some(answer), _) => answer.status,
            (None, Some(_)) => "Solved",
            (None, None) => "Error",
        }
    }

    /// Durations of the phases, s: none before the body's motion is planned.
    fn phases(&self) -> Vec<(String, f64)> {
        let Some(task) = &self.task else {
            return Vec::new();
        };
        let phases = task.problem.used_phases().iter();
        let names = phases.map(|phase| task.phase_name(&phase.contacts));
        if let Some(plan) = &self.found.whole_body {
            let durations = plan
                .phases
                .iter()
                .map(|phase| phase.dt * phase.intervals as f64);
            return names.zip(durations).collect();
        }
        let first = self.found.srb.as_ref().and_then(|srb| srb.stages.first());
        let durations = first.map(|stage| stage.state.durations);
        names.zip(durations.into_iter().flatten()).collect()
    }

    /// The object of `--json`.
    fn json(&self, name: &str, error: Option<&String>) -> Value {
        let phase = |(name, t): &(String, f64)| json!({ "name": name, "duration_s": t });
        let mut report = json!({
            "task": name,
            "status": self.status(),
            "phases": self.phases().iter().map(phase).collect::<Vec<_>>(),
            "srb": self.found.srb.as_ref().map(|plan| json!({
                "wall_ms": plan.wall_ms,
                "iterations": plan.iterations,
                "cost": plan.cost,
                "max_violation": plan.max_violation,
            })),
            "whole_body": self.found.whole_body.as_ref().map(|plan| json!({
                "wall_ms": self.found.wall_ms,
                "iterations": plan.outcome.iterations,
                "cost": plan.judged.cost,
                "max_violation": plan.judged.max_violation,
            })),
            "path": self.found.path.iter().map(Attempt::json).collect::<Vec<_>>(),
            "audit": self.found.audit.as_ref().map(Audit::json),
        });
        if let Some(answer) = &self.found.answer {
            report["answer"] = answer.json();
        }
        if let Some(error) = error {
            report["error"] = json!(error);
        }
        report
    }

    /// The report for people.
    fn print(&self, name: &str, explain: bool) {
        say!("{name}: {}", self.status());
        let phases: Vec<String> = (self.phases().iter())
            .map(|(name, t)| format!("{name} {t:.3} s"))
            .collect();
        if !phases.is_empty() {
            say!("  phases      {}", phases.join(", "));
        }
        if let Some(plan) = &self.found.srb {
            say!(
                "  body        {:.1} ms, {} iterations, cost {:.4}, violation {:.1e}",
                plan.wall_ms,
                plan.iterations,
                plan.cost,
                plan.max_violation
            );
        }
        if let Some(plan) = &self.found.whole_body {
            say!(
                "  whole body  {:.0} ms, {} iterations, cost {:.4}, violation {:.1e}, peak torque {:.1} N m",
                self.found.wall_ms,
                plan.outcome.iterations,
                plan.judged.cost,
                plan.judged.max_violation,
                plan.judged.peak_effort
            );
        }
        for attempt in self.found.path.iter().filter(|_| explain) {
            say!("    {attempt}");
        }
        if let Some(audit) = &self.found.audit {
            say!("  audit       {}", audit.summary());
        }
        if let Some(answer) = &self.found.answer {
            say!("{}", answer.text());
        }
    }
}
