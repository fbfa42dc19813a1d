//! What `so3::math` promises about NaN, order, powers and special values.
#![allow(clippy::disallowed_methods, reason = "std is the reference here")]

use proptest::prelude::*;
use so3::math::{
    abs, clamp, copysign, cos, floor, hypot, max, min, mul_add, powi, sin, sin_cos, sqrt,
};

#[test]
fn min_max_clamp_and_nan() {
    let nan = f64::NAN;
    assert_eq!((min(nan, 1.0), min(1.0, nan)), (1.0, 1.0));
    assert_eq!((max(nan, 1.0), max(1.0, nan)), (1.0, 1.0));
    assert!(min(nan, nan).is_nan() && max(nan, nan).is_nan());
    assert_eq!(
        (min(2.0, 1.0), min(1.0, 2.0), max(2.0, 1.0), max(1.0, 2.0)),
        (1.0, 1.0, 2.0, 2.0)
    );
    assert_eq!(min(-0.0, 0.0_f64).to_bits(), 0.0_f64.to_bits());
    assert_eq!(max(0.0, -0.0_f64).to_bits(), (-0.0_f64).to_bits());
    assert_eq!(
        (
            clamp(nan, -1.0, 2.0),
            clamp(5.0, -1.0, 2.0),
            clamp(-5.0, -1.0, 2.0)
        ),
        (-1., 2., -1.)
    );
    assert_eq!(
        (clamp(0.5_f32, -1.0, 2.0), clamp(0.5_f32, 3.0, 2.0)),
        (0.5, 2.0)
    );
    assert_eq!(
        (
            clamp(f64::INFINITY, -1.0, 2.0),
            clamp(f64::NEG_INFINITY, -1.0, 2.0)
        ),
        (2.0, -1.0)
    );
}

#[test]
fn square_root_is_correctly_rounded() {
    // 1 + ε and its neighbours, exact squares, subnormals, and the ends.
    for x in [
        0.0,
        -0.0,
        1.0,
        4.0,
        2.0,
        1.0 + f64::EPSILON,
        5e-324,
        f64::MAX,
        f64::INFINITY,
    ] {
        assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits());
    }
    assert!(sqrt(-1.0_f64).is_nan() && sqrt(f32::NAN).is_nan());
}

proptest! {
    #[test]
    fn square_root_equals_the_instruction(x in 0.0..f64::MAX, y in 0.0..f32::MAX) {
        prop_assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits());
        prop_assert_eq!(sqrt(y).to_bits(), y.sqrt().to_bits());
    }

    #[test]
    fn small_functions(x in -1e3..1e3_f64, y in -1e3..1e3_f64, n in 0..12_u32) {
        prop_assert_eq!(abs(x), x.abs());
        prop_assert_eq!(copysign(x, y), x.copysign(y));
        prop_assert_eq!(floor(x), x.floor());
        prop_assert_eq!((sin(x), cos(x)), sin_cos(x));
        prop_assert!((hypot(x, y) - x.hypot(y)).abs() <= f64::EPSILON * x.hypot(y));
        let power = (0..n).fold(1.0, |p, _| p * x);
        prop_assert!((powi(x, n) - power).abs() <= 16.0 * f64::EPSILON * power.abs());
    }
}

/// Twice, as the operators; once, and so exactly here, where the feature and the processor have it.
#[test]
fn mul_add_is_rounded_as_promised() {
    let x = 1.0 + f64::EPSILON;
    let product = x * x;
    let lost = mul_add(x, x, -product);
    if cfg!(all(feature = "fused", target_feature = "fma")) {
        assert_eq!(lost, f64::EPSILON * f64::EPSILON);
    } else {
        assert_eq!(lost, 0.0);
    }
    assert_eq!(mul_add(2.0_f32, 3.0, 4.0), 10.0);
    assert!(mul_add(f64::NAN, 0.0, 1.0).is_nan());
}
