//! Stage derivatives against finite differences.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use a1_model::A1Geared;
use common::{FEET, N, NI, NU, NX, Noise, anywhere, data, jump};
use ocp_solver::{Derivatives, Evaluated, Problem as Ocp, Values, derivative_errors};
use proptest::prelude::*;
use srb_opt::Edge;
use wb_opt::{EulerOrder, Problem, Robot, State};

const ORDERS: [EulerOrder; 2] = [EulerOrder::Zyx, EulerOrder::Zxy];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn first_derivatives(seed in 0u32..1_000_000, k in 0usize..34, order in 0usize..2) {
        let data = data();
        let mut problem = jump(&data, ORDERS[order]);
        problem.edge = Some(Edge { drop: 0.3, axis: 1, sign: -1.0, distance: 0.18, width: 0.3 });
        let mut noise = Noise(seed);
        let (state, control) = anywhere(&mut noise);
        let (next, _) = anywhere(&mut noise);
        let errors = derivative_errors::<f64, _, NX, NU, NI>(
            &problem, k, &state, &control, Some(&next), 1e-6,
        );
        prop_assert!(errors.worst() < 2e-6, "{errors:?}");
    }

    #[test]
    fn second_derivatives(seed in 0u32..1_000_000, k in 0usize..34, order in 0usize..2) {
        let data = data();
        let mut problem = jump(&data, ORDERS[order]);
        problem.edge = Some(Edge { drop: 0.3, axis: 0, sign: 1.0, distance: 0.1, width: 0.3 });
        let worst = hessian_error(&problem, seed, k);
        prop_assert!(worst < 2e-5, "{worst}");
    }

    #[test]
    fn of_the_geared_robot_on_rolling_feet(seed in 0u32..1_000_000, k in 0usize..34, order in 0usize..2) {
        let data = data();
        let mut problem = jump(&data, ORDERS[order]);
        problem.robot = Robot::on_euler_base(&A1Geared, ORDERS[order]);
        problem.feet.iter_mut().for_each(|foot| foot.radius = 0.2);
        let mut noise = Noise(seed);
        let (state, control) = anywhere(&mut noise);
        let (next, _) = anywhere(&mut noise);
        let errors = derivative_errors::<f64, _, NX, NU, NI>(
            &problem, k, &state, &control, Some(&next), 1e-6,
        );
        prop_assert!(errors.worst() < 2e-6, "{errors:?}");
        let worst = hessian_error(&problem, seed, k);
        prop_assert!(worst < 2e-5, "{worst}");
    }
}

#[test]
fn first_derivatives_of_the_last_node() {
    let data = data();
    let problem = jump(&data, EulerOrder::Zyx);
    let (state, control) = anywhere(&mut Noise(5));
    let errors =
        derivative_errors::<f64, _, NX, NU, NI>(&problem, 34, &state, &control, None, 1e-6);
    assert!(errors.worst() < 1e-7, "{errors:?}");
}

/// Largest relative difference between the Hessian and differences of the Lagrangian's gradient, less the
/// part of the cost that is Gauss–Newton by construction: with the multipliers of the effort rows the
/// Hessian is exact.
fn hessian_error(problem: &Problem<'_, f64, N, FEET>, seed: u32, k: usize) -> f64 {
    let mut noise = Noise(seed);
    let (state, control) = anywhere(&mut noise);
    let (next, _) = anywhere(&mut noise);
    let y: [f64; NI] = core::array::from_fn(|_| noise.next());
    let rows = Ocp::<f64, NX, NU, NI>::dims(problem, k).rows();
    let controls = Ocp::<f64, NX, NU, NI>::dims(problem, k).controls;
    let at = |state: &State<f64, N>, control: &[f64; NU]| {
        let values = Values::<f64, NX, NI>::new();
        let mut d = Derivatives::<f64, NX, NU, NI>::new();
        let at = Evaluated {
            values: &values,
            dynamics_multiplier: &[0.0; NX],
            row_multipliers: &y,
        };
        problem.differentiate(k, state, control, Some(&next), at, &mut d);
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
    let mut worst = 0.0_f64;
    let mut compare = |plus: f64, minus: f64, exact: f64, what: (&str, usize, usize)| {
        let error = ((plus - minus) / (2.0 * h) - exact).abs() / size;
        if error > 2e-5 {
            eprintln!("{what:?}: {} {exact}", (plus - minus) / (2.0 * h));
        }
        worst = worst.max(error);
    };
    for j in 0..NX + controls {
        let moved = |h: f64| {
            let mut step = [0.0; NX];
            let mut control = control;
            match j.checked_sub(NX) {
                None => step[j] = h,
                Some(u) => control[u] += h,
            }
            let retract = Ocp::<f64, NX, NU, NI>::retract(problem, k, &state, &step, None);
            gradient(&at(&retract, &control))
        };
        let ((px, pu), (mx, mu)) = (moved(h), moved(-h));
        for i in 0..NX {
            match j.checked_sub(NX) {
                None => compare(px[i], mx[i], base.hessian_xx[j][i], ("xx", j, i)),
                Some(u) => compare(px[i], mx[i], base.hessian_xu[u][i], ("ux", u, i)),
            }
        }
        for i in 0..controls {
            match j.checked_sub(NX) {
                None => compare(pu[i], mu[i], base.hessian_xu[i][j], ("xu", j, i)),
                Some(u) => compare(pu[i], mu[i], base.hessian_uu[u][i], ("uu", u, i)),
            }
        }
    }
    worst
}
