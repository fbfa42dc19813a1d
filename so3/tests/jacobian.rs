//! Jacobians against a double-double oracle, as derivatives, and as inverses of each other.

use crate::cases::{distance, matrix_error, rotation_vector, rotation_vectors, to_f64};
use crate::oracle::even_series;
use proptest::prelude::*;
use so3::{
    Matrix3, Scalar, Vector3, exp, exp_with_jacobian, left_jacobian, left_jacobian_inverse, log,
    log_with_jacobian_inverse, right_jacobian, right_jacobian_inverse,
};

fn oracle_errors<T: Scalar>() -> (f64, f64, f64) {
    rotation_vectors::<T>()
        .iter()
        .fold((0.0, 0.0, 0.0), |worst, w| {
            let exact = crate::oracle::polynomial(to_f64(w).into(), |z| {
                (even_series(z, 2), even_series(z, 3))
            });
            let exact_inverse = crate::oracle::polynomial(to_f64(w).into(), |z| {
                (
                    crate::oracle::Dd(-0.5, 0.0),
                    crate::oracle::inverse_coefficient(z),
                )
            });
            let product = left_jacobian(w) * left_jacobian_inverse(w);
            (
                worst.0.max(distance(&left_jacobian(w), &exact)),
                worst
                    .1
                    .max(distance(&left_jacobian_inverse(w), &exact_inverse)),
                worst.2.max(matrix_error(&product, &Matrix3::identity())),
            )
        })
}

#[test]
fn jacobian_against_double_double() {
    for worst in [oracle_errors::<f64>(), oracle_errors::<f32>()] {
        println!("J, J⁻¹, J J⁻¹ − I: {worst:?} ε");
        assert!(worst.0 <= 2.0 && worst.1 <= 4.0);
    }
}

#[test]
fn inverse_jacobians() {
    for worst in [oracle_errors::<f64>(), oracle_errors::<f32>()] {
        assert!(worst.2 <= 8.0, "{} ε", worst.2);
    }
}

#[test]
fn right_is_left_transposed() {
    for w in rotation_vectors::<f64>() {
        assert!(matrix_error(&right_jacobian(&w), &left_jacobian(&w).transpose()) <= 1.0);
        let (right, left) = (right_jacobian_inverse(&w), left_jacobian_inverse(&w));
        assert!(matrix_error(&right, &left.transpose()) <= 1.0);
    }
}

fn pairs<T: Scalar>() {
    for w in rotation_vectors::<T>() {
        let rot = exp(&w);
        assert_eq!(exp_with_jacobian(&w), (rot, left_jacobian(&w)));
        let (vector, inverse) = log_with_jacobian_inverse(&rot);
        assert_eq!(vector, log(&rot));
        let error = matrix_error(&inverse, &left_jacobian_inverse(&vector));
        assert!(error <= 4.0, "{error} ε at {w}");
    }
}

#[test]
fn pairs_are_their_parts() {
    pairs::<f64>();
    pairs::<f32>();
}

/// Step of the central differences: truncation h² and rounding ε/h are both near 1e-10.
const H: f64 = 1e-5;
const BOUND: f64 = 1e-9;

proptest! {
    #[test]
    fn jacobians_are_derivatives_of_exp(w in rotation_vector(), column in 0..3_usize) {
        let mut step = Vector3::zeros();
        step[column] = H;
        let (after, before) = (exp(&(w + step)), exp(&(w - step)));
        let right = log(&(before.transpose() * after)) / (2.0 * H);
        let left = log(&(after * before.transpose())) / (2.0 * H);
        prop_assert!((right - right_jacobian(&w).column(column)).norm() < BOUND);
        prop_assert!((left - left_jacobian(&w).column(column)).norm() < BOUND);
    }

    #[test]
    fn inverse_jacobians_are_derivatives_of_log(w in rotation_vector(), column in 0..3_usize) {
        // log itself jumps at π.
        prop_assume!(w.norm() < 3.1);
        let mut step = Vector3::zeros();
        step[column] = H;
        let rot = exp(&w);
        let right = (log(&(rot * exp(&step))) - log(&(rot * exp(&-step)))) / (2.0 * H);
        let left = (log(&(exp(&step) * rot)) - log(&(exp(&-step) * rot))) / (2.0 * H);
        prop_assert!((right - right_jacobian_inverse(&w).column(column)).norm() < BOUND);
        prop_assert!((left - left_jacobian_inverse(&w).column(column)).norm() < BOUND);
    }

    /// J_l = R J_r: both say how fast the same body turns.
    #[test]
    fn left_is_rotated_right(w in rotation_vector()) {
        let product = exp(&w).matrix() * right_jacobian(&w);
        prop_assert!(matrix_error(&product, &left_jacobian(&w)) < 16.0);
    }
}
