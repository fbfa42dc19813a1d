//! The SRB stage.

use super::{Args, Planned};
use crate::reference::{FEET, File};
use jump_lab::noise::Noise;
use ocp_solver::{Settings, Stage};
use serde_json::{Value, json};
use srb_opt::{Problem, State};

/// Controls and rows of four feet.
const NU: usize = 3 * FEET;
const NI: usize = 40;

type Stages<const PHASES: usize, const NX: usize> = Vec<Stage<f64, State<f64, PHASES>, NX, NU, NI>>;

/// Solves the SRB problem of a task.
pub(super) fn solve(args: &Args, file: &File, name: &str) -> Result<Planned, String> {
    match file.phase_count(name) {
        0..=4 => sized::<4, 16>(args, file, name),
        _ => sized::<12, 24>(args, file, name),
    }
}

fn sized<const PHASES: usize, const NX: usize>(
    args: &Args,
    file: &File,
    name: &str,
) -> Result<Planned, String> {
    let problem: Problem<f64, FEET, PHASES> = file.problem(name)?;
    let mut stages: Stages<PHASES, NX> = vec![Stage::new(State::new()); problem.intervals() + 1];
    let mut settings = Settings::new();
    settings.barrier = args.barrier();
    let (outcome, wall_ms) = args.timed(|| {
        let mut noise = Noise::new(args.seed, args.guess_noise);
        problem.write_guess(&mut stages, || noise.sample());
        problem
            .plan(&settings, &mut stages, |progress| args.observe(progress))
            .map_err(|error| error.to_string())
    })?;
    let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    Ok(Planned {
        status: format!("{:?}", outcome.status),
        durations: stages[0].state.durations[..problem.phase_count].to_vec(),
        report: json!({
            "wall_ms": wall_ms,
            "iterations": outcome.iterations,
            "restarts": outcome.restarts,
            "cost": judged.cost,
            "max_violation": judged.max_violation,
        }),
        solution: json!({ "task": name, "sol": layout(&problem, &stages) }),
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
