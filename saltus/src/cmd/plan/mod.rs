//! `saltus plan`: plan a task, or solve a reference problem.

mod layout;
mod srb;
mod task;
mod whole_body;

use super::failure::Failure;
use super::folder::{check_file, describe, write_file};
use super::output::{Output, whole};
use crate::reference::whole_body::shipped;
use crate::reference::{File, SHIPPED};
use core::ops::ControlFlow;
use jump_planner::range::Range;
use ocp_solver::{Barrier, Progress, Solution};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Options of `saltus plan`.
#[derive(clap::Args, Clone)]
pub(crate) struct Args {
    /// Task: a built-in one such as a1/lateral, or the path of a TOML file.
    #[arg(required_unless_present_any = ["reference", "problem"], conflicts_with_all = ["reference", "problem", "srb"])]
    task: Option<String>,
    /// Durations of the phases, s: plan with this timing instead of finding the best.
    #[arg(
        long,
        value_delimiter = ',',
        requires = "task",
        allow_hyphen_values = true
    )]
    timing: Option<Vec<f64>>,
    /// Find the durations on the whole body directly, from the guess and without the rigid body's plan: the one-stage way that paper A
    /// rules out (III).
    #[arg(long, requires = "task", conflicts_with = "timing")]
    direct: bool,
    /// Plan for the quadruped of this URDF, or of a profile (TOML beside a URDF), instead of the task's robot: twelve joints, four legs of three below a floating base, one per
    /// quadrant, with effort and speed limits.
    #[arg(long, requires = "task")]
    robot: Option<PathBuf>,
    /// Lock joints of that robot at a position, rad or m.
    #[arg(long, value_name = "JOINT=VALUE", requires = "robot")]
    lock: Vec<String>,
    /// New folder for the plan: plan.bin, the container that controllers read, plan.json, and scene.xml for MuJoCo.
    #[arg(long, requires = "task")]
    out: Option<PathBuf>,
    /// Reference task, by its name in the reference file (`spin`) or the product's (`a1/spin-90`).
    #[arg(long)]
    reference: Option<String>,
    /// JSON description to take tasks from instead of the shipped nine.
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Stage of the reference problem to solve.
    #[arg(long, default_value = "srb", value_parser = ["srb", "whole-body"], conflicts_with = "task")]
    stage: String,
    /// SRB solution that the whole-body stage follows; default: the shipped one of the reference task, or,
    /// for tasks of a problem file, one that is solved first.
    #[arg(long)]
    srb: Option<PathBuf>,
    /// Write the solution here, in the layout of the checkers.
    #[arg(long)]
    solution: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
    /// Reference problems: standard deviation of the noise added to the initial guess.
    #[arg(long, default_value_t = 0.0, conflicts_with = "task", value_parser = noise)]
    guess_noise: f64,
    /// Reference problems: seed of the guess noise.
    #[arg(long, default_value_t = 1, conflicts_with = "task", allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    seed: u64,
    /// Reference problems: solve this many times, each from the cold guess, and report the median time.
    #[arg(long, default_value_t = 1, conflicts_with = "task", allow_negative_numbers = true, value_parser = whole(1..=1000))]
    repeat: u64,
    /// Print every iteration to standard error.
    #[arg(long)]
    trace: bool,
    /// Reference problems: barrier rule.
    #[arg(long, default_value = "portfolio", value_parser = ["adaptive", "monotone", "portfolio"], conflicts_with = "task")]
    barrier: String,
}

fn noise(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    Range::From(0.0, 10.0).check(number).map(|()| number)
}

/// What a stage hands back.
struct Planned {
    /// How the solve ended.
    status: String,
    /// Durations of the phases, s.
    durations: Vec<f64>,
    /// The stage's entry of the report.
    report: Value,
    /// The solution in the layout of the reference checkers.
    solution: Value,
}

impl Planned {
    fn number(&self, key: &str) -> f64 {
        self.report[key].as_f64().unwrap_or(f64::NAN)
    }
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    args.solution.as_deref().map_or(Ok(()), check_file)?;
    if let Some(name) = &args.task {
        return Ok(task::run(args, name));
    }
    if args.srb.is_some() && args.stage != "whole-body" {
        return Err("--srb is for --stage whole-body, which follows that solution".into());
    }
    let text = match &args.problem {
        Some(path) => read(path)?,
        None => SHIPPED.to_owned(),
    };
    let shown = |error| match &args.problem {
        Some(path) => format!(
            "{}: {error}: it must be like saltus/data/a1-jumps.json",
            path.display()
        ),
        None => error,
    };
    let file = File::parse(&text).map_err(shown)?;
    let name = file.pick(args.reference.as_deref())?;
    let mut report = json!({ "task": name });
    let (key, planned) = if args.stage == "whole-body" {
        let srb = match &args.srb {
            Some(path) => read(path)?,
            None => match shipped(name).filter(|_| args.problem.is_none()) {
                Some(text) => text.to_owned(),
                None => {
                    let first = srb::solve(&args.plain(), &file, name)?;
                    report["srb"] = first.report;
                    first.solution.to_string()
                }
            },
        };
        let named = |error| match &args.srb {
            Some(path) => format!("{}: {error}", path.display()),
            None => error,
        };
        let planned = whole_body::solve(args, &file, name, &srb).map_err(named)?;
        ("whole_body", planned)
    } else {
        ("srb", srb::solve(args, &file, name)?)
    };
    let solved = planned.status == "Solved";
    // What is not solved must not lie there like a solution.
    if let Some(path) = args.solution.as_deref().filter(|_| solved) {
        write_file(path, planned.solution.to_string().as_bytes())?;
    }
    if args.output.json {
        let phase = |t: &f64| json!({ "duration_s": t });
        report["status"] = json!(planned.status);
        report["phases"] = planned.durations.iter().map(phase).collect();
        report[key] = planned.report;
        say!("{report}");
    } else if !args.output.quiet {
        say!(
            "{name}: {} in {:.2} ms, {} iterations, cost {:.6}, violation {:.1e}, durations {:.3?} s",
            planned.status,
            planned.number("wall_ms"),
            planned.report["iterations"],
            planned.number("cost"),
            planned.number("max_violation"),
            planned.durations,
        );
    }
    Ok(if solved {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    })
}

fn read(path: &Path) -> Result<String, String> {
    jump_planner::file::read_text(path).map_err(|error| describe(path, &error))
}

impl Args {
    /// The same task, solved once from the plain guess.
    fn plain(&self) -> Self {
        Self {
            guess_noise: 0.0,
            repeat: 1,
            ..self.clone()
        }
    }

    fn barrier(&self) -> Barrier {
        match self.barrier.as_str() {
            "adaptive" => Barrier::Adaptive,
            "monotone" => Barrier::Monotone,
            _ => Barrier::Portfolio,
        }
    }

    /// Prints an iteration where that is asked for.
    fn observe(&self, progress: &Progress<f64>) -> ControlFlow<()> {
        if self.trace {
            let r = &progress.residual;
            tell!(
                "{:3} cost {:12.6} primal {:.1e} dual {:.1e} compl {:.1e} mu {:.1e} step {:.3} {:.3} shift {:.0e}",
                progress.iteration,
                progress.cost,
                r.primal,
                r.dual,
                r.complementarity,
                progress.mu,
                progress.primal_step,
                progress.dual_step,
                progress.shift
            );
        }
        ControlFlow::Continue(())
    }

    /// Solves as often as asked for; the outcome and the median wall time, ms.
    fn timed(
        &self,
        mut solve: impl FnMut() -> Result<Solution<f64>, String>,
    ) -> Result<(Solution<f64>, f64), String> {
        let mut times = Vec::new();
        let mut outcome = None;
        for _ in 0..self.repeat {
            let start = Instant::now();
            outcome = Some(solve()?);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        let outcome = outcome.ok_or("nothing was solved")?;
        Ok((outcome, times[times.len() / 2]))
    }
}
