//! Solves many random jumps of the reference problem's form and says which fail.
//!
//! `cargo run --release -p srb-opt --example variants -- [how many] [first seed] [noisy guesses each]`
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "a program for the host"
)]

#[path = "../tests/variants/mod.rs"]
mod variants;

use core::ops::ControlFlow;
use ocp_solver::{Settings, Stage, Status};
use srb_opt::State;
use srb_opt::onboard::{Jump, PHASES};
use std::time::Instant;
use variants::{Draw, variant};

type Stages = Vec<Stage<f64, State<f64, PHASES>, 16, 12, 40>>;

fn solve(
    jump: &Jump<f64>,
    stages: &mut Stages,
    noise: f64,
    seed: u64,
) -> (Status, f64, usize, usize) {
    let mut draw = Draw(seed);
    jump.write_guess(stages, || {
        if noise > 0.0 {
            noise * draw.normal()
        } else {
            0.0
        }
    });
    let go = |_: &_| ControlFlow::Continue(());
    let found = jump.plan(&Settings::new(), stages, go).unwrap();
    let judged = jump.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    let honest = found.status != Status::Solved || judged.max_violation < 1e-6;
    assert!(
        honest,
        "called solved with violation {:e}",
        judged.max_violation
    );
    (found.status, judged.cost, found.iterations, found.restarts)
}

fn main() {
    let number = |i: usize, otherwise: u64| {
        std::env::args()
            .nth(i)
            .map_or(otherwise, |text| text.parse().unwrap())
    };
    let (count, first, noisy) = (number(1, 100), number(2, 1), number(3, 0));
    let (mut solved, mut restarted, mut iterations) = (0, 0, Vec::new());
    let (mut good, mut tries) = (0, 0);
    for seed in first..first + count {
        let (jump, text) = variant(seed);
        let mut stages: Stages = vec![Stage::new(State::new()); jump.intervals() + 1];
        let start = Instant::now();
        let (status, cost, steps, restarts) = solve(&jump, &mut stages, 0.0, 0);
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let durations = stages[0].state.durations;
        if status == Status::Solved {
            solved += 1;
            restarted += usize::from(restarts > 0);
            iterations.push(steps);
        }
        let mut noise = String::new();
        if noisy > 0 && status == Status::Solved {
            let runs: Vec<_> = (1..=noisy)
                .map(|i| solve(&jump, &mut stages, 0.1, i))
                .collect();
            let found = runs
                .iter()
                .filter(|run| run.0 == Status::Solved)
                .map(|run| run.1);
            let best = found.fold(cost, f64::min);
            let reach = |run: &&(Status, f64, usize, usize)| {
                run.0 == Status::Solved && run.1 <= 1.001 * cost
            };
            let reached = runs.iter().filter(reach).count();
            (good, tries) = (good + reached, tries + runs.len());
            noise = format!("; {reached}/{noisy} noisy, best {best:.4}");
            for run in runs.iter().filter(|run| !reach(run)) {
                noise += &format!(", {:?} {:.4} after {}", run.0, run.1, run.2);
            }
        }
        if status != Status::Solved || restarts > 0 || !noise.is_empty() {
            println!(
                "{seed}: {status:?} {steps} it ({restarts} restarts) {ms:.0} ms cost {cost:.4} T {durations:.3?}: {text}{noise}"
            );
        }
    }
    iterations.sort_unstable();
    let median = iterations.get(iterations.len() / 2).copied().unwrap_or(0);
    let most = iterations.last().copied().unwrap_or(0);
    println!(
        "{solved} of {count} solved, {restarted} of them after a restart; iterations {median} in the median, {most} at most"
    );
    if tries > 0 {
        println!("{good} of {tries} noisy guesses reach the cost of the plain one");
    }
}
