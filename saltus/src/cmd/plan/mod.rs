//! `saltus plan`: plan a task, or solve a reference problem.

mod layout;
mod reference;
mod task;

use super::failure::Failure;
use super::folder::check_file;
use super::output::{Output, number, whole};
use core::ops::ControlFlow;
use jump_planner::range::Range;
use ocp_solver::Progress;
use std::path::PathBuf;
use std::process::ExitCode;

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
        conflicts_with_all = ["reference", "problem"],
        allow_hyphen_values = true
    )]
    timing: Option<Vec<f64>>,
    /// Find the durations on the whole body directly, from the guess and without the rigid body's plan: the one-stage way that paper A
    /// rules out (III).
    #[arg(long, requires = "task", conflicts_with_all = ["timing", "reference", "problem"])]
    direct: bool,
    /// Time there is to plan in, s: it ends an iteration or an audit late, with what stands in the way until then.
    #[arg(
        long,
        value_name = "SECONDS",
        requires = "task",
        conflicts_with_all = ["reference", "problem"],
        allow_negative_numbers = true,
        value_parser = number(Range::From(0.0, 1e6))
    )]
    within: Option<f64>,
    /// Plan for the quadruped of this URDF, or of a profile (TOML beside a URDF), instead of the task's robot: twelve joints, four legs of three below a floating base, one per
    /// quadrant, with effort and speed limits.
    #[arg(long, requires = "task", conflicts_with_all = ["reference", "problem"])]
    robot: Option<PathBuf>,
    /// Lock joints of that robot at a position, rad or m.
    #[arg(long, value_name = "JOINT=VALUE", requires = "robot")]
    lock: Vec<String>,
    /// New folder for the plan: plan.bin, the container that controllers read, plan.json, and scene.xml for MuJoCo.
    #[arg(long, requires = "task", conflicts_with_all = ["reference", "problem"])]
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
    #[arg(long, default_value_t = 0.0, conflicts_with = "task", value_parser = number(Range::From(0.0, 10.0)))]
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
    /// Tell every solve of the whole body on the way to the answer: durations, intervals, torque, and what was drawn in after an audit.
    #[arg(long, requires = "task", conflicts_with_all = ["reference", "problem"])]
    explain: bool,
    /// Reference problems: barrier rule.
    #[arg(long, default_value = "portfolio", value_parser = ["adaptive", "monotone", "portfolio"], conflicts_with = "task")]
    barrier: String,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    args.solution.as_deref().map_or(Ok(()), check_file)?;
    if let (Some(out), Some(solution)) = (&args.out, &args.solution)
        && (solution.starts_with(out) || out.starts_with(solution))
    {
        let what = "--out makes a new folder for the plan alone: choose another --solution";
        return Err(format!("{}: {what}", solution.display()).into());
    }
    match &args.task {
        Some(name) => Ok(task::run(args, name)),
        None => reference::run(args),
    }
}

impl Args {
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
}
