//! The degree-4 Taylor exponential: the series itself, its derivatives and both error statements.
#![allow(clippy::disallowed_methods, reason = "std is the reference here")]

use crate::cases::{axes, axis, matrix_error};
use proptest::prelude::*;
use so3::{
    Matrix3, Vector3, exp, exp_taylor4, exp_taylor4_defect, exp_taylor4_derivatives,
    exp_taylor4_error_bound, hat,
};

/// Largest singular value, from the largest eigenvalue of MᵀM.
fn spectral_norm(m: &Matrix3<f64>) -> f64 {
    m.tr_mul(m).symmetric_eigenvalues().max().max(0.0).sqrt()
}

proptest! {
    #[test]
    fn taylor_is_the_series(axis in axis(), angle in 0.0..4.0_f64) {
        let w = axis * angle;
        let a = hat(&w);
        let series = Matrix3::identity() + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
        prop_assert!(matrix_error(&exp_taylor4(&w), &series) < 64.0);
        let single = exp_taylor4(&w.map(|c| c as f32)).map(f64::from);
        prop_assert!((single - series).norm() < 2e-5);
    }

    #[test]
    fn taylor_derivatives(axis in axis(), angle in 0.0..4.0_f64, i in 0..3_usize) {
        let w = axis * angle;
        let mut step = Vector3::zeros();
        step[i] = 1e-5;
        let difference = (exp_taylor4(&(w + step)) - exp_taylor4(&(w - step))) / 2e-5;
        prop_assert!((difference - exp_taylor4_derivatives(&w)[i]).norm() < 1e-8);
    }
}

#[test]
fn taylor_error_bound() {
    for axis in axes() {
        for angle in [0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0] {
            let w = axis * angle;
            let error = spectral_norm(&(exp(&w).matrix() - exp_taylor4(&w)));
            let bound = exp_taylor4_error_bound(angle);
            // The norm itself is good to a few ε.
            assert!(
                error <= bound + 2e-15,
                "{error:e} above {bound:e} at {angle}"
            );
            if angle <= 0.5 {
                assert!(
                    error >= 0.99 * bound - 2e-15,
                    "{error:e} far below {bound:e} at {angle}"
                );
            }
        }
    }
    assert!(exp_taylor4_error_bound(-0.1) > 0.0);
}

#[test]
fn taylor_defect() {
    for axis in axes() {
        for angle in [0.05, 0.1, 0.3, 1.0, 2.0, 8.0_f64.sqrt(), 3.0, 3.5] {
            let e = exp_taylor4(&(axis * angle));
            let defect = spectral_norm(&(e.tr_mul(&e) - Matrix3::identity()));
            let stated = exp_taylor4_defect(angle);
            assert!(
                (defect - stated).abs() <= 1e-14 * (1.0 + stated),
                "{defect:e} {stated:e}"
            );
        }
    }
    // The figures of the module's documentation.
    assert!((exp_taylor4_defect(0.1) - 1.387e-8_f64).abs() < 1e-11);
    assert!((exp_taylor4_defect(0.3) - 1.0e-5_f64).abs() < 2e-7);
}
