//! Sine and cosine together, branch-free, for the angles a robot has.
//!
//! # Derivation
//! With a = |x|, let k be the integer nearest to 2a/π and r = a − k π/2, so that |r| ≤ π/4. Then sin a and
//! cos a are ±sin r and ±cos r, exchanged when k is odd; two bits of k choose. Three steps:
//!
//! 1. *Reduction* (Cody and Waite 1980). π/2 is cut into P1 + P2 + P3, the first two so short that their
//!    products with k are exact up to the bound (3216 rad in f64, 402 rad in f32). a − k P1 is exact by
//!    Sterbenz' lemma, a − k P1 − k P2 is rounded once, and k P3, which matters only next to a multiple of π/2
//!    where cos is flat, joins the sine at the end. So r keeps its relative accuracy even for the number that
//!    lies closest to a multiple of π/2 (2⁻⁶⁰ away in f64, 2⁻²⁸ in f32).
//! 2. *Polynomials* on |r| ≤ π/4, minimax in relative error (a Remez exchange in 50 digits, then rounded):
//!    sin r = r + r³ S(r²), within 2⁻⁵⁶ (f64) or 2⁻²⁶ (f32); cos r = 1 − r²/2 + r⁴ C(r²), within 2⁻⁵⁹ or 2⁻³².
//! 3. *Quadrant.* Exchange and signs by masks, so that a loop over joints becomes vector code.
//!
//! Beyond the bound, and for infinities and NaN, the caller takes `libm`, which reduces any finite number.
//! There is no fused multiply-add anywhere: the bits are the same on every target.

use super::polynomial::polynomial;

macro_rules! kernel {
    (
        $name:ident, $t:ident, $bits:ident,
        two_over_pi: $two_over_pi:expr, half_pi: [$p1:expr, $p2:expr, $p3:expr],
        sin: [$($s:expr),+], cos: [$($c:expr),+] $(,)?
    ) => {
        /// (sin x, cos x) for |x| up to the bound of the scalar; elsewhere some numbers without meaning.
        #[inline(always)]
        #[allow(clippy::excessive_precision, reason = "shortest text of the exact constants")]
        pub(crate) fn $name(x: $t) -> ($t, $t) {
            const SIGN: $bits = 1 << ($bits::BITS - 1);
            // Adding 1.5 · 2^(mantissa bits) leaves the nearest integer in the low bits of the sum.
            const TO_INTEGER: $t = 1.5 / $t::EPSILON;

            let x_sign = x.to_bits() & SIGN;
            let a = $t::from_bits(x.to_bits() ^ x_sign);
            let shifted = a * $two_over_pi + TO_INTEGER;
            let k = shifted - TO_INTEGER;
            let r = (a - k * $p1) - k * $p2;
            let z = r * r;
            let z2 = z * z;
            let sin_r = r + (r * z * (polynomial!(z, z2; $($s),+)) - k * $p3);
            let cos_r = (1.0 - 0.5 * z) + z2 * (polynomial!(z, z2; $($c),+));

            // k odd: exchange. Bit 1 of k is the sign of the sine, bit 1 of k + 1 that of the cosine.
            let quadrant = shifted.to_bits();
            let (s, c) = (sin_r.to_bits(), cos_r.to_bits());
            let exchange = (s ^ c) & (quadrant & 1).wrapping_neg();
            let sin_sign = (quadrant << ($bits::BITS - 2)) & SIGN;
            let cos_sign = sin_sign ^ (quadrant << ($bits::BITS - 1));
            ($t::from_bits(s ^ exchange ^ sin_sign ^ x_sign), $t::from_bits(c ^ exchange ^ cos_sign))
        }
    };
}

kernel!(
    sin_cos_f64, f64, u64,
    two_over_pi: core::f64::consts::FRAC_2_PI,
    // 42 + 42 + 53 bits: k may have 11 bits.
    half_pi: [1.570796326794607, 2.8960739716218175e-13, 1.6446256936324258e-26],
    sin: [
        -0.1666666666666663, 0.008333333333322009, -0.00019841269829497723,
        2.7557313588417523e-06, -2.5050742436618417e-08, 1.5895912406158605e-10
    ],
    cos: [
        0.041666666666666595, -0.00138888888888729, 2.4801587288750595e-05,
        -2.7557314149338005e-07, 2.0875696672087142e-09, -1.1358315758743341e-11
    ],
);

kernel!(
    sin_cos_f32, f32, u32,
    two_over_pi: core::f32::consts::FRAC_2_PI,
    // 16 + 16 + 24 bits: k may have 8 bits.
    half_pi: [1.570770263671875, 2.6063062250614166e-05, 6.07710062827671e-11],
    sin: [-0.16666655242443085, 0.00833215657621622, -0.00019514646555762738],
    cos: [0.04166664555668831, -0.0013887309469282627, 2.4432431018794887e-05],
);
