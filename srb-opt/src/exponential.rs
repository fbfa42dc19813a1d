//! The step of a rotation over an interval, paper A eq. (1c) and (3).

use crate::rotation::{exp, exp4_jacobian};
use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

/// Which exponential turns the body over an interval: `R⁺ = R E(ω dt)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exponential {
    /// Taylor's polynomial of degree 4, paper A eq. (3) and Remark 1: no root, sine or branch, and not quite orthogonal.
    Taylor4,
    /// The exact exponential.
    Exact,
}

impl Exponential {
    /// `E(w)`.
    #[inline(always)]
    pub(crate) fn step<T: Scalar>(self, w: &Vector3<T>) -> Matrix3<T> {
        match self {
            Self::Taylor4 => so3::exp_taylor4(w),
            Self::Exact => exp(w),
        }
    }

    /// Right Jacobian: `E(w + δ) ≈ E(w) Exp(J δ)`.
    #[inline(always)]
    pub(crate) fn jacobian<T: Scalar>(self, w: &Vector3<T>) -> Matrix3<T> {
        match self {
            Self::Taylor4 => exp4_jacobian(w),
            Self::Exact => so3::right_jacobian(w),
        }
    }
}
