//! The rotation error of paper A's problem (2) and its smooth variant.

use crate::{Rotation3, Scalar, Vector3, log, math, vee};

/// What [`rotation_error_smoothed`] adds to s·s = sin² θ under its root.
pub const ERROR_SMOOTHING: f64 = 1e-6;

/// Rotation error e = log(R_refᵀ R)^∨, in rad, |e| ≤ π: the turn from `rot_ref` to `rot`.
///
/// Zero where they agree; to first order, e changes by `right_jacobian_inverse(e)` δ when R becomes R exp(δ).
///
/// # Frames
/// For `rot_ref` = R_wr and `rot` = R_wb, e is expressed in the reference frame r, and equally in b.
///
/// # Accuracy
/// That of [`log`]; jumps from π to −π at half a turn (test `rotation_error_is_the_turn`).
///
/// # References
/// Paper A, problem (2) and the sentence below eq. (2d).
#[inline]
#[must_use]
pub fn rotation_error<T: Scalar>(rot_ref: &Rotation3<T>, rot: &Rotation3<T>) -> Vector3<T> {
    log(&(rot_ref.transpose() * rot))
}

/// Rotation error that an optimiser can differentiate everywhere but at half a turn, in rad.
///
/// With E = R_refᵀ R, s = vee(E) (the vector of its skew part), c = (tr E − 1)/2, r = √(s·s + 1e-6):
/// e = s atan2(r, c)/r. No branch, no division by zero.
///
/// Its length differs from the angle θ by the fraction 1e-6/3 near zero, below 7e-7/sin² θ from there on; within about
/// 1e-3 rad of half a turn e, like s, goes to zero (tests `smoothed_error_near_zero_and_pi`,
/// `smoothed_error_is_the_formula`).
///
/// # Frames
/// As [`rotation_error`].
///
/// # References
/// Reference problems of the A1 jumps; [`ERROR_SMOOTHING`] is their 1e-6.
#[inline]
#[must_use]
pub fn rotation_error_smoothed<T: Scalar>(
    rot_ref: &Rotation3<T>,
    rot: &Rotation3<T>,
) -> Vector3<T> {
    let e = rot_ref.matrix().tr_mul(rot.matrix());
    let s = vee(&e);
    let c = (e.m11 + e.m22 + e.m33 - T::ONE) * T::HALF;
    let r = math::sqrt(s.norm_squared() + T::of(ERROR_SMOOTHING));
    s * (math::atan2(r, c) / r)
}
