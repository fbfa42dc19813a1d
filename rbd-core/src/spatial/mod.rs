//! Spatial algebra: motions, forces, inertias and transforms as distinct types.
//!
//! All 6-vectors are linear first. A [`Motion`] and a [`Force`] do not add to each other, and each
//! changes frame by its own rule, so mixing them up does not compile:
//!
//! ```compile_fail
//! use rbd_core::spatial::{Force, Motion};
//! let _ = Motion::<f64>::ZERO + Force::<f64>::ZERO;
//! ```

mod articulated;
mod force;
mod inertia;
mod motion;
mod six;
mod symmetric;
mod transform;

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::mul_add;

pub use articulated::ArticulatedInertia;
pub use force::Force;
pub use inertia::Inertia;
pub use motion::Motion;
pub use symmetric::Symmetric3;
pub use transform::Transform;

/// a × b.
#[inline(always)]
pub(crate) fn cross<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        mul_add(a.y, b.z, -(a.z * b.y)),
        mul_add(a.z, b.x, -(a.x * b.z)),
        mul_add(a.x, b.y, -(a.y * b.x)),
    )
}

/// v + a × b.
#[inline(always)]
pub(crate) fn add_cross<T: Scalar>(v: &Vector3<T>, a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        mul_add(-a.z, b.y, mul_add(a.y, b.z, v.x)),
        mul_add(-a.x, b.z, mul_add(a.z, b.x, v.y)),
        mul_add(-a.y, b.x, mul_add(a.x, b.y, v.z)),
    )
}

/// v + M x.
#[inline(always)]
pub(crate) fn add_product<T: Scalar>(v: &Vector3<T>, m: &Matrix3<T>, x: &Vector3<T>) -> Vector3<T> {
    let row = |start: T, a: T, b: T, c: T| mul_add(c, x.z, mul_add(b, x.y, mul_add(a, x.x, start)));
    Vector3::new(
        row(v.x, m.m11, m.m12, m.m13),
        row(v.y, m.m21, m.m22, m.m23),
        row(v.z, m.m31, m.m32, m.m33),
    )
}

/// M v.
#[inline(always)]
pub(crate) fn product<T: Scalar>(m: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let row = |a: T, b: T, c: T| mul_add(c, v.z, mul_add(b, v.y, a * v.x));
    Vector3::new(
        row(m.m11, m.m12, m.m13),
        row(m.m21, m.m22, m.m23),
        row(m.m31, m.m32, m.m33),
    )
}

/// A B, column by column.
#[inline(always)]
pub(crate) fn matrix_product<T: Scalar>(a: &Matrix3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    let column = |x, y, z| product(a, &Vector3::new(x, y, z));
    Matrix3::from_columns(&[
        column(b.m11, b.m21, b.m31),
        column(b.m12, b.m22, b.m32),
        column(b.m13, b.m23, b.m33),
    ])
}
