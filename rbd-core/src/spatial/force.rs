//! Spatial force vectors: wrenches and momenta.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::Vector3;
use so3::Scalar;

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
