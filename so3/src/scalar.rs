//! The two scalars of the house, `f32` and `f64`, behind one sealed trait.

use crate::math::atan::{quadrant_f32, quadrant_f64};
use crate::math::sin_cos::{sin_cos_f32, sin_cos_f64};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A floating-point number that every crate of the workspace is generic over: `f32` or `f64`.
///
/// Arithmetic comes from the operators; elementary functions come only from [`crate::math`], so that
/// host and target compute the same bits.
pub trait Scalar:
    sealed::Sealed + nalgebra::RealField + Copy + Default + Send + Sync + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// ½.
    const HALF: Self;
    /// π.
    const PI: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// +∞.
    const INFINITY: Self;
    /// −∞.
    const NEG_INFINITY: Self;
    /// A quiet NaN.
    const NAN: Self;
    /// Largest finite number.
    const MAX: Self;
    #[doc(hidden)]
    const SIN_COS_BOUND: Self;

    /// The nearest number of this type to `value`.
    fn of(value: f64) -> Self;
    /// `self` as an `f64`: exact.
    fn to_f64(self) -> f64;
    /// Neither NaN nor infinite.
    fn is_finite_number(self) -> bool;
    /// Not a number.
    fn is_nan_number(self) -> bool;

    #[doc(hidden)]
    fn times_plus(self, b: Self, c: Self) -> Self;
    #[doc(hidden)]
    fn libm_sqrt(self) -> Self;
    #[doc(hidden)]
    fn sin_cos_within_bound(self) -> (Self, Self);
    #[doc(hidden)]
    fn libm_sin_cos(self) -> (Self, Self);
    #[doc(hidden)]
    fn libm_tan(self) -> Self;
    #[doc(hidden)]
    fn libm_asin(self) -> Self;
    #[doc(hidden)]
    fn libm_acos(self) -> Self;
    #[doc(hidden)]
    fn angle_in_quadrant(self, x: Self) -> Self;
    #[doc(hidden)]
    fn libm_atan2(self, x: Self) -> Self;
    #[doc(hidden)]
    fn libm_hypot(self, y: Self) -> Self;
    #[doc(hidden)]
    fn libm_exp(self) -> Self;
    #[doc(hidden)]
    fn libm_log(self) -> Self;
    #[doc(hidden)]
    fn libm_tanh(self) -> Self;
    #[doc(hidden)]
    fn libm_floor(self) -> Self;
    #[doc(hidden)]
    fn core_copysign(self, sign: Self) -> Self;
}

/// `libm` for one scalar: C's suffix hidden, so that one macro serves both.
mod libm_f32 {
    pub(super) use libm::{
        acosf as acos, asinf as asin, atan2f as atan2, expf as exp, floorf as floor,
        hypotf as hypot, logf as log, sincosf as sincos, sqrtf as sqrt, tanf as tan, tanhf as tanh,
    };
}

macro_rules! scalar {
    ($t:ident, $libm:ident, sin_cos: $sin_cos:ident within $sin_cos_bound:literal, quadrant: $quadrant:ident) => {
        impl Scalar for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const PI: Self = core::$t::consts::PI;
            const EPSILON: Self = $t::EPSILON;
            const INFINITY: Self = $t::INFINITY;
            const NEG_INFINITY: Self = $t::NEG_INFINITY;
            const NAN: Self = $t::NAN;
            const MAX: Self = $t::MAX;
            const SIN_COS_BOUND: Self = $sin_cos_bound;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn is_finite_number(self) -> bool {
                self.is_finite()
            }
            #[inline(always)]
            fn is_nan_number(self) -> bool {
                self.is_nan()
            }
            #[cfg(all(feature = "fused", target_feature = "fma"))]
            #[expect(clippy::disallowed_methods, reason = "this is the door")]
            #[inline(always)]
            fn times_plus(self, b: Self, c: Self) -> Self {
                $t::mul_add(self, b, c)
            }
            #[cfg(not(all(feature = "fused", target_feature = "fma")))]
            #[inline(always)]
            fn times_plus(self, b: Self, c: Self) -> Self {
                self * b + c
            }
            #[inline(always)]
            fn libm_sqrt(self) -> Self {
                $libm::sqrt(self)
            }
            #[inline(always)]
            fn sin_cos_within_bound(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[cold]
            fn libm_sin_cos(self) -> (Self, Self) {
                $libm::sincos(self)
            }
            #[inline(always)]
            fn libm_tan(self) -> Self {
                $libm::tan(self)
            }
            #[inline(always)]
            fn libm_asin(self) -> Self {
                $libm::asin(self)
            }
            #[inline(always)]
            fn libm_acos(self) -> Self {
                $libm::acos(self)
            }
            #[inline(always)]
            fn angle_in_quadrant(self, x: Self) -> Self {
                $quadrant(self, x)
            }
            #[inline(always)]
            fn libm_atan2(self, x: Self) -> Self {
                $libm::atan2(self, x)
            }
            #[inline(always)]
            fn libm_hypot(self, y: Self) -> Self {
                $libm::hypot(self, y)
            }
            #[inline(always)]
            fn libm_exp(self) -> Self {
                $libm::exp(self)
            }
            #[inline(always)]
            fn libm_log(self) -> Self {
                $libm::log(self)
            }
            #[inline(always)]
            fn libm_tanh(self) -> Self {
                $libm::tanh(self)
            }
            #[inline(always)]
            fn libm_floor(self) -> Self {
                $libm::floor(self)
            }
            #[inline(always)]
            fn core_copysign(self, sign: Self) -> Self {
                // Bits, no arithmetic: the same everywhere, and not a call as that of `libm` is.
                $t::copysign(self, sign)
            }
        }
    };
}

scalar!(f32, libm_f32, sin_cos: sin_cos_f32 within 402.0, quadrant: quadrant_f32);
scalar!(f64, libm, sin_cos: sin_cos_f64 within 3216.0, quadrant: quadrant_f64);
