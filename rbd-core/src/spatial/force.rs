//! Spatial force vectors: wrenches and momenta.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::Vector3;
use so3::Scalar;
use so3::math::mul_add;

use super::six::six_vector;

/// A wrench or a momentum, expressed in one frame and about its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force<T> {
    /// Force, N, or linear momentum, kg m/s.
    pub linear: Vector3<T>,
    /// Moment about the frame's origin, N m, or angular momentum, kg m²/s.
    pub angular: Vector3<T>,
}

six_vector!(Force);

impl<T: Scalar> Force<T> {
    /// self + other · factor.
    #[inline(always)]
    #[must_use]
    pub(crate) fn plus(&self, other: &Self, factor: T) -> Self {
        let sum = |a: &Vector3<T>, b: &Vector3<T>| {
            let term = |a: T, b: T| mul_add(b, factor, a);
            Vector3::new(term(a.x, b.x), term(a.y, b.y), term(a.z, b.z))
        };
        Self {
            linear: sum(&self.linear, &other.linear),
            angular: sum(&self.angular, &other.angular),
        }
    }
}
