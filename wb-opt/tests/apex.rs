//! A friction cone whose apex is above the ground: a margin in newtons on every side.

use crate::common::{BASES, FEET, N, NI, NU, NX, data, jump};
use ocp_solver::{Problem as Ocp, Values};
use wb_opt::{Friction, Problem, State};

/// The rows of the first interval at rest, with the same force on all feet, N, and their lower bounds.
fn rows(problem: &Problem<'_, f64, N, FEET>, force_w: [f64; 3]) -> (Vec<f64>, Vec<f64>) {
    let state = State::at_rest(problem.start);
    let mut control = [0.0; NU];
    for foot in 0..4 {
        for axis in 0..3 {
            // Forces stand behind the base's six accelerations, in units of 50 N.
            control[6 + 3 * foot + axis] = force_w[axis] / 50.0;
        }
    }
    let mut values = Values::<f64, NX, NI>::new();
    Ocp::<f64, NX, NU, NI>::evaluate(problem, 0, &state, &control, Some(&state), &mut values);
    let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
    Ocp::<f64, NX, NU, NI>::bounds(problem, 0, &mut lower, &mut upper);
    let sides = problem.friction.sides();
    (values.rows[..sides].to_vec(), lower[..sides].to_vec())
}

#[test]
fn side_forces_end_where_those_of_a_smaller_normal_force_do() {
    let data = data();
    let mut problem = jump(&data, BASES[2]);
    problem.friction = Friction {
        apex: 12.0,
        ..Friction::within_cone(0.45, 0.57)
    };
    let fits = |problem: &Problem<'_, f64, N, FEET>, force_w| {
        let (rows, lower) = rows(problem, force_w);
        rows.iter().zip(&lower).all(|(row, least)| row >= least)
    };
    for normal in [20.0, 60.0, 160.0] {
        let most = 0.45 * (normal - 12.0);
        for side in [-1.0, 1.0] {
            assert!(fits(&problem, [side * (most - 1e-9), 0.0, normal]));
            assert!(!fits(&problem, [side * (most + 1e-6), 0.0, normal]));
            assert!(!fits(&problem, [0.0, side * (most + 1e-6), normal]));
        }
        // Diagonals are drawn in as well.
        let corner = 0.57 * (normal - 12.0) * core::f64::consts::FRAC_1_SQRT_2;
        assert!(!fits(&problem, [1.01 * corner, 1.01 * corner, normal]));
    }
    assert!(
        !fits(&problem, [0.0, 0.0, 11.0]),
        "nothing is left below the apex"
    );
    problem.friction.apex = 0.0;
    assert!(fits(&problem, [0.0, 0.0, 11.0]));
    problem.friction.apex = -1.0;
    assert!(problem.check().is_err());
}
