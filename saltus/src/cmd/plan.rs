//! `saltus plan`: solve a reference problem.

use crate::noise::Noise;
use crate::reference::{FEET, File, SHIPPED};
use core::ops::ControlFlow;
use ocp_solver::{Barrier, Settings, Solution, Stage, Status};
use serde_json::{Value, json};
use srb_opt::{Problem, State};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Options of `saltus plan`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Reference task, by its name in the reference file (`spin`) or the product's (`a1/spin-90`).
    #[arg(long)]
    reference: Option<String>,
    /// JSON description to take tasks from instead of the shipped nine.
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Stage to solve.
    #[arg(long, default_value = "srb", value_parser = ["srb"])]
    stage: String,
    /// Write the solution here, in the layout of the reference checkers.
    #[arg(long)]
    solution: Option<PathBuf>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// Standard deviation of the noise added to the initial guess.
    #[arg(long, default_value_t = 0.0)]
    guess_noise: f64,
    /// Seed of the guess noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Solve this many times, each from the cold guess, and report the median time.
    #[arg(long, default_value_t = 1)]
    repeat: usize,
    /// Print every iteration to standard error.
    #[arg(long)]
    trace: bool,
    /// Barrier rule.
    #[arg(long, default_value = "portfolio", value_parser = ["adaptive", "monotone", "portfolio"])]
    barrier: String,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, String> {
    let text = match &args.problem {
        Some(path) => {
            std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?
        }
        None => SHIPPED.to_owned(),
    };
    let file = File::parse(&text)?;
    let name = file.pick(args.reference.as_deref())?;
    match file.phase_count(name) {
        0..=4 => solve::<4, 16>(args, &file, name),
        _ => solve::<12, 24>(args, &file, name),
    }
}

/// Controls and rows of four feet.
const NU: usize = 3 * FEET;
const NI: usize = 40;

type Stages<const PHASES: usize, const NX: usize> = Vec<Stage<f64, State<f64, PHASES>, NX, NU, NI>>;

fn solve<const PHASES: usize, const NX: usize>(
    args: &Args,
    file: &File,
    name: &str,
) -> Result<ExitCode, String> {
    let problem: Problem<f64, FEET, PHASES> = file.problem(name)?;
    let mut stages: Stages<PHASES, NX> = vec![Stage::new(State::new()); problem.intervals() + 1];
    let mut settings = Settings::new();
    settings.barrier = match args.barrier.as_str() {
        "adaptive" => Barrier::Adaptive,
        "monotone" => Barrier::Monotone,
        _ => Barrier::Portfolio,
    };
    let mut times = Vec::new();
    let mut outcome: Option<Solution<f64>> = None;
    for _ in 0..args.repeat.max(1) {
        let mut noise = Noise::new(args.seed, args.guess_noise);
        let start = Instant::now();
        problem.write_guess(&mut stages, || noise.sample());
        let solved = problem.plan(&settings, &mut stages, |progress| {
            if args.trace {
                let r = &progress.residual;
                eprintln!(
                    "{:3} cost {:12.6} primal {:.1e} dual {:.1e} compl {:.1e} mu {:.1e} step {:.3} {:.3} shift {:.0e}",
                    progress.iteration, progress.cost, r.primal, r.dual, r.complementarity, progress.mu,
                    progress.primal_step, progress.dual_step, progress.shift
                );
            }
            ControlFlow::Continue(())
        });
        outcome = Some(solved.map_err(|error| error.to_string())?);
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let wall_ms = times[times.len() / 2];
    let outcome = outcome.ok_or("nothing was solved")?;
    let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    let durations = &stages[0].state.durations[..problem.phase_count];
    let status = format!("{:?}", outcome.status);
    let report = json!({
        "task": name,
        "status": status,
        "phases": durations.iter().map(|t| json!({ "duration_s": t })).collect::<Vec<_>>(),
        "srb": {
            "wall_ms": wall_ms,
            "iterations": outcome.iterations,
            "restarts": outcome.restarts,
            "cost": judged.cost,
            "max_violation": judged.max_violation,
        },
    });
    if let Some(path) = &args.solution {
        let solution = json!({ "task": name, "sol": layout(&problem, &stages) });
        std::fs::write(path, solution.to_string())
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    if args.json {
        println!("{report}");
    } else {
        println!(
            "{name}: {status} in {wall_ms:.2} ms, {} iterations, cost {:.6}, violation {:.1e}, durations {durations:.3?} s",
            outcome.iterations, judged.cost, judged.max_violation
        );
    }
    Ok(if outcome.status == Status::Solved {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    })
}

/// The arrays the reference checkers read.
fn layout<const PHASES: usize, const NX: usize>(
    problem: &Problem<f64, FEET, PHASES>,
    stages: &Stages<PHASES, NX>,
) -> Value {
    let last = problem.intervals();
    let samples: Vec<_> = stages
        .iter()
        .enumerate()
        .take(last)
        .map(|(k, stage)| problem.sample(k, &stage.state, &stage.control))
        .collect();
    let states = || stages.iter().map(|stage| &stage.state);
    json!({
        "T": stages[0].state.durations[..problem.phase_count],
        "p": states().map(|s| s.pos_w.as_slice().to_vec()).collect::<Vec<_>>(),
        "v": states().map(|s| s.vel_w.as_slice().to_vec()).collect::<Vec<_>>(),
        "W": states().map(|s| s.omega_b.as_slice().to_vec()).collect::<Vec<_>>(),
        "R": states().map(|s| s.rot_wb.as_slice().to_vec()).collect::<Vec<_>>(),
        "Wd": samples.iter().map(|s| s.alpha_b.as_slice().to_vec()).collect::<Vec<_>>(),
        "f": samples
            .iter()
            .map(|s| s.forces_w.iter().flat_map(|f| f.as_slice().to_vec()).collect())
            .collect::<Vec<Vec<f64>>>(),
    })
}
