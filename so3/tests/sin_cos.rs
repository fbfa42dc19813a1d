//! `math::sin_cos` against a double-double oracle (f64), against `libm` in f64 (f32), and at its edges.

use proptest::prelude::*;
use so3::math::{sin_cos, sin_cos_array};

/// Worst error of sine and cosine at `x`, in units in the last place.
fn error_f64(x: f64) -> f64 {
    let (exact, ours) = (crate::oracle::sin_cos(x), sin_cos(x));
    crate::oracle::ulps(ours.0, exact.0).max(crate::oracle::ulps(ours.1, exact.1))
}

/// The same in f32; `libm` in f64 is exact for this purpose.
fn error_f32(x: f32) -> f64 {
    let (exact, ours) = (libm::sincos(f64::from(x)), sin_cos(x));
    let ulps = |value: f32, exact: f64| {
        let near = (exact as f32).abs();
        let unit = f64::from(f32::from_bits(near.to_bits() + 1)) - f64::from(near);
        ((f64::from(value) - exact) / unit).abs()
    };
    ulps(ours.0, exact.0).max(ulps(ours.1, exact.1))
}

const BOUND_F64: f64 = 1.6;
const BOUND_F32: f64 = 1.7;

#[test]
fn sin_cos_f64_on_a_grid() {
    let worst = (0..60_000)
        .map(|i| error_f64((f64::from(i) - 30_000.0) * (3216.0 / 30_000.0) * 0.999_987))
        .chain((0..60_000).map(|i| error_f64(f64::from(i) * 1.234_567e-4)))
        .fold(0.0, f64::max);
    println!("worst error on the grid: {worst} ulp");
    assert!(worst <= BOUND_F64, "{worst} ulp");
}

#[test]
fn sin_cos_f64_next_to_multiples_of_a_quarter_turn() {
    let mut worst: f64 = 0.0;
    for k in 0..=2 * 2047 {
        // Multiples of π/4: the zeros and the seams between two quadrants.
        let x = f64::from(k) * core::f64::consts::FRAC_PI_4;
        for offset in -20_i64..=20 {
            let x = f64::from_bits(x.to_bits().saturating_add_signed(offset));
            worst = worst.max(error_f64(x)).max(error_f64(-x));
        }
    }
    println!("worst error next to multiples of π/4: {worst} ulp");
    assert!(worst <= BOUND_F64, "{worst} ulp");
}

#[test]
fn sin_cos_f32_sweep() {
    // Every 517th number from the smallest to the largest of the fast path, and all next to k π/4.
    let mut worst = (0..402.0_f32.to_bits())
        .step_by(517)
        .map(|bits| error_f32(f32::from_bits(bits)))
        .fold(0.0, f64::max);
    println!("worst error of the sweep: {worst} ulp");
    for k in 0..512 {
        let x = (f64::from(k) * core::f64::consts::FRAC_PI_4) as f32;
        for offset in -200_i32..=200 {
            let x = f32::from_bits(x.to_bits().saturating_add_signed(offset) & 0x7fff_ffff);
            worst = worst.max(error_f32(x));
        }
    }
    println!("worst error with multiples of π/4: {worst} ulp");
    assert!(worst <= BOUND_F32, "{worst} ulp");
}

#[test]
fn sin_cos_beyond_the_bound_is_libm() {
    for x in [3216.1, 1e5, 1e9, 1e22, 1.7e308, f64::MAX, -1e15] {
        assert_eq!(sin_cos(x), libm::sincos(x));
    }
    for x in [402.1, 1e5, 1e20, f32::MAX, -3.3e7] {
        assert_eq!(sin_cos(x), libm::sincosf(x));
    }
}

#[test]
fn sin_cos_special_values() {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (s, c) = sin_cos(x);
        assert!(s.is_nan() && c.is_nan());
        let (s, c) = sin_cos(x as f32);
        assert!(s.is_nan() && c.is_nan());
    }
    assert_eq!(sin_cos(-0.0_f64).0.to_bits(), (-0.0_f64).to_bits());
    assert_eq!(sin_cos(-0.0_f32).0.to_bits(), (-0.0_f32).to_bits());
    assert_eq!(sin_cos(0.0_f64), (0.0, 1.0));
    for x in [f64::MIN_POSITIVE, 5e-324, 1e-300, -1e-200] {
        assert_eq!(sin_cos(x), (x, 1.0), "sin x = x for tiny x");
    }
    for x in [f32::MIN_POSITIVE, 1e-45, -1e-30] {
        assert_eq!(sin_cos(x), (x, 1.0), "sin x = x for tiny x");
    }
}

proptest! {
    #[test]
    fn sin_cos_f64_random(x in -3300.0..3300.0_f64) {
        prop_assert!(error_f64(x) <= BOUND_F64);
    }

    #[test]
    fn sin_cos_symmetry(x in -4000.0..4000.0_f64) {
        let ((s, c), (s_minus, c_minus)) = (sin_cos(x), sin_cos(-x));
        prop_assert_eq!((s, c), (-s_minus, c_minus));
        let x = x as f32;
        let ((s, c), (s_minus, c_minus)) = (sin_cos(x), sin_cos(-x));
        prop_assert_eq!((s, c), (-s_minus, c_minus));
    }

    #[test]
    fn sin_cos_array_equals_single_calls(x in prop::array::uniform12(prop::num::f64::ANY)) {
        let bits = |v: f64| if v.is_nan() { 0 } else { v.to_bits() };
        let (s, c) = sin_cos_array(&x);
        for (i, &x) in x.iter().enumerate() {
            let one = sin_cos(x);
            prop_assert_eq!((bits(s[i]), bits(c[i])), (bits(one.0), bits(one.1)));
        }
    }
}
