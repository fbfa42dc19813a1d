//! A smaller version of `examples/variants.rs`: jumps that nobody tuned for are solved, and from noisy guesses too.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests")]

use crate::variants::{Draw, variant};
use core::ops::ControlFlow;
use ocp_solver::{Settings, Stage, Status};
use srb_opt::State;
use srb_opt::onboard::{Jump, PHASES};

fn solve(jump: &Jump<f64>, noise: f64, seed: u64) -> Option<f64> {
    let mut stages =
        vec![Stage::<_, _, 16, 12, 40>::new(State::<f64, PHASES>::new()); jump.intervals() + 1];
    let mut draw = Draw(seed);
    jump.write_guess(&mut stages, || noise * draw.normal());
    let go = |_: &_| ControlFlow::Continue(());
    let found = jump.plan(&Settings::new(), &mut stages, go).unwrap();
    let judged = jump.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    let solved = found.status == Status::Solved;
    assert!(!solved || judged.max_violation < 1e-6, "{judged:?}");
    solved.then_some(judged.cost)
}

#[test]
fn random_jumps_are_solved() {
    for seed in 1..=20 {
        let (jump, text) = variant(seed);
        assert!(solve(&jump, 0.0, 0).is_some(), "{seed}: {text}");
    }
}

#[test]
fn noisy_guesses_reach_the_same_cost() {
    // A double roll and a double flip, whose second contact phase likes to collapse.
    for seed in [5016, 5025] {
        let (jump, text) = variant(seed);
        let cost = solve(&jump, 0.0, 0).unwrap();
        let reached = (1..=10)
            .filter_map(|i| solve(&jump, 0.1, i))
            .filter(|found| *found <= 1.001 * cost);
        assert_eq!(reached.count(), 10, "{seed}: {text}");
    }
}
