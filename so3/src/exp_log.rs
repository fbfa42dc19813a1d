//! The exponential map ℝ³ → SO(3), its inverse, and rotations about an axis.
//!
//! # Derivation
//! With A = hat(w), θ = |w|: A³ = −θ² A, so the exponential series folds into Rodrigues' formula
//! exp(A) = I + a A + b A², a = sin θ/θ, b = (1 − cos θ)/θ². Since A² = w wᵀ − θ² I, it is cos θ I + a A + b w wᵀ.
//!
//! The logarithm goes through the quaternion (v, s) = (axis sin(θ/2), cos(θ/2)) read off the largest of its four
//! squared components (Shepperd 1978): w = 2 atan2(|v|, s)/|v| v. This is one formula for all angles. At 0 it
//! reads v from differences of the off-diagonal elements, which keeps its relative accuracy; at π it reads v
//! from sums, where the classical formula θ/(2 sin θ)(R − Rᵀ) divides zero by zero. Neither
//! the length of the quaternion nor the exact orthogonality of R matters: atan2 sees only a ratio.

use crate::{Matrix3, Rotation3, Scalar, Unit, Vector3, hat, jacobian, math, quat, small_angle};

/// Rotation by the angle |w| about the axis w/|w|: exp(hat(w)) = I + a A + b A², A = hat(w).
///
/// `w` in rad, any number of turns, |w| below 10¹⁸ (f32) or 10¹⁵⁰ (f64), beyond which |w|² overflows and the
/// result is NaN, as it is for NaN.
///
/// # Frames
/// With w expressed in a (or in b: w is the axis, so both are the same), `rot_ab = exp(w)` maps b to a.
///
/// # Accuracy
/// Each element within ε (1 + |w|), the orthogonality defect within 8 ε (tests `exp_against_double_double`,
/// `exp_is_orthonormal`).
///
/// # References
/// Paper A, eq. (1c) and (2c); Rodrigues 1840.
#[inline]
#[must_use]
pub fn exp<T: Scalar>(w: &Vector3<T>) -> Rotation3<T> {
    let theta_squared = w.norm_squared();
    let (a, b) = small_angle::sine_and_versine(theta_squared);
    exponential(w, theta_squared, a, b)
}

/// exp(w) and its left Jacobian at once, for the price of little more than one: what the exponential of a rigid
/// motion needs.
///
/// Each equals [`exp`] and [`left_jacobian`](crate::left_jacobian) bit for bit (test `pairs_are_their_parts`).
#[inline]
#[must_use]
pub fn exp_with_jacobian<T: Scalar>(w: &Vector3<T>) -> (Rotation3<T>, Matrix3<T>) {
    let theta_squared = w.norm_squared();
    let small_angle::Coefficients { a, b, c } = small_angle::coefficients(theta_squared);
    (
        exponential(w, theta_squared, a, b),
        jacobian::polynomial(w, b, c),
    )
}

/// cos θ I + a A + b w wᵀ.
#[inline(always)]
fn exponential<T: Scalar>(w: &Vector3<T>, theta_squared: T, a: T, b: T) -> Rotation3<T> {
    let cos = T::ONE - b * theta_squared;
    Rotation3::from_matrix_unchecked(hat::combination(w, cos, a, b))
}

/// Rotation vector w with exp(w) = `rot` and |w| ≤ π: 2 atan2(|v|, s)/|v| v of the quaternion (v, s), in rad.
///
/// At exactly π, where w and −w are the same rotation, the component of w with the largest magnitude is
/// positive. `rot` may be slightly not a rotation, such as a product of Taylor exponentials: the result then
/// moves by at most 4 times the Frobenius norm of the deviation (near π: up to the sign of w). NaN if an
/// element is NaN.
///
/// # Frames
/// w has the same components in both frames of `rot_ab`.
///
/// # Accuracy
/// |log(exp(w)) − w| ≤ 4 ε (1 + |w|) for |w| < π, and relative 4 ε towards 0 on the coordinate axes (tests `log_inverts_exp`,
/// `log_near_pi`, `log_of_near_rotations`).
///
/// # References
/// Shepperd 1978, Journal of Guidance and Control 1(3); paper A, problem (2).
#[inline]
#[must_use]
pub fn log<T: Scalar>(rot: &Rotation3<T>) -> Vector3<T> {
    let [x, y, z, s] = quat::unnormalized(rot.matrix());
    quat::rotation_vector(&Vector3::new(x, y, z), s)
}

/// log(rot) and the inverse left Jacobian there at once: what the logarithm of a rigid motion needs.
///
/// The half angle's cotangent is the quaternion's s/|v|, so that no sine is taken. The vector is that of [`log`]
/// bit for bit, the matrix within the accuracy of [`left_jacobian_inverse`](crate::left_jacobian_inverse)
/// (test `pairs_are_their_parts`).
#[inline]
#[must_use]
pub fn log_with_jacobian_inverse<T: Scalar>(rot: &Rotation3<T>) -> (Vector3<T>, Matrix3<T>) {
    let [x, y, z, s] = quat::unnormalized(rot.matrix());
    let (v, s) = quat::short_way(&Vector3::new(x, y, z), s);
    let scale = quat::angle_per_length(&v, s);
    let w = v * scale;
    let theta_squared = scale * scale * v.norm_squared();
    let d = if theta_squared < T::of(small_angle::SERIES_LIMIT) {
        small_angle::inverse_coefficient(theta_squared)
    } else {
        (T::ONE - T::HALF * scale * s) / theta_squared
    };
    (w, jacobian::polynomial(&w, -T::HALF, d))
}

/// Of all rotation vectors w with exp(w) = `rot`, the one nearest to `hint`: log with any number of turns.
///
/// They are (θ + 2πk) a for all integers k, a and θ the axis and angle of `log`; the result takes
/// k = round((hint·a − θ)/2π). Within 64 ε of the identity the axis is noise: there the axis is the hint's and
/// θ = 0, so `log_near(I, 4π x)` is 4π x. Feeding each result as the next hint unwraps a trajectory.
///
/// Test: `log_near_counts_turns`.
#[must_use]
pub fn log_near<T: Scalar>(rot: &Rotation3<T>, hint: &Vector3<T>) -> Vector3<T> {
    let turn = T::TWO * T::PI;
    let w = log(rot);
    let theta = math::sqrt(w.norm_squared());
    if theta > T::of(64.0) * T::EPSILON {
        let axis = w / theta;
        let turns = math::floor((hint.dot(&axis) - theta) / turn + T::HALF);
        return w + axis * (turns * turn);
    }
    let length = math::sqrt(hint.norm_squared());
    let turns = math::floor(length / turn + T::HALF);
    if turns > T::ZERO {
        hint * (turns * turn / length)
    } else {
        w
    }
}

/// Rotation by `angle`, in rad and of any size, about a unit axis: cos I + sin hat(a) + (1 − cos) a aᵀ.
///
/// Whole turns cost no accuracy beyond the rounding of the angle itself: an angle of 4π (720°) gives the
/// identity within 1e-15 in f64.
///
/// Test: `rotation_about_is_exp`.
#[inline]
#[must_use]
pub fn rotation_about<T: Scalar>(axis: &Unit<Vector3<T>>, angle: T) -> Rotation3<T> {
    let a = axis.as_ref();
    let (sin_h, cos_h) = math::sin_cos(angle * T::HALF);
    let (sin, versine) = (T::TWO * sin_h * cos_h, T::TWO * sin_h * sin_h);
    Rotation3::from_matrix_unchecked(hat::combination(a, T::ONE - versine, sin, versine))
}
