//! Stage derivatives against finite differences.

use crate::common::differences::{entry, mixed, moved, reached};
use crate::common::{FEET, N, NI, NU, NX, Node, anywhere, based, config, data, jump, robot, stage};
use a1_model::A1Geared;
use nalgebra::Vector3;
use ocp_solver::{Derivatives, Evaluated, Problem as Ocp, Values, derivative_errors};
use proptest::prelude::*;
use srb_opt::Edge;
use wb_opt::{BASE, BaseCoordinates, EulerOrder, Friction, Problem, State};

/// Two nodes in the same base coordinates: a state and a control, and where to go.
fn pairs() -> impl Strategy<Value = (BaseCoordinates, Node, State<f64, N>)> {
    let pair =
        |base| (anywhere(base), anywhere(base)).prop_map(move |(node, next)| (base, node, next.0));
    let each = crate::common::BASES.map(|base| pair(base).boxed());
    prop::strategy::Union::new(each)
}

/// Multipliers of as many rows.
fn multipliers<const K: usize>() -> impl Strategy<Value = [f64; K]> {
    prop::array::uniform(-1.0..1.0_f64)
}

proptest! {
    #![proptest_config(config(24, 1))]

    #[test]
    fn first_derivatives((base, node, next) in pairs(), k in stage()) {
        let data = data();
        let mut problem = jump(&data, base);
        problem.edge = Some(Edge { drop: 0.3, axis: 1, sign: -1.0, distance: 0.18, width: 0.3 });
        let next = reached(base, problem.dt(k), &node, next);
        let errors = derivative_errors::<f64, _, NX, NU, NI>(
            &problem, k, &node.0, &node.1, Some(&next), 1e-6,
        );
        prop_assert!(errors.worst() < 2e-6, "{errors:?}");
    }

    #[test]
    fn second_derivatives((base, node, next) in pairs(), k in stage(), y in multipliers()) {
        let data = data();
        let mut problem = jump(&data, base);
        problem.edge = Some(Edge { drop: 0.3, axis: 0, sign: 1.0, distance: 0.1, width: 0.3 });
        let worst = hessian_error(&problem, k, (&node, next), &y);
        prop_assert!(worst < 2e-5, "{worst}");
    }

    #[test]
    fn of_the_geared_robot_on_rolling_feet_and_eight_sides((base, node, next) in pairs(), k in stage(), y in multipliers()) {
        let data = data();
        let mut problem = jump(&data, base);
        problem.robot = robot(&A1Geared, base);
        problem.feet.iter_mut().for_each(|foot| foot.radius = 0.2);
        problem.friction = Friction::within_cone(0.45, 0.57);
        let there = reached(base, problem.dt(k), &node, next);
        let errors = derivative_errors::<f64, _, NX, NU, NI>(
            &problem, k, &node.0, &node.1, Some(&there), 1e-6,
        );
        prop_assert!(errors.worst() < 2e-6, "{errors:?}");
        let worst = hessian_error(&problem, k, (&node, next), &y);
        prop_assert!(worst < 2e-5, "{worst}");
    }
}

proptest! {
    #![proptest_config(config(6, 2))]

    #[test]
    fn derivatives_of_the_last_node((base, node) in based(), y in multipliers()) {
        let data = data();
        let problem = jump(&data, base);
        let errors =
            derivative_errors::<f64, _, NX, NU, NI>(&problem, 34, &node.0, &node.1, None, 1e-6);
        prop_assert!(errors.worst() < 1e-7, "{errors:?}");
        prop_assert!(hessian_error(&problem, 34, (&node, node.0), &y) < 1e-6);
    }
}

proptest! {
    #![proptest_config(config(6, 3))]

    /// What the gap of a rotation adds to the Hessian, against second differences of its values.
    #[test]
    fn the_gap_of_a_rotation_bends_as_the_hessian_says(
        node in anywhere(BaseCoordinates::Rotation), next in anywhere(BaseCoordinates::Rotation), lambda in multipliers::<NX>(), k in stage(),
    ) {
        let data = data();
        let problem = jump(&data, BaseCoordinates::Rotation);
        let next = reached(problem.robot.base, problem.dt(k), &node, next.0);
        let (state, control) = node;
        let at = |lambda: &[f64; NX]| {
            let values = Values::<f64, NX, NI>::new();
            let mut d = Derivatives::<f64, NX, NU, NI>::new();
            let at = Evaluated {
                values: &values,
                dynamics_multiplier: lambda,
                row_multipliers: &[0.0; NI],
            };
            problem.differentiate(k, &state, &control, Some(&next), at, &mut d);
            d
        };
        let (with, without) = (at(&lambda), at(&[0.0; NX]));
        let gap = |steps: &[(usize, f64)]| {
            let (step, control) = moved(&control, steps);
            let x = Ocp::<f64, NX, NU, NI>::retract(&problem, k, &state, &step, None);
            let mut values = Values::<f64, NX, NI>::new();
            problem.evaluate(k, &x, &control, Some(&next), &mut values);
            values
                .gap
                .iter()
                .zip(&lambda)
                .map(|(g, l)| g * l)
                .sum::<f64>()
        };
        let h = 1e-3;
        // Rotation, angular velocity, angular acceleration.
        let turning = || (3..BASE).chain(N + 3..N + BASE).chain(NX + 3..NX + BASE);
        for i in turning() {
            for j in turning() {
                let found = mixed(gap, (i, h), (j, h));
                let wanted = entry(&with, i, j) - entry(&without, i, j);
                assert!((found - wanted).abs() < 1e-6, "{i} {j}: {found} {wanted}");
            }
        }
    }
}

proptest! {
    #![proptest_config(config(12, 17))]

    /// One motion of a robot in two base coordinates takes the same efforts.
    #[test]
    fn the_same_motion_takes_the_same_efforts((state, control) in anywhere(BaseCoordinates::Angles(EulerOrder::Zyx)), k in stage()) {
        let mut data = data();
        // So short that the middle is the start.
        data.phases.iter_mut().for_each(|phase| phase.dt = 1e-12);
        let euler = jump(&data, BaseCoordinates::Angles(EulerOrder::Zyx));
        let free = jump(&data, BaseCoordinates::Rotation);
        let rpy = Vector3::new(state.q[5], state.q[4], state.q[3]);
        let rates = Vector3::new(state.v[5], state.v[4], state.v[3]);
        let order = so3::euler::RollPitchYaw::Zyx;
        let rot_wb = order.rotation(&rpy);
        let by_rates = order.omega_from_rates(&rpy);
        let accelerations = Vector3::new(control[5], control[4], control[3]);
        let (mut same, mut same_control) = (state, control);
        same.rot_wc = rot_wb;
        let omega = by_rates * rates;
        // Control accelerations are in units of 100 rad/s².
        let alpha = by_rates * accelerations + order.omega_bias(&rpy, &rates) / 100.0;
        for i in 0..3 {
            same.q[3 + i] = 0.0;
            same.v[3 + i] = omega[i];
            same_control[3 + i] = alpha[i];
        }
        let (one, other) = (
            euler.sample(k, &state, &control),
            free.sample(k, &same, &same_control),
        );
        // The base's moments differ by the axes they are about, so joints only.
        for (a, b) in one.effort[BASE..].iter().zip(&other.effort[BASE..]) {
            assert!((a - b).abs() < 1e-8 * (1.0 + a.abs()), "{a} {b}");
        }
        for i in 0..3 {
            assert!((one.effort[i] - other.effort[i]).abs() < 1e-8 * (1.0 + one.effort[i].abs()));
        }
    }
}

/// Largest relative difference between the Hessian and differences of the Lagrangian's gradient, less the
/// part of the cost that is Gauss–Newton by construction: with the multipliers of the effort rows the
/// Hessian is exact.
fn hessian_error(
    problem: &Problem<'_, f64, N, FEET>,
    k: usize,
    (node, next): (&Node, State<f64, N>),
    y: &[f64; NI],
) -> f64 {
    let next = reached(problem.robot.base, problem.dt(k), node, next);
    let (state, control) = *node;
    let rows = Ocp::<f64, NX, NU, NI>::dims(problem, k).rows();
    let controls = Ocp::<f64, NX, NU, NI>::dims(problem, k).controls;
    let at = |state: &State<f64, N>, control: &[f64; NU]| {
        let values = Values::<f64, NX, NI>::new();
        let mut d = Derivatives::<f64, NX, NU, NI>::new();
        let at = Evaluated {
            values: &values,
            dynamics_multiplier: &[0.0; NX],
            row_multipliers: y,
        };
        let next = (k < problem.intervals()).then_some(&next);
        problem.differentiate(k, state, control, next, at, &mut d);
        d
    };
    let gradient = |d: &Derivatives<f64, NX, NU, NI>| {
        let (mut x, mut u) = (d.cost_x, d.cost_u);
        for (i, y) in y.iter().enumerate().take(rows) {
            x.iter_mut()
                .zip(&d.rows_x[i])
                .for_each(|(x, g)| *x += y * g);
            u.iter_mut()
                .zip(&d.rows_u[i])
                .for_each(|(u, g)| *u += y * g);
        }
        (x, u)
    };
    let h = 1e-5;
    let base = at(&state, &control);
    let size = base
        .hessian_xx
        .iter()
        .flatten()
        .chain(base.hessian_uu.iter().flatten())
        .fold(1.0_f64, |m, x| m.max(x.abs()));
    let all = NX + controls;
    let mut found = vec![vec![0.0; all]; all];
    for (j, column) in found.iter_mut().enumerate() {
        let moved = |h: f64| {
            let (step, control) = moved(&control, &[(j, h)]);
            let retract = Ocp::<f64, NX, NU, NI>::retract(problem, k, &state, &step, None);
            gradient(&at(&retract, &control))
        };
        let ((px, pu), (mx, mu)) = (moved(h), moved(-h));
        let plus = px.iter().chain(&pu).zip(mx.iter().chain(&mu));
        for (slot, (plus, minus)) in column.iter_mut().zip(plus) {
            *slot = (plus - minus) / (2.0 * h);
        }
    }
    let mut worst = 0.0_f64;
    for i in 0..all {
        for j in 0..all {
            // Gradients at different rotations are seen from different axes: the symmetric part is the Hessian.
            let found = 0.5 * (found[i][j] + found[j][i]);
            let error = (found - entry(&base, i, j)).abs() / size;
            if error > 2e-5 {
                eprintln!("{i} {j}: {found} {}", entry(&base, i, j));
            }
            worst = worst.max(error);
        }
    }
    worst
}
