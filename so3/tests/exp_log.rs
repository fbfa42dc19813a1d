//! exp, log, log_near and rotation_about: oracle, group laws, edges, near-rotations.

#![allow(
    clippy::disallowed_methods,
    reason = "tests: only inputs are made here"
)]

use core::f64::consts::PI;

use crate::cases::{axes, distance, matrix_error, rotation_vector, rotation_vectors, to_f64};
use crate::oracle::even_series;
use proptest::prelude::*;
use so3::{
    Matrix3, Rotation3, Scalar, Unit, Vector3, exp, hat, log, log_near, orthogonality_defect,
    rotation_about, vee,
};

fn exact_exp<T: Scalar>(w: &Vector3<T>) -> [[f64; 3]; 3] {
    crate::oracle::polynomial(to_f64(w).into(), |z| (even_series(z, 1), even_series(z, 2)))
}

/// Difference in ε of two rotation vectors, ± at half a turn.
fn log_error<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> f64 {
    let (a, b) = (to_f64(a), to_f64(b));
    let eps = T::EPSILON.to_f64();
    let error = (a - b).norm();
    assert!(!error.is_nan());
    if b.norm() > PI - 4.0 * eps {
        error.min((a + b).norm()) / eps
    } else {
        error / eps
    }
}

#[test]
fn hat_is_the_cross_product() {
    let (w, v) = (Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.5, 0.25, -4.0));
    assert_eq!(hat(&w) * v, w.cross(&v));
    assert_eq!(hat(&w).transpose(), -hat(&w));
    assert_eq!(vee(&hat(&w)), w);
    assert_eq!(
        vee(&(hat(&w) + Matrix3::new(1., 2., 3., 2., 4., 5., 3., 5., 6.))),
        w
    );
}

fn exp_error<T: Scalar>() -> f64 {
    let turns = axes()
        .into_iter()
        .flat_map(|a| [4.0, 6.0, 2.0 * PI, 4.0 * PI].map(|angle| (a * angle).map(T::of)));
    rotation_vectors::<T>()
        .into_iter()
        .chain(turns)
        .map(|w| distance(exp(&w).matrix(), &exact_exp(&w)) / (1.0 + to_f64(&w).norm()))
        .fold(0.0, f64::max)
}

#[test]
fn exp_against_double_double() {
    for worst in [exp_error::<f64>(), exp_error::<f32>()] {
        println!("exp: {worst} ε (1 + |w|)");
        assert!(worst <= 1.0, "{worst}");
    }
}

fn defect_of_exp<T: Scalar>() -> f64 {
    rotation_vectors::<T>()
        .iter()
        .map(|w| orthogonality_defect(exp(w).matrix()).to_f64() / T::EPSILON.to_f64())
        .fold(0.0, f64::max)
}

#[test]
fn exp_is_orthonormal() {
    for worst in [defect_of_exp::<f64>(), defect_of_exp::<f32>()] {
        println!("defect of exp: {worst} ε");
        assert!(worst <= 8.0, "{worst}");
    }
}

fn round_trip_error<T: Scalar>() -> (f64, f64) {
    rotation_vectors::<T>()
        .iter()
        .fold((0.0, 0.0), |(absolute, relative), w| {
            let error = log_error(&log(&exp(w)), w);
            let length = to_f64(w).norm();
            // Where w is one axis, its direction is exact and small lengths keep their relative accuracy.
            let single = w.iter().filter(|c| **c != T::ZERO).count() == 1;
            let relevant = single && length > T::of(1e-30).to_f64() && length < 3.0;
            let relative_error = if relevant { error / length } else { 0.0 };
            (
                f64::max(absolute, error / (1.0 + length)),
                f64::max(relative, relative_error),
            )
        })
}

#[test]
fn log_inverts_exp() {
    for (absolute, relative) in [round_trip_error::<f64>(), round_trip_error::<f32>()] {
        println!("log(exp(w)) − w: {absolute} ε (1 + |w|), {relative} ε |w| on coordinate axes");
        assert!(absolute <= 2.0 && relative <= 4.0);
    }
}

/// Rotations by π built exactly: 2 a aᵀ − I for axes with exact squares.
#[test]
fn log_near_pi() {
    for (axis, m) in [
        (
            Vector3::x(),
            Matrix3::new(1., 0., 0., 0., -1., 0., 0., 0., -1.),
        ),
        (
            Vector3::y(),
            Matrix3::new(-1., 0., 0., 0., 1., 0., 0., 0., -1.),
        ),
        (
            Vector3::z(),
            Matrix3::new(-1., 0., 0., 0., -1., 0., 0., 0., 1.),
        ),
        (
            Vector3::new(0.6, 0.8, 0.0),
            Matrix3::new(-0.28, 0.96, 0., 0.96, 0.28, 0., 0., 0., -1.),
        ),
        (
            Vector3::new(-0.6, 0.0, 0.8),
            Matrix3::new(-0.28, 0., -0.96, 0., -1., 0., -0.96, 0., 0.28),
        ),
    ] {
        let w: Vector3<f64> = log(&Rotation3::from_matrix_unchecked(m));
        assert!((w - axis * PI).norm() < 2e-15, "{w}");
        let w: Vector3<f32> = log(&Rotation3::from_matrix_unchecked(m.map(|x: f64| x as f32)));
        assert!((w.map(f64::from) - axis * PI).norm() < 1e-6, "{w}");
    }
}

#[test]
fn log_of_garbage_ends() {
    let garbage = [f64::NAN, f64::INFINITY, 0.0, 1e308, -1e308];
    for a in garbage {
        for b in garbage {
            let m = Matrix3::new(a, b, a, b, a, b, b, a, a);
            let _ = log(&Rotation3::from_matrix_unchecked(m));
            let _ = exp(&Vector3::new(a, b, a));
        }
    }
    assert!(
        log(&Rotation3::from_matrix_unchecked(Matrix3::<f64>::zeros()))
            .norm()
            .is_finite()
    );
    assert!(
        exp(&Vector3::new(0.0, f64::NAN, 0.0))
            .matrix()
            .iter()
            .any(|x| x.is_nan())
    );
}

#[test]
fn log_near_counts_turns() {
    for axis in axes() {
        for turns in -3..=3 {
            for angle in [0.0, 1e-9, 0.5, 3.0, -3.0, -1e-9] {
                let w = axis * (2.0 * PI * f64::from(turns) + angle);
                let found = log_near(&exp(&w), &(w + Vector3::new(0.1, -0.1, 0.05)));
                let same = (exp(&found).matrix() - exp(&w).matrix()).norm();
                assert!(same < 1e-13, "not the same rotation: {same:e}");
                if angle.abs() > 0.1 {
                    assert!((found - w).norm() < 1e-12, "{found} is not {w}");
                }
            }
            // Exactly whole turns follow the hint's axis.
            let w = axis * (2.0 * PI * f64::from(turns));
            assert!((log_near(&Rotation3::identity(), &w) - w).norm() < 1e-14);
            assert!((log_near(&exp(&w), &w) - w).norm() < 1e-14);
        }
    }
}

#[test]
fn rotation_about_is_exp() {
    for axis in axes() {
        let unit = Unit::new_unchecked(axis);
        for angle in [0.0, 1e-9, -0.3, 2.0, PI, 3.0 * PI, 4.0 * PI, -4.0 * PI] {
            let error = matrix_error(
                rotation_about(&unit, angle).matrix(),
                exp(&(axis * angle)).matrix(),
            );
            assert!(error < 16.0, "{error} ε");
        }
        let whole = rotation_about(&unit, 4.0 * PI).matrix() - Matrix3::identity();
        assert!(whole.norm() < 1e-15);
    }
}

proptest! {
    #[test]
    fn group_laws(u in rotation_vector(), v in rotation_vector(), w in rotation_vector()) {
        let (a, b, c) = (exp(&u), exp(&v), exp(&w));
        prop_assert!(matrix_error(((a * b) * c).matrix(), (a * (b * c)).matrix()) < 16.0);
        prop_assert!(matrix_error((a * exp(&-u)).matrix(), &Matrix3::identity()) < 16.0);
        prop_assert!((a.matrix().determinant() - 1.0).abs() < 1e-14);
        // Adjoint: R exp(v) Rᵀ = exp(R v), and one-parameter subgroups.
        let conjugate = a * b * a.transpose();
        prop_assert!(matrix_error(conjugate.matrix(), exp(&(a * v)).matrix()) < 64.0);
        prop_assert!(matrix_error((exp(&(u * 0.25)) * exp(&(u * 0.75))).matrix(), a.matrix()) < 16.0);
    }

    #[test]
    fn log_round_trips(w in rotation_vector()) {
        prop_assert!(log_error(&log(&exp(&w)), &w) < 4.0 * (1.0 + w.norm()));
        let w = w.map(|c| c as f32);
        prop_assert!(log_error(&log(&exp(&w)), &w) < 4.0 * (1.0 + f64::from(w.norm())));
    }

    #[test]
    fn exp_round_trips(w in rotation_vector()) {
        let rot = exp(&w);
        prop_assert!(matrix_error(exp(&log(&rot)).matrix(), rot.matrix()) < 16.0);
        prop_assert!(log(&rot).norm() <= PI * (1.0 + 2.0 * f64::EPSILON));
    }

    /// A deviation of size δ moves the logarithm by at most 4 δ, up to the sign near half a turn.
    #[test]
    fn log_of_near_rotations(
        w in rotation_vector(),
        noise in prop::array::uniform9(-1.0..1.0_f64),
        size in -12.0..-1.5_f64,
    ) {
        let noise = Matrix3::from_row_slice(&noise) * 10.0_f64.powf(size);
        let found = log(&Rotation3::from_matrix_unchecked(exp(&w).matrix() + noise));
        let error = (found - w).norm().min((found + w).norm());
        // Across half a turn the vector continues at the other end.
        let across = (found + w * (2.0 * PI / w.norm() - 1.0)).norm();
        prop_assert!(error.min(across) <= 4.0 * noise.norm() + 1e-14, "{error:e} for {:e}", noise.norm());
    }
}
