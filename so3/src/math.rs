//! The only door to elementary functions: pinned `libm`, identical on host and target.

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

/// Sine and cosine of an angle in rad.
#[inline(always)]
#[must_use]
pub fn sin_cos<T: Scalar>(x: T) -> (T, T) {
    x.libm_sin_cos()
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
