//! The degree-4 Taylor exponential of paper A, eq. (3), and what it costs.
//!
//! # Derivation
//! E₄(A) = I + A + A²/2 + A³/6 + A⁴/24 with A = hat(w), θ = |w|. A³ = −θ² A folds it into
//! E₄ = I + (1 − θ²/6) A + (½ − θ²/24) A²: a polynomial in w without root, sine or branch, which is why an
//! optimiser likes it. A is a normal matrix with the eigenvalues 0, ±iθ, so every error is one of a number:
//!
//! - ‖exp(A) − E₄(A)‖₂ = |e^{iθ} − Σ_{k≤4} (iθ)ᵏ/k!| ≤ θ⁵/120, the remainder of Taylor's theorem, and ≈ θ⁵/120
//!   for small θ;
//! - the singular values of E₄ are 1 and twice |p|, |p|² = (1 − θ²/2 + θ⁴/24)² + (θ − θ³/6)² = 1 − θ⁶/72 + θ⁸/576, so
//!   ‖E₄ᵀE₄ − I‖₂ = (θ⁶/72) |1 − θ²/8| exactly. Paper A's "SO(3) at a reasonable accuracy" is this number: a step of
//!   0.1 rad loses 1.4e-8, one of 0.3 rad 1e-5, and lengths shrink as long as θ < √8.

use crate::{Matrix3, Scalar, Vector3, hat, math};

/// Degree-4 Taylor polynomial of exp(hat(w)), 3×3: I + A + A²/2 + A³/6 + A⁴/24, paper A eq. (3).
///
/// Not a rotation, only near one: see [`exp_taylor4_error_bound`] and [`exp_taylor4_defect`]. `w` in rad.
///
/// Test: `taylor_is_the_series`.
#[inline]
#[must_use]
pub fn exp_taylor4<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    let theta_squared = w.norm_squared();
    let p = T::ONE - theta_squared * T::of(1.0 / 6.0);
    let q = T::HALF - theta_squared * T::of(1.0 / 24.0);
    hat::combination(w, T::ONE - q * theta_squared, p, q)
}

/// Partial derivatives ∂E₄/∂wᵢ of [`exp_taylor4`], three 3×3 matrices.
///
/// With E₄ = I + p A + q A²: ∂E₄/∂wᵢ = p Hᵢ + q (Hᵢ A + A Hᵢ) − (wᵢ/3) A − (wᵢ/12) A², Hᵢ = hat(eᵢ).
///
/// Test: `taylor_derivatives`.
#[must_use]
pub fn exp_taylor4_derivatives<T: Scalar>(w: &Vector3<T>) -> [Matrix3<T>; 3] {
    let theta_squared = w.norm_squared();
    let p = T::ONE - theta_squared * T::of(1.0 / 6.0);
    let q = T::HALF - theta_squared * T::of(1.0 / 24.0);
    let a = hat(w);
    let a_squared = a * a;
    let derivative = |unit: Vector3<T>, w_i: T| {
        let h = hat(&unit);
        h * p + (h * a + a * h) * q
            - a * (w_i * T::of(1.0 / 3.0))
            - a_squared * (w_i * T::of(1.0 / 12.0))
    };
    [
        derivative(Vector3::x(), w.x),
        derivative(Vector3::y(), w.y),
        derivative(Vector3::z(), w.z),
    ]
}

/// Bound of ‖exp(A) − E₄(A)‖₂, the largest error of any rotated unit vector: θ⁵/120, `angle` = θ = |w| in rad.
///
/// Sharp for small angles: the true error is at least 0.99 of it up to 0.5 rad (test `taylor_error_bound`).
#[inline]
#[must_use]
pub fn exp_taylor4_error_bound<T: Scalar>(angle: T) -> T {
    math::powi(math::abs(angle), 5) * T::of(1.0 / 120.0)
}

/// ‖E₄ᵀE₄ − I‖₂, how far from orthonormal the result is: (θ⁶/72) |1 − θ²/8|, `angle` = θ = |w| in rad. Exact.
///
/// Test: `taylor_defect`.
#[inline]
#[must_use]
pub fn exp_taylor4_defect<T: Scalar>(angle: T) -> T {
    let z = angle * angle;
    math::powi(z, 3) * T::of(1.0 / 72.0) * math::abs(T::ONE - z * T::of(0.125))
}
