//! Several threads plan what one does.

use crate::common::{NI, NU, NX, config, jump};
use core::ops::ControlFlow;
use ocp_solver::{Keep, LeanStage, Progress, Settings, Solution, SparseStage, Stage};
use proptest::prelude::*;
use srb_opt::{Problem, State};

/// Everything that a solve tells and leaves behind.
type Trace = (
    Solution<f64>,
    Vec<Progress<f64>>,
    Vec<(State<f64, 4>, [f64; NU])>,
);

fn solved<K: Keep<f64, NX, NU, NI>>(
    problem: &Problem<f64, 4, 4>,
    noise: &[f64],
    threads: usize,
    empty: Stage<f64, State<f64, 4>, NX, NU, NI, K>,
) -> Trace {
    let mut settings = Settings::new();
    (settings.threads, settings.max_iterations) = (threads, 60);
    settings.restoration_iterations = 20;
    let mut stages = vec![empty; problem.intervals() + 1];
    let mut drawn = noise.iter().copied().cycle();
    problem.write_guess(&mut stages, || drawn.next().unwrap());
    let mut told = Vec::new();
    let observer = |progress: &Progress<f64>| {
        told.push(*progress);
        ControlFlow::Continue(())
    };
    let solution = problem.plan(&settings, &mut stages, observer).unwrap();
    let points = stages.iter().map(|stage| (stage.state, stage.control));
    (solution, told, points.collect())
}

proptest! {
    #![proptest_config(config(6, 5))]
    /// Goals within reach and out of it, guesses that have to be shifted, corrected and restored from.
    #[test]
    fn threads_change_no_bit(
        goal in prop::array::uniform3(-0.6..0.6_f64),
        noise in prop::collection::vec(-0.3..0.3_f64, 7),
        threads in 2..6_usize,
    ) {
        let mut problem = jump();
        (problem.edge, problem.goal_w) = (None, nalgebra::Vector3::from(goal));
        let dense = |threads| solved(&problem, &noise, threads, Stage::new(State::new()));
        let sparse = |threads| solved(&problem, &noise, threads, SparseStage::sparse(State::new()));
        let lean = |threads| solved(&problem, &noise, threads, LeanStage::lean(State::new()));
        let alone = dense(1);
        prop_assert_eq!(&dense(threads), &alone);
        prop_assert_eq!(&sparse(threads), &alone);
        prop_assert_eq!(&lean(threads), &alone);
    }
}
