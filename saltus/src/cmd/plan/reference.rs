//! A reference problem, or one of a problem file, solved as it is stated: no limits of the product, no audit.
//!
//! Exit code 0 for a solution, 2 for none, be that proven or not.

use super::Args;
use crate::cmd::failure::Failure;
use crate::cmd::folder::{describe, write_file};
use core::ops::ControlFlow;
use jump_lab::noise::Noise;
use jump_planner::bounds::Impossible;
use ocp_solver::{Barrier, Progress, Status};
use reference_problems::{Answer, File, SHIPPED, SrbMotion, shipped};
use serde_json::{Value, json};
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let on_legs = args.stage == "whole-body";
    if args.srb.is_some() && !on_legs {
        return Err("--srb is for --stage whole-body, which follows that solution".into());
    }
    let text = match &args.problem {
        Some(path) => read(path)?,
        None => SHIPPED.to_owned(),
    };
    let shown = |error| match &args.problem {
        Some(path) => format!("{}: {error}", path.display()),
        None => error,
    };
    let like = "it must be like reference-problems/data/a1-jumps.json";
    let file = File::parse(&text).map_err(|error| shown(format!("{error}: {like}")))?;
    let name = file.pick(args.reference.as_deref()).map_err(shown)?;
    let mut report = json!({ "task": name });
    // The whole body follows a motion that is given, or one that is found here first.
    let given = on_legs && (args.srb.is_some() || args.problem.is_none());
    if let Some(proof) = file.impossible(name).map_err(shown)?.filter(|_| !given) {
        return Ok(proven(args, name, report, &proof));
    }
    let answer = if on_legs {
        let motion = motion(args, &file, name, &mut report)?;
        args.timed(|noise, observe| {
            file.solve_whole_body(name, &motion, args.barrier(), noise, observe)
        })
    } else {
        args.timed(|noise, observe| file.solve_srb(name, args.barrier(), noise, observe))
    };
    let answer = answer.map_err(shown)?;
    let solved = answer.status == Status::Solved;
    // What is not solved must not lie there like a solution.
    if let Some(path) = args.solution.as_deref().filter(|_| solved) {
        write_file(path, answer.solution.to_string().as_bytes())?;
    }
    if args.output.json {
        let phase = |t: &f64| json!({ "duration_s": t });
        report["status"] = json!(format!("{:?}", answer.status));
        report["phases"] = answer.durations.iter().map(phase).collect();
        report[if on_legs { "whole_body" } else { "srb" }] = entry(&answer);
        say!("{report}");
    } else if !args.output.quiet {
        say!(
            "{name}: {:?} in {:.2} ms, {} iterations, cost {:.6}, violation {:.1e}, durations {:.3?} s",
            answer.status,
            answer.wall_ms,
            answer.iterations,
            answer.cost,
            answer.max_violation,
            answer.durations,
        );
    }
    Ok(if solved {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    })
}

/// Tells that there is no solution, and why.
fn proven(args: &Args, name: &str, mut report: Value, proof: &Impossible) -> ExitCode {
    if args.output.json {
        report["status"] = json!("Infeasible");
        report["because"] = json!(proof.to_string());
        report["relaxations"] = json!([proof.relaxation]);
        say!("{report}");
    } else if !args.output.quiet {
        say!("{name}: infeasible: {proof}\n  {}", proof.relaxation);
    }
    ExitCode::from(2)
}

/// The motion that the whole body follows: the one that was given, the shipped one, or one that is solved first and told in the report.
fn motion(args: &Args, file: &File, name: &str, report: &mut Value) -> Result<SrbMotion, String> {
    if let Some(path) = &args.srb {
        let named = |error| format!("{}: {error}", path.display());
        return SrbMotion::parse(&read(path)?).map_err(named);
    }
    if let Some(text) = shipped(name).filter(|_| args.problem.is_none()) {
        return SrbMotion::parse(text);
    }
    let observe = |progress: &_| args.observe(progress);
    let body = file.solve_srb(name, args.barrier(), || 0.0, observe)?;
    report["srb"] = entry(&body);
    SrbMotion::parse(&body.solution.to_string())
}

/// A stage's entry of the report.
fn entry(answer: &Answer) -> Value {
    let mut entry = json!({
        "wall_ms": answer.wall_ms,
        "iterations": answer.iterations,
        "restarts": answer.restarts,
        "cost": answer.cost,
        "max_violation": answer.max_violation,
    });
    if let Some([force, torque]) = answer.peaks {
        entry["peak_force_n"] = json!(force);
        entry["peak_torque_nm"] = json!(torque);
    }
    entry
}

fn read(path: &Path) -> Result<String, String> {
    jump_planner::file::read_text(path).map_err(|error| describe(path, &error))
}

impl Args {
    fn barrier(&self) -> Barrier {
        match self.barrier.as_str() {
            "adaptive" => Barrier::Adaptive,
            "monotone" => Barrier::Monotone,
            _ => Barrier::Portfolio,
        }
    }

    /// Solves as often as asked for, each time from the same guess; the last answer, with the median wall time.
    fn timed(
        &self,
        mut solve: impl FnMut(
            &mut dyn FnMut() -> f64,
            &mut dyn FnMut(&Progress<f64>) -> ControlFlow<()>,
        ) -> Result<Answer, String>,
    ) -> Result<Answer, String> {
        let mut times = Vec::new();
        loop {
            let mut noise = Noise::new(self.seed, self.guess_noise);
            let answer = solve(&mut || noise.sample(), &mut |progress| {
                self.observe(progress)
            })?;
            times.push(answer.wall_ms);
            if times.len() as u64 >= self.repeat {
                times.sort_by(f64::total_cmp);
                let wall_ms = times[times.len() / 2];
                return Ok(Answer { wall_ms, ..answer });
            }
        }
    }
}
