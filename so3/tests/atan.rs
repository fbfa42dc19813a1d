//! `math::atan` against a double-double oracle (f64), against `libm` in f64 (f32), and at its edges.

use proptest::prelude::*;
use so3::math::{atan, atan2};

const BOUND: f64 = 1.8;

/// Slopes from 10⁻²⁶ to 10²⁶, dense next to 1 and to the seams at tan(π/8) and its inverse.
fn slopes() -> impl Iterator<Item = f64> {
    let seams = [0.414_213_562_373_095_05, 2.414_213_562_373_095, 1.0];
    let near = seams.into_iter().flat_map(|x: f64| {
        (-40..=40).map(move |k| f64::from_bits(x.to_bits().saturating_add_signed(k)))
    });
    (-6_000..6_000)
        .map(|k| libm::exp(f64::from(k) * 1e-2))
        .chain((0..40_000).map(|k| f64::from(k) * 1.234_567e-4))
        .chain(near)
}

#[test]
fn atan_f64() {
    let worst = slopes()
        .map(|x| crate::oracle::ulps(atan(x), crate::oracle::atan(x)))
        .fold(0.0, f64::max);
    println!("worst error: {worst} ulp");
    assert!(worst <= BOUND, "{worst} ulp");
}

#[test]
fn atan_f32() {
    let worst = (0..f32::INFINITY.to_bits())
        .step_by(1_009)
        .map(|bits| {
            let x = f32::from_bits(bits);
            let exact = libm::atan(f64::from(x));
            let near = exact as f32;
            let unit = f64::from(f32::from_bits(near.to_bits() + 1)) - f64::from(near);
            ((f64::from(atan(x)) - exact) / unit).abs()
        })
        .fold(0.0, f64::max);
    println!("worst error: {worst} ulp");
    assert!(worst <= BOUND, "{worst} ulp");
}

#[test]
fn edges() {
    assert_eq!(atan(f64::INFINITY), core::f64::consts::FRAC_PI_2);
    assert_eq!(atan(f32::NEG_INFINITY), -core::f32::consts::FRAC_PI_2);
    assert_eq!(atan(f64::MAX), core::f64::consts::FRAC_PI_2);
    assert_eq!(atan(1.0), core::f64::consts::FRAC_PI_4);
    assert_eq!(atan(-0.0_f64).to_bits(), (-0.0_f64).to_bits());
    assert_eq!(atan(5e-324), 5e-324);
    assert!(atan(f64::NAN).is_nan() && atan(f32::NAN).is_nan());
}

proptest! {
    #[test]
    fn odd_and_the_angle_of_a_slope(x in -1e3..1e3_f64) {
        prop_assert_eq!(atan(-x), -atan(x));
        prop_assert!((atan(x) - atan2(x, 1.0)).abs() <= 4e-16);
    }
}
