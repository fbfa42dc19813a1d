//! Left and right Jacobians of the exponential map, and their inverses.
//!
//! # Derivation
//! J_l(w) = ∫₀¹ exp(s A) ds with A = hat(w); integrating Rodrigues' formula gives I + b A + c A², b = (1 − cos θ)/θ²,
//! c = (θ − sin θ)/θ³. The right Jacobian is J_r(w) = J_l(−w) = J_l(w)ᵀ. They answer how exp moves when w moves by δ:
//!
//! exp(w + δ) ≈ exp(J_l(w) δ) exp(w) ≈ exp(w) exp(J_r(w) δ),
//!
//! so with R = exp(w) and ẇ the body's angular velocity in the body frame is J_r(w) ẇ, in the world J_l(w) ẇ.
//! The inverse I − ½A + d A², d = (1 − (θ/2) cot(θ/2))/θ², answers how log moves:
//! log(R exp(δ)) ≈ w + J_r⁻¹(w) δ. It is singular at θ = 2π, a whole turn.
//!
//! References: Chirikjian 2012, Stochastic Models, Information Theory, and Lie Groups, vol. 2; Solà et al. 2018,
//! A micro Lie theory, eq. (143) to (146).

use crate::{Matrix3, Scalar, Vector3, hat, small_angle};

/// I + p A + q A², A = hat(w).
#[inline(always)]
pub(crate) fn polynomial<T: Scalar>(w: &Vector3<T>, p: T, q: T) -> Matrix3<T> {
    // A² = w wᵀ − θ² I
    hat::combination(w, T::ONE - q * w.norm_squared(), p, q)
}

/// Left Jacobian of the exponential map, 3×3: I + b A + c A²; exp(w + δ) ≈ exp(J δ) exp(w).
///
/// # Accuracy
/// Elements within 2 ε for |w| ≤ π (test `jacobian_against_double_double`); derivative: `jacobians_are_derivatives_of_exp`.
#[inline]
#[must_use]
pub fn left_jacobian<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    let small_angle::Coefficients { b, c, .. } = small_angle::coefficients(w.norm_squared());
    polynomial(w, b, c)
}

/// Right Jacobian of the exponential map, 3×3: I − b A + c A²; exp(w + δ) ≈ exp(w) exp(J δ).
///
/// # Accuracy
/// That of [`left_jacobian`], whose transpose it is to rounding (test `right_is_left_transposed`).
#[inline]
#[must_use]
pub fn right_jacobian<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    left_jacobian(&-w)
}

/// Inverse of the left Jacobian, 3×3: I − ½A + d A²; log(exp(δ) R) ≈ log R + J⁻¹ δ.
///
/// # Accuracy
/// Elements within 4 ε, J J⁻¹ = I within 8 ε for |w| ≤ π (tests `jacobian_against_double_double`,
/// `inverse_jacobians`); derivative: `inverse_jacobians_are_derivatives_of_log`. Grows without bound towards |w| = 2π.
#[inline]
#[must_use]
pub fn left_jacobian_inverse<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    polynomial(
        w,
        -T::HALF,
        small_angle::inverse_coefficient(w.norm_squared()),
    )
}

/// Inverse of the right Jacobian, 3×3: I + ½A + d A²; log(R exp(δ)) ≈ log R + J⁻¹ δ.
///
/// # Accuracy
/// That of [`left_jacobian_inverse`], whose transpose it is to rounding.
#[inline]
#[must_use]
pub fn right_jacobian_inverse<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    left_jacobian_inverse(&-w)
}
