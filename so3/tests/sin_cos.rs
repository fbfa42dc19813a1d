//! `math::sin_cos` against a double-double oracle (f64), against `libm` in f64 (f32), and at its edges.
use proptest::prelude::*;
use so3::math::{sin_cos, sin_cos_array};

/// Numbers with 106 bits, as unevaluated sums; error-free transformations after Dekker and Knuth.
mod oracle {
    #[derive(Clone, Copy)]
    pub(crate) struct Dd(f64, f64);

    fn two_sum(a: f64, b: f64) -> Dd {
        let s = a + b;
        let t = s - a;
        Dd(s, (a - (s - t)) + (b - t))
    }

    fn split(a: f64) -> (f64, f64) {
        let t = a * 134_217_729.0;
        let high = t - (t - a);
        (high, a - high)
    }

    fn two_product(a: f64, b: f64) -> Dd {
        let p = a * b;
        let ((ah, al), (bh, bl)) = (split(a), split(b));
        Dd(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }

    impl Dd {
        fn add(self, o: Dd) -> Dd {
            let (s, t) = (two_sum(self.0, o.0), two_sum(self.1, o.1));
            let s = two_sum(s.0, s.1 + t.0);
            two_sum(s.0, s.1 + t.1)
        }
        fn mul(self, o: Dd) -> Dd {
            let p = two_product(self.0, o.0);
            two_sum(p.0, p.1 + (self.0 * o.1 + self.1 * o.0))
        }
        fn div(self, d: f64) -> Dd {
            let q = self.0 / d;
            let r = self.add(two_product(-q, d));
            two_sum(q, (r.0 + r.1) / d)
        }
    }

    /// π/2 to about 200 bits.
    const HALF_PI: [f64; 4] = [
        core::f64::consts::FRAC_PI_2,
        6.123_233_995_736_766e-17,
        -1.497_384_904_859_169_8e-33,
        5.562_271_104_316_826e-50,
    ];

    /// Taylor series of the sine (from r) or the cosine (from 1) on |r| ≤ π/4.
    fn series(first: Dd, r: Dd, mut n: f64) -> Dd {
        let z = r.mul(r);
        let (mut term, mut sum) = (first, first);
        while n < 40.0 {
            term = term.mul(z).div(-(n + 1.0) * (n + 2.0));
            sum = sum.add(term);
            n += 2.0;
        }
        sum
    }

    /// (sin x, cos x) to about 100 bits, |x| < 10⁴.
    pub(crate) fn sin_cos(x: f64) -> (Dd, Dd) {
        let k = (x / HALF_PI[0]).round();
        let r = HALF_PI
            .iter()
            .fold(Dd(x, 0.0), |r, &part| r.add(two_product(-k, part)));
        let (s, c) = (series(r, r, 1.0), series(Dd(1.0, 0.0), r, 0.0));
        let minus = |v: Dd| Dd(-v.0, -v.1);
        match k.rem_euclid(4.0) as u8 {
            0 => (s, c),
            1 => (c, minus(s)),
            2 => (minus(s), minus(c)),
            _ => (minus(c), s),
        }
    }

    /// Distance from `value` to the exact number in units in its last place.
    pub(crate) fn ulps(value: f64, exact: Dd) -> f64 {
        let near = exact.0.abs();
        let unit = f64::from_bits(near.to_bits() + 1) - near;
        (((value - exact.0) - exact.1) / unit).abs()
    }
}

/// Worst error of sine and cosine at `x`, in units in the last place.
fn error_f64(x: f64) -> f64 {
    let (exact, ours) = (oracle::sin_cos(x), sin_cos(x));
    oracle::ulps(ours.0, exact.0).max(oracle::ulps(ours.1, exact.1))
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
