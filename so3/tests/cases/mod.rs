//! Axes and angles where rotations go wrong, and random ones.
#![allow(
    clippy::disallowed_methods,
    reason = "tests: only inputs are made here"
)]

use core::f64::consts::PI;

use proptest::prelude::*;
use so3::{Matrix3, Scalar, Vector3};

/// 0, near 0, both sides of the series limit, near π and π.
pub(crate) const ANGLES: [f64; 28] = [
    0.0,
    1e-300,
    1e-160,
    1e-30,
    1e-20,
    1e-12,
    1e-10,
    1e-9,
    1e-8,
    1e-7,
    1e-6,
    1e-5,
    1e-4,
    1e-3,
    1e-2,
    0.1,
    0.5,
    0.999_999_9,
    1.000_000_1,
    2.0,
    3.0,
    PI - 1e-3,
    PI - 1e-6,
    PI - 1e-8,
    PI - 1e-9,
    PI - 1e-10,
    PI - 1e-12,
    PI,
];

/// Unit axes: ± coordinate axes, face and space diagonals with all signs, nearly degenerate ones.
pub(crate) fn axes() -> Vec<Vector3<f64>> {
    let mut axes = Vec::new();
    for x in [-1.0, 0.0, 1.0] {
        for y in [-1.0, 0.0, 1.0] {
            for z in [-1.0, 0.0, 1.0] {
                axes.push(Vector3::new(x, y, z));
            }
        }
    }
    axes.extend([
        Vector3::new(1.0, 1e-8, -1e-9),
        Vector3::new(-1e-9, 1.0, 1e-5),
        Vector3::new(1e-3, -1e-8, -1.0),
        Vector3::new(1.0, 1.0 + 1e-9, 1.0 - 1e-9),
        Vector3::new(0.3, -0.8, 0.5),
    ]);
    axes.into_iter()
        .filter(|a| a.norm() > 0.0)
        .map(|a| a.normalize())
        .collect()
}

/// Every axis with every angle, rounded to the scalar.
pub(crate) fn rotation_vectors<T: Scalar>() -> Vec<Vector3<T>> {
    axes()
        .iter()
        .flat_map(|axis| ANGLES.map(|angle| (axis * angle).map(T::of)))
        .collect()
}

/// Random unit vector.
pub(crate) fn axis() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64)
        .prop_map(Vector3::from)
        .prop_filter("direction", |v| v.norm() > 0.1)
        .prop_map(|v| v.normalize())
}

/// Random angle in [0, π], often near its ends.
pub(crate) fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => 0.0..PI,
        1 => (-16.0..0.0_f64).prop_map(|e| 10.0_f64.powf(e)),
        1 => (-16.0..0.0_f64).prop_map(|e| PI - 10.0_f64.powf(e)),
    ]
}

/// Random rotation vector, |w| ≤ π.
pub(crate) fn rotation_vector() -> impl Strategy<Value = Vector3<f64>> {
    (axis(), angle()).prop_map(|(axis, angle)| axis * angle)
}

pub(crate) fn to_f64<T: Scalar>(v: &Vector3<T>) -> Vector3<f64> {
    v.map(T::to_f64)
}

/// Largest difference of two matrices, element by element, in units of ε of the scalar.
pub(crate) fn distance<T: Scalar>(a: &Matrix3<T>, b: &[[f64; 3]; 3]) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, row) in b.iter().enumerate() {
        for (j, exact) in row.iter().enumerate() {
            let difference = (a[(i, j)].to_f64() - exact).abs();
            assert!(!difference.is_nan(), "NaN in {a}");
            worst = worst.max(difference);
        }
    }
    worst / T::EPSILON.to_f64()
}

/// Largest element of a difference in units of ε.
pub(crate) fn matrix_error<T: Scalar>(a: &Matrix3<T>, b: &Matrix3<T>) -> f64 {
    let b = b.map(T::to_f64);
    distance(
        a,
        &core::array::from_fn(|i| core::array::from_fn(|j| b[(i, j)])),
    )
}
