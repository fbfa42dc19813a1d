//! The only door to elementary functions: pinned `libm`, identical on host and target.

pub(crate) mod sin_cos;

use crate::Scalar;

macro_rules! door {
    ($($(#[$doc:meta])* $name:ident => $inner:ident;)*) => {
        $($(#[$doc])*
        #[inline(always)]
        #[must_use]
        pub fn $name<T: Scalar>(x: T) -> T {
            x.$inner()
        })*
    };
}

door! {
    /// Square root, correctly rounded; NaN below zero.
    sqrt => libm_sqrt;
    /// Tangent of an angle in rad.
    tan => libm_tan;
    /// Arc sine in rad, in [−π/2, π/2]; NaN outside [−1, 1].
    asin => libm_asin;
    /// Arc cosine in rad, in [0, π]; NaN outside [−1, 1].
    acos => libm_acos;
    /// Natural exponential.
    exp => libm_exp;
    /// Natural logarithm; NaN below zero.
    log => libm_log;
    /// Hyperbolic tangent.
    tanh => libm_tanh;
    /// Largest integer not above `x`.
    floor => libm_floor;
}

/// Sine and cosine of an angle in rad: (sin x, cos x); (NaN, NaN) for an infinite `x` or NaN.
///
/// Branch-free and without a table up to 3216 rad (f64) or 402 rad (f32), `libm` beyond; sin is exactly odd,
/// cos exactly even, and −0 keeps its sign. The derivation stands in `math/sin_cos.rs`.
///
/// # Accuracy
/// 1.6 units in the last place in f64 and 1.7 in f32, also next to multiples of π/2 (tests
/// `sin_cos_f64_on_a_grid`, `sin_cos_f64_next_to_multiples_of_a_quarter_turn`, `sin_cos_f32_sweep`).
#[inline(always)]
#[must_use]
pub fn sin_cos<T: Scalar>(x: T) -> (T, T) {
    if abs(x) <= T::SIN_COS_BOUND {
        x.sin_cos_within_bound()
    } else {
        x.libm_sin_cos()
    }
}

/// Sines and cosines of N angles in rad: ([sin xᵢ], [cos xᵢ]), bit for bit those of [`sin_cos`].
///
/// The loop has no branch and becomes vector code where the target has it; a second one repairs angles beyond
/// the bound of [`sin_cos`].
#[inline]
#[must_use]
pub fn sin_cos_array<T: Scalar, const N: usize>(x: &[T; N]) -> ([T; N], [T; N]) {
    let (mut sin, mut cos) = ([T::ZERO; N], [T::ZERO; N]);
    let mut within_bound = true;
    for ((s, c), &x) in sin.iter_mut().zip(cos.iter_mut()).zip(x) {
        (*s, *c) = x.sin_cos_within_bound();
        within_bound &= abs(x) <= T::SIN_COS_BOUND;
    }
    if !within_bound {
        for ((s, c), &x) in sin.iter_mut().zip(cos.iter_mut()).zip(x) {
            (*s, *c) = sin_cos(x);
        }
    }
    (sin, cos)
}

/// Sine of an angle in rad.
#[inline(always)]
#[must_use]
pub fn sin<T: Scalar>(x: T) -> T {
    sin_cos(x).0
}

/// Cosine of an angle in rad.
#[inline(always)]
#[must_use]
pub fn cos<T: Scalar>(x: T) -> T {
    sin_cos(x).1
}

/// Angle of the point (x, y) in rad, in [−π, π].
#[inline(always)]
#[must_use]
pub fn atan2<T: Scalar>(y: T, x: T) -> T {
    y.libm_atan2(x)
}

/// Magnitude of `x` with the sign of `sign`.
#[inline(always)]
#[must_use]
pub fn copysign<T: Scalar>(x: T, sign: T) -> T {
    x.libm_copysign(sign)
}

/// Absolute value.
#[inline(always)]
#[must_use]
pub fn abs<T: Scalar>(x: T) -> T {
    x.libm_copysign(T::ONE)
}

/// The smaller of two numbers; a NaN loses against a number.
#[inline(always)]
#[must_use]
pub fn min<T: Scalar>(a: T, b: T) -> T {
    if a < b || b.is_nan_number() { a } else { b }
}

/// The larger of two numbers; a NaN loses against a number.
#[inline(always)]
#[must_use]
pub fn max<T: Scalar>(a: T, b: T) -> T {
    if a > b || b.is_nan_number() { a } else { b }
}
