//! Back to SO(3): one step, and the nearest rotation.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests")]

use crate::cases::{matrix_error, rotation_vector};
use proptest::prelude::*;
use so3::{
    Error, Matrix3, Rotation3, Scalar, exp, exp_taylor4, log, nearest_rotation,
    orthogonality_defect, orthonormalize_step,
};

fn matrix(size: f64) -> impl Strategy<Value = Matrix3<f64>> {
    prop::array::uniform9(-size..size).prop_map(|m| Matrix3::from_row_slice(&m))
}

/// RᵀM symmetric and positive definite, R orthonormal with determinant 1: what makes R the nearest rotation.
fn assert_nearest<T: Scalar>(m: &Matrix3<T>) {
    let eps = T::EPSILON.to_f64();
    let rot = nearest_rotation(m).unwrap();
    assert!(orthogonality_defect(rot.matrix()).to_f64() <= 8.0 * eps);
    assert!(rot.matrix().determinant() > T::HALF);
    let (m, rot) = (m.map(T::to_f64), rot.matrix().map(T::to_f64));
    let stretch = rot.tr_mul(&m);
    let skew = (stretch - stretch.transpose()).norm() / m.norm() / eps;
    assert!(skew <= 32.0, "RᵀM is not symmetric: {skew} ε");
    let symmetric = (stretch + stretch.transpose()) * 0.5;
    assert!(symmetric.symmetric_eigenvalues().min() > 0.0);
}

proptest! {
    #[test]
    fn one_step_squares_the_defect(w in rotation_vector(), noise in matrix(0.1), size in -8.0..0.0_f64) {
        let m = exp(&w).matrix() + noise * 10.0_f64.powf(size);
        let before = orthogonality_defect(&m);
        let after = *orthonormalize_step(&Rotation3::from_matrix_unchecked(m)).matrix();
        // In the spectral norm; the Frobenius norm lies between it and √3 of it.
        let norm = |m: &Matrix3<f64>| {
            (m.tr_mul(m) - Matrix3::identity()).symmetric_eigenvalues().amax()
        };
        let d = norm(&m);
        prop_assert!(norm(&after) <= 0.75 * d * d + 0.25 * d * d * d + 8.0 * f64::EPSILON);
        prop_assert!(d <= before * (1.0 + 1e-12) + 1e-15);
    }

    #[test]
    fn nearest_rotation_of_noisy_rotations(w in rotation_vector(), noise in matrix(0.2)) {
        let m = exp(&w).matrix() + noise;
        assert_nearest(&m);
        assert_nearest(&m.map(|x| x as f32));
        assert_nearest(&(m * 1e-140));
        assert_nearest(&(m * 1e140));
    }

    #[test]
    fn nearest_rotation_of_any_matrix(m in matrix(1.0)) {
        match nearest_rotation(&m) {
            Ok(_) => assert_nearest(&m),
            Err(error) => {
                prop_assert_eq!(error, Error::NotNearRotation);
                prop_assert!(m.determinant() < 1e-13);
            }
        }
    }

    #[test]
    fn nearest_rotation_is_idempotent(w in rotation_vector()) {
        let rot = exp(&w);
        prop_assert!(matrix_error(nearest_rotation(rot.matrix()).unwrap().matrix(), rot.matrix()) < 4.0);
    }
}

#[test]
fn no_rotation_is_near_these() {
    let mirror = Matrix3::from_diagonal(&so3::Vector3::new(1.0, 1.0, -1.0));
    let flat = Matrix3::new(1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0);
    for m in [mirror, flat, Matrix3::zeros(), -Matrix3::identity()] {
        assert_eq!(nearest_rotation(&m), Err(Error::NotNearRotation));
    }
    for bad in [f32::NAN, f32::INFINITY] {
        let error = nearest_rotation(&Matrix3::repeat(bad)).unwrap_err();
        assert_eq!(
            error,
            Error::NotFinite {
                parameter: "matrix"
            }
        );
    }
}

/// What drift is: thousands of Taylor steps as in paper A, with and without the cheap step.
#[test]
fn drift_of_taylor_steps() {
    let w = so3::Vector3::new(0.03, -0.1, 0.05);
    let (mut drifting, mut kept) = (Rotation3::<f64>::identity(), Rotation3::identity());
    for _ in 0..1000 {
        drifting = Rotation3::from_matrix_unchecked(drifting.matrix() * exp_taylor4(&w));
        kept = Rotation3::from_matrix_unchecked(kept.matrix() * exp_taylor4(&w));
        kept = orthonormalize_step(&kept);
    }
    assert!(orthogonality_defect(drifting.matrix()) > 1e-6);
    assert!(orthogonality_defect(kept.matrix()) < 1e-15);
    let nearest = nearest_rotation(drifting.matrix()).unwrap();
    assert!(log(&(nearest.transpose() * kept)).norm() < 1e-12);
}
