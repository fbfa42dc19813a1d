//! A motion on long intervals is nearly one on their parts.

use crate::common::{BASES, FEET, N, NI, NU, NX, anywhere, config, data, jump};
use ocp_solver::{Problem as Ocp, SparseStage, Values};
use proptest::prelude::*;
use wb_opt::{BASE, BaseCoordinates, Problem, State};

/// Three coordinates that turn the base.
const TURN: core::ops::Range<usize> = 3..BASE;

/// What is missing from a stage to the next.
fn gap(
    problem: &Problem<'_, f64, N, FEET>,
    k: usize,
    stages: &[SparseStage<f64, State<f64, N>, NX, NU, NI>],
) -> [f64; NX] {
    let mut values = Values::<f64, NX, NI>::new();
    let next = Some(&stages[k + 1].state);
    let stage = &stages[k];
    Ocp::<f64, NX, NU, NI>::evaluate(problem, k, &stage.state, &stage.control, next, &mut values);
    values.gap
}

proptest! {
    #![proptest_config(config(3, 7))]
    #[test]
    fn parts_of_an_interval_follow_from_each_other(
        nodes in BASES.map(|base| prop::collection::vec(anywhere(base), 4)),
    ) {
        let data = data();
        for (base, nodes) in BASES.into_iter().zip(nodes) {
        let problem = jump(&data, base);
        for parts in [1, 2, 4] {
            let mut stages =
                vec![SparseStage::sparse(State::at_rest(problem.start)); problem.intervals() + 1];
            problem.write_split(&mut stages, &nodes, parts);
            for (k, stage) in stages.iter().enumerate().take(4 * parts) {
                assert_eq!(stage.control, nodes[k / parts].1);
                if k % parts == 0 {
                    assert_eq!(stage.state, nodes[k / parts].0);
                    continue;
                }
                let gap = gap(&problem, k - 1, &stages);
                let freely = base == BaseCoordinates::Rotation;
                for (i, gap) in gap.iter().enumerate() {
                    if !(freely && TURN.contains(&(i % N))) {
                        assert!(gap.abs() < 1e-12, "{base:?} {parts} {k} {i}: {gap}");
                    }
                }
                // 12 is the Magnus expansion's; the time is that since the node.
                let (state, control) = &nodes[k / parts];
                let size = |x: &[f64]| so3::math::sqrt(x.iter().map(|x| x * x).sum::<f64>());
                let (omega, alpha) = (size(&state.v[TURN]), 100.0 * size(&control[TURN]));
                let time = 0.01 * parts as f64;
                let most = (omega + alpha * time) * alpha * (time * time * time) / 12.0;
                assert!(size(&gap[TURN]) < most, "{base:?} {parts} {k}");
            }
        }
    }
}
}
