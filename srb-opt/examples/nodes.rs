//! Time per iteration against the number of nodes, and its parts, on the reference problems.
//!
//! `cargo run --release -p srb-opt --features bench --example nodes -- [task, default lateral] [noisy guesses each]`
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a program for the host"
)]

#[path = "../tests/reference/mod.rs"]
mod reference;
#[path = "../tests/variants/mod.rs"]
mod variants;

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicU64, Ordering};
use ocp_solver::{
    Derivatives, Dims, Evaluated, Problem as Ocp, Settings, Solver, Stage, Status, Values,
};
use reference::TASKS;
use srb_opt::State;
use srb_opt::onboard::{Jump, PHASES};
use std::time::Instant;
use variants::Draw;

type Stages = Vec<Stage<f64, State<f64, PHASES>, 16, 12, 40>>;

/// The problem, with a clock around what the solver asks of it.
struct Timed<'a> {
    jump: &'a Jump<f64>,
    evaluate: Clock,
    differentiate: Clock,
}

/// Nanoseconds that were spent.
#[derive(Default)]
struct Clock(AtomicU64);

impl Clock {
    fn add_since(&self, start: Instant) {
        let spent = start.elapsed().as_nanos() as u64;
        self.0.fetch_add(spent, Ordering::Relaxed);
    }

    fn seconds(&self) -> f64 {
        self.0.load(Ordering::Relaxed) as f64 * 1e-9
    }
}

impl Ocp<f64, 16, 12, 40> for Timed<'_> {
    type State = State<f64, PHASES>;

    fn intervals(&self) -> usize {
        self.jump.intervals()
    }

    fn dims(&self, k: usize) -> Dims {
        Ocp::<f64, 16, 12, 40>::dims(self.jump, k)
    }

    fn bounds(&self, k: usize, lower: &mut [f64; 40], upper: &mut [f64; 40]) {
        Ocp::<f64, 16, 12, 40>::bounds(self.jump, k, lower, upper);
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        Ocp::<f64, 16, 12, 40>::is_free_at_start(self.jump, i)
    }

    fn retract(
        &self,
        k: usize,
        state: &Self::State,
        step: &[f64; 16],
        before: Option<(&Self::State, &[f64; 12])>,
    ) -> Self::State {
        let start = Instant::now();
        let out = Ocp::<f64, 16, 12, 40>::retract(self.jump, k, state, step, before);
        self.evaluate.add_since(start);
        out
    }

    fn evaluate(
        &self,
        k: usize,
        state: &Self::State,
        control: &[f64; 12],
        next: Option<&Self::State>,
        values: &mut Values<f64, 16, 40>,
    ) {
        let start = Instant::now();
        self.jump.evaluate(k, state, control, next, values);
        self.evaluate.add_since(start);
    }

    fn differentiate(
        &self,
        k: usize,
        state: &Self::State,
        control: &[f64; 12],
        next: Option<&Self::State>,
        at: Evaluated<'_, f64, 16, 40>,
        derivatives: &mut Derivatives<f64, 16, 12, 40>,
    ) {
        let start = Instant::now();
        self.jump
            .differentiate(k, state, control, next, at, derivatives);
        self.differentiate.add_since(start);
    }
}

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_else(|| "lateral".into());
    let Some(task) = TASKS.iter().find(|task| task.name == wanted) else {
        panic!("no task `{wanted}`");
    };
    let noisy = (std::env::args().nth(2)).map_or(0, |text| text.parse().unwrap());
    println!("{wanted}: least of 15 runs, microseconds per iteration and node");
    println!(
        "intervals | iterations | total | derivatives | line search | factorisation and the rest"
    );
    for intervals in [25.0, 50.0, 100.0, 200.0, 400.0] {
        let whole = task.problem(1.0).intervals() as f64;
        let jump = task.problem(intervals / whole);
        let mut stages: Stages = vec![Stage::new(State::new()); jump.intervals() + 1];
        let (mut best, mut parts) = (f64::INFINITY, (0.0, 0.0));
        let mut iterations = 0;
        for _ in 0..15 {
            let timed = Timed {
                jump: &jump,
                evaluate: Clock::default(),
                differentiate: Clock::default(),
            };
            jump.write_guess(&mut stages, || 0.0);
            let start = Instant::now();
            let found = Solver::new(Settings::new())
                .solve(&timed, &mut stages, |_| ControlFlow::Continue(()))
                .unwrap();
            let seconds = start.elapsed().as_secs_f64();
            assert_eq!(found.status, Status::Solved);
            iterations = found.iterations;
            let per = 1e6 / (iterations * stages.len()) as f64;
            if seconds * per < best {
                best = seconds * per;
                parts = (
                    timed.differentiate.seconds() * per,
                    timed.evaluate.seconds() * per,
                );
            }
        }
        let rest = best - parts.0 - parts.1;
        println!(
            "{} | {iterations} | {best:.2} | {:.2} | {:.2} | {rest:.2}",
            jump.intervals(),
            parts.0,
            parts.1
        );
    }
    println!(
        "All nine, as stated: iterations, cost, share of IPOPT's, noisy guesses that reach it"
    );
    for task in &TASKS {
        let jump = task.problem(1.0);
        let mut stages: Stages = vec![Stage::new(State::new()); jump.intervals() + 1];
        let mut solve = |noise: f64, seed: u64| {
            let mut draw = Draw(seed);
            jump.write_guess(&mut stages, || noise * draw.normal());
            let go = |_: &_| ControlFlow::Continue(());
            let found = jump.plan(&Settings::new(), &mut stages, go).unwrap();
            let nodes = stages.iter().map(|stage| (&stage.state, &stage.control));
            (found, jump.judge(nodes))
        };
        let (found, judged) = solve(0.0, 0);
        let reached = (1..=noisy).filter(|seed| {
            let (found, judged) = solve(0.1, *seed);
            found.status == Status::Solved && judged.cost <= 1.001 * task.cost
        });
        let reached = reached.count();
        println!(
            "{} | {:?} | {} ({} factorisations) | {:.4} | {:.6} | violation {:.0e} | {reached} of {noisy}",
            task.name,
            found.status,
            found.iterations,
            found.factorisations,
            judged.cost,
            judged.cost / task.cost,
            judged.max_violation
        );
    }
}
