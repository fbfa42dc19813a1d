//! Gains against differences of the efforts, with controls that respond to the state.

use crate::common::{N, NU, NX, Node, based, config, data, jump, robot, stage};
use a1_model::A1Geared;
use ocp_solver::Problem as Ocp;
use proptest::prelude::*;
use wb_opt::BaseCoordinates;

proptest! {
    #![proptest_config(config(12, 11))]
    #[test]
    fn efforts_and_forces_change_as_the_gains_say(
        (base, node) in based(), gain in prop::collection::vec(-1.0..1.0_f64, NU * NX), k in stage(),
    ) {
        let mut matrix = Box::new([[0.0; NX]; NU]);
        matrix.as_flattened_mut().copy_from_slice(&gain);
        efforts_and_forces_change(base, k, node, &matrix);
    }
}

fn efforts_and_forces_change(
    base: BaseCoordinates,
    k: usize,
    (state, control): Node,
    gain: &[[f64; NX]; NU],
) {
    let data = data();
    let mut problem = jump(&data, base);
    problem.robot = robot(&A1Geared, base);
    problem.feet.iter_mut().for_each(|foot| foot.radius = 0.02);
    let gains = problem.gains(k, &state, &control, gain);
    let controls = Ocp::<f64, NX, NU, { crate::common::NI }>::dims(&problem, k).controls;
    let h = 1e-6;
    for j in 0..2 * N {
        let moved = |h: f64| {
            // The solver's tangent coordinate of a rate is in units of 5 rad/s.
            let mut step = [0.0; NX];
            step[j] = if j < N { h } else { h / 5.0 };
            let x = Ocp::<f64, NX, NU, { crate::common::NI }>::retract(
                &problem, k, &state, &step, None,
            );
            let mut u = control;
            for (u, row) in u.iter_mut().zip(gain).take(controls) {
                *u += row.iter().zip(&step).map(|(k, d)| k * d).sum::<f64>();
            }
            problem.sample(k, &x, &u)
        };
        let (plus, minus) = (moved(h), moved(-h));
        for i in 6..N {
            let found = (plus.effort[i] - minus.effort[i]) / (2.0 * h);
            let wanted = match j.checked_sub(N) {
                None => gains.effort_by_q[i][j],
                Some(j) => gains.effort_by_v[i][j],
            };
            assert!(
                (found - wanted).abs() < 1e-5 * (1.0 + wanted.abs()),
                "{k} {i} {j}"
            );
        }
        for foot in 0..4 {
            for c in 0..3 {
                let (plus, minus) = (plus.forces_w[foot][c], minus.forces_w[foot][c]);
                let wanted = match j.checked_sub(N) {
                    None => gains.force_by_q[foot][c][j],
                    Some(j) => gains.force_by_v[foot][c][j],
                };
                assert!(((plus - minus) / (2.0 * h) - wanted).abs() < 1e-5 * (1.0 + wanted.abs()));
            }
        }
    }
}
