//! A task, planned for execution: bounds, single rigid body, whole body, container, audit.
//!
//! Exit code 0 for a plan that passed its audit, 2 for a task that is refused or has no such plan, 1 for a plan that cannot be written.

use super::Args;
use super::layout::layout;
use crate::cmd::failure::{Failure, brief};
use crate::cmd::folder::{check_new, publish, write_file};
use indicatif::ProgressBar;
use jump_planner::answer::Answer;
use jump_planner::audit::Audit;
use jump_planner::bounds::impossible;
use jump_planner::task::{SrbPlan, Task};
use jump_planner::whole_body::{self, Timing, WholeBodyPlan};
use ocp_solver::{Progress, Settings, Status};
use serde_json::{Value, json};
use std::process::ExitCode;

/// How far planning came.
#[derive(Default)]
struct Report {
    task: Option<Task>,
    srb: Option<SrbPlan>,
    whole_body: Option<(WholeBodyPlan, f64)>,
    bytes: Vec<u8>,
    audit: Option<Audit>,
    answer: Option<Answer>,
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
        report.print(name);
    }
    match result {
        Ok(()) if report.answer.is_none() => ExitCode::SUCCESS,
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
    if let Some(proof) = impossible(task) {
        report.answer = Some(Answer::proven(proof));
        return Ok(());
    }
    let observe = |stage: &str, progress: &Progress<f64>| {
        bar.set_message(format!(
            "{stage}: iteration {}, violation {:.1e}",
            progress.iteration, progress.residual.primal
        ));
        args.observe(progress)
    };
    let (guess, timing);
    let srb = if args.direct {
        (guess, timing) = (task.guess()?, Timing::Free);
        &guess
    } else {
        let srb = task.attempt(&Settings::new(), |progress| observe("body", progress))?;
        timing = Timing::Given;
        report.srb.insert(srb)
    };
    if !args.direct && srb.status != Status::Solved {
        bar.set_message("looking for what would have to change");
        report.answer = Some(Answer::no_body_plan(task, srb));
        return Ok(());
    }
    let gains = !args.no_gains;
    let whole = whole_body::audited(task, srb, timing, gains, |p| observe("whole body", p))?;
    report.bytes = whole.bytes;
    let (plan, _) = report.whole_body.insert((whole.plan, whole.wall_ms));
    let Some(audit) = whole.audit else {
        bar.set_message("looking for what would have to change");
        report.answer = Some(Answer::no_whole_body_plan(task, srb, plan));
        return Ok(());
    };
    let audit = report.audit.insert(audit);
    if !audit.passes() {
        report.answer = Some(Answer {
            status: "AuditFailed",
            because: audit.complaint(),
            relaxations: Vec::new(),
        });
    }
    Ok(())
}

/// Writes what was asked for.
fn write(args: &Args, report: &Report) -> Result<(), Failure> {
    let (Some(task), Some((plan, _))) = (&report.task, &report.whole_body) else {
        return Ok(());
    };
    // What is no plan must not lie there like one.
    if report.answer.is_some() {
        return Ok(());
    }
    if let Some(path) = &args.solution {
        write_file(path, layout(&task.name, plan).to_string().as_bytes())?;
    }
    let Some(folder) = &args.out else {
        return Ok(());
    };
    let mut json = report.json(&task.name, None);
    if let Some(audit) = &report.audit {
        json["audit"] = audit.details(&task.robot);
    }
    let text = format!("{json:#}\n");
    let files = [
        ("plan.bin", report.bytes.as_slice()),
        ("plan.json", text.as_bytes()),
    ];
    publish(Some(folder), &task.name, &files).map(|_| ())
}

impl Report {
    fn status(&self) -> &'static str {
        match (&self.answer, &self.audit) {
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
        if let Some((plan, _)) = &self.whole_body {
            let durations = plan
                .phases
                .iter()
                .map(|phase| phase.dt * phase.intervals as f64);
            return names.zip(durations).collect();
        }
        let first = self.srb.as_ref().and_then(|srb| srb.stages.first());
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
            "srb": self.srb.as_ref().map(|plan| json!({
                "wall_ms": plan.wall_ms,
                "iterations": plan.iterations,
                "cost": plan.cost,
                "max_violation": plan.max_violation,
            })),
            "whole_body": self.whole_body.as_ref().map(|(plan, wall_ms)| json!({
                "wall_ms": wall_ms,
                "iterations": plan.outcome.iterations,
                "cost": plan.judged.cost,
                "max_violation": plan.judged.max_violation,
            })),
            "audit": self.audit.as_ref().map(Audit::json),
        });
        if let Some(answer) = &self.answer {
            report["answer"] = answer.json();
        }
        if let Some(error) = error {
            report["error"] = json!(error);
        }
        report
    }

    /// The report for people.
    fn print(&self, name: &str) {
        say!("{name}: {}", self.status());
        let phases: Vec<String> = (self.phases().iter())
            .map(|(name, t)| format!("{name} {t:.3} s"))
            .collect();
        if !phases.is_empty() {
            say!("  phases      {}", phases.join(", "));
        }
        if let Some(plan) = &self.srb {
            say!(
                "  body        {:.1} ms, {} iterations, cost {:.4}, violation {:.1e}",
                plan.wall_ms,
                plan.iterations,
                plan.cost,
                plan.max_violation
            );
        }
        if let Some((plan, wall_ms)) = &self.whole_body {
            say!(
                "  whole body  {wall_ms:.0} ms, {} iterations, cost {:.4}, violation {:.1e}, peak torque {:.1} N m",
                plan.outcome.iterations,
                plan.judged.cost,
                plan.judged.max_violation,
                plan.judged.peak_effort
            );
        }
        if let Some(audit) = &self.audit {
            say!("  audit       {}", audit.summary());
        }
        if let Some(answer) = &self.answer {
            say!("{}", answer.text());
        }
    }
}
