//! Stage derivatives against finite differences.

use crate::common::{NI, NU, NX, config, jump, nodes};
use ocp_solver::{Derivatives, Evaluated, Problem as Ocp, Values, derivative_errors};
use proptest::prelude::*;
use srb_opt::Exponential;

proptest! {
    #![proptest_config(config(32, 1))]

    #[test]
    fn first_derivatives(mut stages in nodes(0.3), k in prop_oneof![1 => Just(0), 9 => 0..24_usize], exact: bool) {
        let mut problem = jump();
        if exact {
            problem.exponential = Exponential::Exact;
        }
        // The Jacobian of the rotation gap is exact where the gap is zero.
        let (x, u) = (stages[k].state, stages[k].control);
        let mut next = stages[k + 1].state;
        let dt = x.durations[problem.phase_of(k).unwrap().0] / problem.phase_of(k).unwrap().1.intervals as f64;
        let w = x.omega_b * dt;
        let a = nalgebra::Matrix3::new(0.0, -w.z, w.y, w.z, 0.0, -w.x, -w.y, w.x, 0.0);
        let taylor = nalgebra::Matrix3::identity() + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
        next.rot_wb = x.rot_wb * if exact { so3::exp(&w).into_inner() } else { taylor };
        stages[k + 1].state = next;
        let errors = derivative_errors::<f64, _, NX, NU, NI>(&problem, k, &x, &u, Some(&next), 1e-6);
        // Rotation rows carry the fourth-order defect of the Taylor exponential.
        let defect = if exact { 0.0 } else { w.norm_squared() * w.norm_squared() / 24.0 };
        prop_assert!(errors.cost < 1e-6 && errors.rows < 1e-6, "{errors:?}");
        prop_assert!(errors.dynamics < 2e-6 + 2.0 * defect, "{errors:?} {defect}");
    }

    #[test]
    fn first_derivatives_of_the_last_node(stages in nodes(0.1)) {
        let last = stages.last().unwrap();
        let errors = derivative_errors::<f64, _, NX, NU, NI>(&jump(), 24, &last.state, &last.control, None, 1e-6);
        prop_assert!(errors.worst() < 1e-7, "{errors:?}");
    }
}

proptest! {
    #![proptest_config(config(4, 3))]

    /// Second differences of the Lagrangian against the Hessian blocks that are claimed exact: everything
    /// bilinear in a duration, force × position and rotation, reach, clearance over an edge, rotation error.
    #[test]
    fn second_derivatives(
        stages in nodes(0.1), k in prop_oneof![0..10_usize, 10..16_usize, 16..24_usize],
        mut multiplier in prop::array::uniform(-2.5..2.5_f64), y in prop::array::uniform(-1.5..1.5_f64),
    ) {
        let mut problem = jump();
        // So near that the ground bends under the body.
        if let Some(edge) = &mut problem.edge {
            (edge.distance, edge.width) = (0.1, 0.1);
        }
        let (x, u, next) = (&stages[k].state, &stages[k].control, &stages[k + 1].state);
        // Of the rotation's gap and of durations nothing is claimed.
        multiplier[6..9].fill(0.0);
        multiplier[12..].fill(0.0);
        let lagrangian = |step: &[f64; NX], du: &[f64; NU]| {
            let moved = Ocp::<f64, NX, NU, NI>::retract(&problem, k, x, step, None);
            let mut control = *u;
            control.iter_mut().zip(du).for_each(|(u, du)| *u += du);
            let mut values = Values::<f64, NX, NI>::new();
            problem.evaluate(k, &moved, &control, Some(next), &mut values);
            let linear = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            values.cost + linear(&values.gap, &multiplier) + linear(&values.rows, &y)
        };
        let mut values = Values::<f64, NX, NI>::new();
        problem.evaluate(k, x, u, Some(next), &mut values);
        let mut d = Derivatives::<f64, NX, NU, NI>::new();
        let at = Evaluated {
            values: &values,
            dynamics_multiplier: &multiplier,
            row_multipliers: &y,
        };
        problem.differentiate(k, x, u, Some(next), at, &mut d);
        let h = 1e-4;
        let second = |i: usize, j: usize| {
            let at = |a: f64, b: f64| {
                let (mut step, mut du) = ([0.0; NX], [0.0; NU]);
                for (at, amount) in [(i, a), (j, b)] {
                    if at < NX {
                        step[at] += amount
                    } else {
                        du[at - NX] += amount
                    }
                }
                lagrangian(&step, &du)
            };
            (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4.0 * h * h)
        };
        let controls = problem
            .phase_of(k)
            .unwrap()
            .1
            .contacts
            .iter()
            .filter(|on| **on)
            .count()
            * 3;
        for i in 0..15 {
            for j in 0..15 {
                let (analytic, numeric) = (d.hessian_xx[j][i], second(i, j));
                assert!(
                    (analytic - numeric).abs() < 1e-4 * (1.0 + numeric.abs()),
                    "{k} {i} {j} {analytic} {numeric}"
                );
            }
            for j in 0..controls {
                let (analytic, numeric) = (d.hessian_xu[j][i], second(i, NX + j));
                assert!(
                    (analytic - numeric).abs() < 1e-4 * (1.0 + numeric.abs()),
                    "{k} {i} u{j} {analytic} {numeric}"
                );
            }
        }
    }
}
