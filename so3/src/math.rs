//! The only door to elementary functions: identical bits on host and target.
//!
//! Sine, cosine and arc tangent are our own (`math/sin_cos.rs`, `math/atan.rs`); all else is pinned `libm`, which is Rust source and so the same
//! arithmetic everywhere. The square root is a machine instruction where there is one and integer code where
//! there is not: both are correctly rounded, so equal. Nothing here fuses a multiplication and an addition, unless the
//! feature `fused` asks for it (see [`mul_add`]).

pub(crate) mod atan;
mod polynomial;
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
    sin_cos_into(x, &mut sin, &mut cos);
    (sin, cos)
}

/// As [`sin_cos_array`], written where they are to stand: a microcontroller copies no arrays.
#[inline]
pub fn sin_cos_into<T: Scalar, const N: usize>(x: &[T; N], sin: &mut [T; N], cos: &mut [T; N]) {
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
}

/// a b + c.
///
/// Rounded twice, as the operators do, on every target, so that host and target compute the same bits. With the feature
/// `fused` (which needs `std`) *and* a build for x86-64 processors that have the instruction
/// (`-C target-cpu=native` or `x86-64-v3`) it is rounded once and costs half: for programs on a host that need speed
/// and not the bits of the firmware.
#[inline(always)]
#[must_use]
pub fn mul_add<T: Scalar>(a: T, b: T, c: T) -> T {
    a.times_plus(b, c)
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

/// Arc tangent in rad, in [−π/2, π/2].
///
/// Branch-free; the derivation stands in `math/atan.rs`. Odd; −0 keeps its sign.
///
/// # Accuracy
/// 1.8 units in the last place (tests `atan_f64`, `atan_f32`).
#[inline(always)]
#[must_use]
pub fn atan<T: Scalar>(x: T) -> T {
    copysign(quadrant(abs(x), T::ONE), x)
}

/// atan2(y, x) for x ≥ 0 and y ≥ 0, not both zero and not both infinite: in [0, π/2], with the accuracy of [`atan`].
#[inline(always)]
pub(crate) fn quadrant<T: Scalar>(y: T, x: T) -> T {
    y.angle_in_quadrant(x)
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
    x.core_copysign(sign)
}

/// Absolute value.
#[inline(always)]
#[must_use]
pub fn abs<T: Scalar>(x: T) -> T {
    x.core_copysign(T::ONE)
}

/// √(x² + y²) without overflow or underflow on the way, within 1 unit in the last place.
#[inline(always)]
#[must_use]
pub fn hypot<T: Scalar>(x: T, y: T) -> T {
    x.libm_hypot(y)
}

/// xⁿ by repeated squaring, at most 32 steps and no table; x⁰ = 1.
#[inline(always)]
#[must_use]
pub fn powi<T: Scalar>(x: T, n: u32) -> T {
    let (mut power, mut base, mut n) = (T::ONE, x, n);
    while n != 0 {
        if n & 1 == 1 {
            power *= base;
        }
        base *= base;
        n >>= 1;
    }
    power
}

/// The smaller of two numbers; a NaN loses against a number, as in IEEE 754 `minNum`.
///
/// min(NaN, 1) = min(1, NaN) = 1; NaN only if both are NaN. Of −0 and +0 the second argument is returned. Test:
/// `min_max_clamp_and_nan`.
#[inline(always)]
#[must_use]
pub fn min<T: Scalar>(a: T, b: T) -> T {
    if a < b || b.is_nan_number() { a } else { b }
}

/// The larger of two numbers; a NaN loses against a number, as in IEEE 754 `maxNum`.
///
/// max(NaN, 1) = max(1, NaN) = 1; NaN only if both are NaN. Of −0 and +0 the second argument is returned. Test:
/// `min_max_clamp_and_nan`.
#[inline(always)]
#[must_use]
pub fn max<T: Scalar>(a: T, b: T) -> T {
    if a > b || b.is_nan_number() { a } else { b }
}

/// `x` limited to [`low`, `high`]; **NaN becomes `low`**, so that a command is always within its limits.
///
/// Where a NaN must be noticed, test for it first. If `low` > `high` the result is `high`. Test:
/// `min_max_clamp_and_nan`.
#[inline(always)]
#[must_use]
pub fn clamp<T: Scalar>(x: T, low: T, high: T) -> T {
    min(max(x, low), high)
}
