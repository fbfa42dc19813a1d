//! Remark 1 of paper A: the exponential to degree 4 in place of the exact one.

use super::Row;
use core::hint::black_box;
use jump_planner::task::{SrbPlan, Task};
use nalgebra::Vector3;
use srb_opt::Exponential;
use std::time::Instant;

/// Steps of a rotation in one timed run.
const STEPS: usize = 20_000;
/// Runs of each.
const RUNS: usize = 5;

fn empty() -> Row {
    Row::new(
        'A',
        "Remark 1: exponential to degree 4 in place of the exact one, double backflip",
        "stays on SO(3) at reasonable accuracy, fast",
    )
}

/// The row of a plan that there is not.
pub(super) fn failed(error: String) -> Row {
    empty().failed(error)
}

/// How far Taylor's exponential strays over the turns of a whole plan, and what the exact one takes.
pub(super) fn row(task: &Task, srb: &SrbPlan) -> Row {
    let (mut largest, mut sum) = (0.0, 0.0);
    for (k, stage) in srb.stages.iter().enumerate() {
        let Some((phase, data)) = task.problem.phase_of(k) else {
            continue;
        };
        let dt = stage.state.durations[phase] / data.intervals as f64;
        let turn = stage.state.omega_b * dt;
        let strays = (so3::exp_taylor4(&turn) - so3::exp(&turn).matrix()).norm();
        largest = f64::max(largest, strays);
        sum += strays;
    }
    match exponentials(task) {
        Ok(Exponentials {
            steps,
            solves,
            apart,
        }) => empty().ours(
            format!(
                "at most {largest:.1e} per interval, {sum:.1e} over the plan; the exact one takes {steps:.1} times as long per \
                 step and {solves:.2} times per iteration of the planner, and its plan has durations within {apart:.1e} s"
            ),
            sum < 0.017,
            "holds when the whole plan strays by less than a degree; times are told and not judged",
        ),
        Err(error) => failed(error),
    }
}

/// Exact over Taylor's exponential.
struct Exponentials {
    /// Time of a step.
    steps: f64,
    /// Time of an iteration of the planner.
    solves: f64,
    /// Largest difference of a duration, s.
    apart: f64,
}

/// Both exponentials in turns, so that a loaded machine loads both.
fn exponentials(task: &Task) -> Result<Exponentials, String> {
    let mut least = [[f64::INFINITY; 2]; 2];
    let mut durations = [None; 2];
    let mut task = task.clone();
    for _ in 0..RUNS {
        for (i, kind) in [Exponential::Taylor4, Exponential::Exact]
            .into_iter()
            .enumerate()
        {
            task.problem.exponential = kind;
            let plan = task.solve()?;
            let per_iteration = plan.wall_ms / f64::from(plan.iterations.max(1));
            least[i][0] = least[i][0].min(per_iteration);
            durations[i] = plan.stages.first().map(|stage| stage.state.durations);
            let clock = Instant::now();
            for _ in 0..STEPS {
                let turn = black_box(Vector3::repeat(0.1));
                black_box(match kind {
                    Exponential::Taylor4 => so3::exp_taylor4(&turn),
                    Exponential::Exact => so3::exp(&turn).into_inner(),
                });
            }
            least[i][1] = least[i][1].min(clock.elapsed().as_secs_f64());
        }
    }
    let [taylor, exact] = least;
    let pairs = durations[0]
        .iter()
        .flatten()
        .zip(durations[1].iter().flatten());
    Ok(Exponentials {
        steps: exact[1] / taylor[1],
        solves: exact[0] / taylor[0],
        apart: pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs())),
    })
}
