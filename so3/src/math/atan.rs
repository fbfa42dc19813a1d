//! The angle of a point in the first quadrant, branch-free: the arc tangent without its overflow and its branches.
//!
//! # Derivation
//! With t = tan(π/8), the point (x, y) is turned by 0, −π/4 or −π/2, as y/x lies below t, between t and 1/t, or above:
//! (x, y), (y + x, y − x) or (y, −x), up to a factor that the ratio forgets. So u = y'/x' is within ±t, one division
//! serves all three, and
//!
//! - atan u = u + u³ P(u²), P minimax in relative error (a Remez exchange in 60 digits, then rounded): within 2⁻⁵⁷
//!   (f64) or 2⁻²⁸ (f32);
//! - what π/4 and π/2 lose when they are rounded joins the small part.
//!
//! y − x is exact between x/2 and 2x (Sterbenz' lemma) and rounded once elsewhere.

use super::polynomial::polynomial;

macro_rules! kernel {
    ($name:ident, $t:ident, eighth: $eighth:expr, quarter_low: $low:expr, atan: [$($c:expr),+] $(,)?) => {
        /// atan2(y, x) for x ≥ 0 and y ≥ 0, not both zero and not both infinite.
        #[inline(always)]
        #[allow(clippy::excessive_precision, reason = "shortest text of the exact constants")]
        pub(crate) fn $name(y: $t, x: $t) -> $t {
            let (near, far) = (y <= $eighth * x, x < $eighth * y);
            let (rise, run, turns) = if near {
                (y, x, 0.0)
            } else if far {
                (-x, y, 2.0)
            } else {
                (y - x, y + x, 1.0)
            };
            let u = rise / run;
            let z = u * u;
            let z2 = z * z;
            let small = u * z * (polynomial!(z, z2; $($c),+)) + turns * $low;
            turns * core::$t::consts::FRAC_PI_4 + (u + small)
        }
    };
}

kernel!(
    quadrant_f64, f64, eighth: 0.414_213_562_373_095_05, quarter_low: 3.061616997868383e-17,
    atan: [
        -0.333333333333332, 0.1999999999995325, -0.14285714280166867, 0.11111110782170243,
        -0.0909089772569135, 0.07692059725265041, -0.0666309929262749, 0.05847859915256046,
        -0.05039193284244219, 0.03806221135984691, -0.017905116239148457
    ],
);

kernel!(
    quadrant_f32, f32, eighth: 0.414_213_56, quarter_low: -2.185_569_4e-8,
    atan: [
        -0.33333316445350647, 0.19998471438884735, -0.14243532717227936, 0.1059381440281868,
        -0.06078222766518593
    ],
);
