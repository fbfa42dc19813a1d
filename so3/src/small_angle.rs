//! Coefficients of exp, log and their Jacobians as functions of the squared angle, accurate down to zero.
//!
//! # Derivation
//! Every map of this crate is a polynomial in A = hat(w) whose coefficients are even functions of θ = |w|, so
//! they are functions of z = θ² and smooth at 0. Their closed forms divide a difference of nearly equal numbers
//! by a power of θ. Below [`SERIES_LIMIT`] on z (θ = 1 rad) the power series in z is taken instead: there it
//! needs neither square root, sine nor division, and
//!
//! - truncation: nine terms of the alternating exponential series leave less than the first omitted term,
//!   1/19! < 2⁻⁵⁶; ten terms of the cotangent series, whose coefficients fall by 4π² each, less than 2⁻⁵⁴ of the
//!   first;
//! - rounding: the first term dominates, so Horner's scheme loses at most about one unit in the last place.
//!
//! Above it the closed forms lose what cancels. For c = (1 − a)/z at z ≥ 1 that is at most a factor
//! a/(1 − a) ≤ 5.4, and what reaches a Jacobian is c θ², where it is one rounding error again. All angles come
//! from the half angle h = θ/2: 1 − cos θ = 2 sin² h does not cancel at all.
//!
//! Test: `tests/small_angle.rs` compares all coefficients with long series in double-double arithmetic
//! up to θ = π in f64 and f32: a within 2 ε, b 4 ε, c 8 ε, d 16 ε.

use crate::{Scalar, math};

/// Squared angle, in rad², below which the series are used.
pub const SERIES_LIMIT: f64 = 1.0;

/// The coefficients of exp and of the Jacobians at a squared angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<T> {
    /// sin θ / θ.
    pub a: T,
    /// (1 − cos θ) / θ².
    pub b: T,
    /// (θ − sin θ) / θ³.
    pub c: T,
}

/// a = sin θ / θ, b = (1 − cos θ)/θ², c = (θ − sin θ)/θ³ at `theta_squared` = θ² ≥ 0, in rad².
///
/// # Accuracy
/// Up to θ = π: `a` within 2 ε, `b` relative 4 ε, `c` relative 8 ε (test `coefficients_against_double_double`).
#[inline]
#[must_use]
pub fn coefficients<T: Scalar>(theta_squared: T) -> Coefficients<T> {
    let z = theta_squared;
    let (a, b) = sine_and_versine(z);
    let c = if z < T::of(SERIES_LIMIT) {
        series(z, &SINE_REMAINDER)
    } else {
        (T::ONE - a) * (T::ONE / z)
    };
    Coefficients { a, b, c }
}

/// a and b alone, all that exp needs.
#[inline(always)]
pub(crate) fn sine_and_versine<T: Scalar>(z: T) -> (T, T) {
    if z < T::of(SERIES_LIMIT) {
        return (series(z, &SINE), series(z, &VERSINE));
    }
    let theta = math::sqrt(z);
    let (sin_h, cos_h) = math::sin_cos(theta * T::HALF);
    // One division, which does not wait for the sine.
    let per_z = T::ONE / z;
    let twice = T::TWO * sin_h;
    (twice * cos_h * (theta * per_z), twice * sin_h * per_z)
}

/// d = (1 − (θ/2) cot(θ/2)) / θ² at `theta_squared` = θ² ≥ 0, in rad²: the inverse Jacobians' coefficient.
///
/// Grows from 1/12 at 0 over 1/π² at π without bound towards θ = 2π, where the Jacobians are singular.
///
/// # Accuracy
/// Relative 16 ε up to θ = π (test `inverse_coefficient_against_double_double`).
#[inline]
#[must_use]
pub fn inverse_coefficient<T: Scalar>(theta_squared: T) -> T {
    let z = theta_squared;
    if z < T::of(SERIES_LIMIT) {
        return series(z, &COTANGENT);
    }
    let h = math::sqrt(z) * T::HALF;
    let (sin_h, cos_h) = math::sin_cos(h);
    (T::ONE - h * cos_h / sin_h) / z
}

/// c₀ + c₁ z + c₂ z² + … by Horner's scheme.
#[inline(always)]
fn series<T: Scalar, const N: usize>(z: T, coefficients: &[f64; N]) -> T {
    coefficients
        .iter()
        .rev()
        .fold(T::ZERO, |sum, &c| math::mul_add(sum, z, T::of(c)))
}

/// (−1)ᵏ/(2k+1)!
const SINE: [f64; 9] = [
    1.0,
    -0.16666666666666666,
    0.008333333333333333,
    -0.0001984126984126984,
    2.7557319223985893e-06,
    -2.505210838544172e-08,
    1.6059043836821613e-10,
    -7.647163731819816e-13,
    2.8114572543455206e-15,
];

/// (−1)ᵏ/(2k+2)!
const VERSINE: [f64; 9] = [
    0.5,
    -0.041666666666666664,
    0.001388888888888889,
    -2.48015873015873e-05,
    2.755731922398589e-07,
    -2.08767569878681e-09,
    1.1470745597729725e-11,
    -4.779477332387385e-14,
    1.5619206968586225e-16,
];

/// (−1)ᵏ/(2k+3)!
const SINE_REMAINDER: [f64; 9] = [
    0.16666666666666666,
    -0.008333333333333333,
    0.0001984126984126984,
    -2.7557319223985893e-06,
    2.505210838544172e-08,
    -1.6059043836821613e-10,
    7.647163731819816e-13,
    -2.8114572543455206e-15,
    8.22063524662433e-18,
];

/// 2 ζ(2k+2)/(2π)^(2k+2), from the partial fractions of the cotangent.
const COTANGENT: [f64; 10] = [
    0.08333333333333333,
    0.001388888888888889,
    3.306878306878307e-05,
    8.267195767195768e-07,
    2.08767569878681e-08,
    5.284190138687493e-10,
    1.3382536530684679e-11,
    3.3896802963225827e-13,
    8.586062056277845e-15,
    2.174868698558062e-16,
];
