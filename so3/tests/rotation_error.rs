//! Rotation errors of paper A's problem (2) and geodesics.
#![allow(clippy::disallowed_methods, reason = "std is the reference here")]

use core::f64::consts::PI;

use crate::cases::{axes, axis, matrix_error, rotation_vector};
use proptest::prelude::*;
use so3::{
    Geodesic, Matrix3, Rotation3, Unit, Vector3, exp, right_jacobian_inverse, rotation_error,
    rotation_error_smoothed,
};

proptest! {
    #[test]
    fn rotation_error_is_the_turn(start in rotation_vector(), turn in rotation_vector()) {
        let rot_ref = exp(&start);
        let rot = rot_ref * exp(&turn);
        let error = rotation_error(&rot_ref, &rot);
        prop_assert!((error - turn).norm().min((error + turn).norm()) < 1e-14);
        prop_assert!(rotation_error(&rot, &rot).norm() < 1e-15);
        // Expressed in the reference frame and in the body frame alike.
        prop_assert!((exp(&turn) * error - error).norm() < 1e-14);
        let (rot_ref, rot) = (rot_ref.cast::<f32>(), rot.cast::<f32>());
        let single = rotation_error(&rot_ref, &rot).cast::<f64>();
        prop_assert!((single - turn).norm().min((single + turn).norm()) < 1e-5);
    }

    #[test]
    fn rotation_error_moves_with_the_inverse_jacobian(
        turn in rotation_vector(),
        direction in axis(),
    ) {
        prop_assume!(turn.norm() < 3.1);
        let (reference, rot) = (Rotation3::identity(), exp(&turn));
        let at = |h: f64| rotation_error(&reference, &(rot * exp(&(direction * h))));
        let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
        prop_assert!((difference - right_jacobian_inverse(&at(0.0)) * direction).norm() < 1e-9);
    }

    /// The formula of the reference problem, evaluated from axis and angle instead of from matrices.
    #[test]
    fn smoothed_error_is_the_formula(turn in rotation_vector(), start in rotation_vector()) {
        let rot_ref = exp(&start);
        let error = rotation_error_smoothed(&rot_ref, &(rot_ref * exp(&turn)));
        let theta = turn.norm();
        let r = (theta.sin().powi(2) + 1e-6).sqrt();
        let length = theta.sin() * r.atan2(theta.cos()) / r;
        let expected = if theta > 0.0 { turn * (length / theta) } else { turn };
        // Near half a turn its slope is π/1e-3.
        prop_assert!((error - expected).norm() < 2e-11);
    }

    #[test]
    fn geodesic_meets_its_ends(start in rotation_vector(), end in rotation_vector()) {
        let (start, end) = (exp(&start), exp(&end));
        let path = Geodesic::shortest(&start, &end);
        prop_assert!(path.rotation_vector().norm() <= PI * (1.0 + 1e-15));
        prop_assert!(matrix_error(path.at(0.0).matrix(), start.matrix()) < 4.0);
        prop_assert!(matrix_error(path.at(1.0).matrix(), end.matrix()) < 16.0);
        let (first, second) = (start.transpose() * path.at(0.5), path.at(0.5).transpose() * end);
        prop_assert!(matrix_error(first.matrix(), second.matrix()) < 32.0, "equal halves");
    }

    #[test]
    fn geodesic_counts_turns(start in rotation_vector(), axis in axis(), angle in -20.0..20.0_f64) {
        let start = exp(&start);
        let path = Geodesic::about(&start, &Unit::new_unchecked(axis), angle);
        let again = Geodesic::near(&start, &path.at(1.0), &(axis * (angle + 0.5)));
        prop_assert!((again.rotation_vector() - path.rotation_vector()).norm() < 1e-11
            || (angle % (2.0 * PI)).abs() < 1e-3 || (angle % PI).abs() > PI - 1e-3);
        prop_assert!(matrix_error(again.at(1.0).matrix(), path.at(1.0).matrix()) < 200.0);
    }
}

#[test]
fn smoothed_error_near_zero_and_pi() {
    let identity = Rotation3::identity();
    for axis in axes() {
        for theta in [0.0_f64, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 2.0, 3.0] {
            let error = rotation_error_smoothed(&identity, &exp(&(axis * theta)));
            let deviation = (error - axis * theta).norm();
            let stated = if theta <= 0.1 {
                4e-7
            } else {
                7e-7 / theta.sin().powi(2)
            };
            assert!(deviation <= stated * theta, "{deviation:e} at {theta}");
        }
        assert!(rotation_error_smoothed(&identity, &exp(&(axis * PI))).norm() < 3e-12);
    }
}

#[test]
fn geodesic_turns_twice() {
    for axis in axes() {
        let unit = Unit::new_unchecked(axis);
        let start = exp(&Vector3::new(0.1, -0.7, 0.4));
        let path = Geodesic::about(&start, &unit, 4.0 * PI);
        for (fraction, angle) in [
            (0.0, 0.0),
            (0.125, 0.5 * PI),
            (0.25, PI),
            (0.5, 0.0),
            (1.0, 0.0),
        ] {
            let expected = start * exp(&(axis * angle));
            assert!(matrix_error(path.at(fraction).matrix(), expected.matrix()) < 16.0);
        }
    }
    let spin = Geodesic::new(Rotation3::identity(), Vector3::new(0.0, 0.0, 7.0_f32));
    let quarter = spin.at(core::f32::consts::FRAC_PI_2 / 7.0);
    assert!(
        matrix_error(
            quarter.matrix(),
            &Matrix3::new(0., -1., 0., 1., 0., 0., 0., 0., 1.)
        ) < 4.0
    );
}
