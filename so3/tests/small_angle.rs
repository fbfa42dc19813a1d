//! The coefficients of exp and the Jacobians against double-double series.

#![allow(
    clippy::disallowed_methods,
    reason = "tests: only inputs are made here"
)]

use crate::oracle::{Dd, even_series};
use so3::Scalar;
use so3::small_angle::{coefficients, inverse_coefficient};

/// Squared angles from 0 to π², dense around the series limit.
fn squares<T: Scalar>() -> Vec<T> {
    let mut z: Vec<f64> = (0..400)
        .map(|i| f64::from(i) * (9.869_604 / 399.0))
        .collect();
    z.extend((0..200).map(|i| 1.0 + f64::from(i - 100) * 1e-3));
    z.extend((0..600).map(|i| 10.0_f64.powf(-f64::from(i) / 2.0)));
    z.into_iter().map(T::of).collect()
}

/// |value/exact − 1| in ε.
fn relative<T: Scalar>(value: T, exact: Dd) -> f64 {
    let error = ((value.to_f64() - exact.0) - exact.1) / exact.0 / T::EPSILON.to_f64();
    assert!(!error.is_nan());
    error.abs()
}

fn worst<T: Scalar>() -> [f64; 4] {
    squares::<T>().into_iter().fold([0.0; 4], |worst, z| {
        let exact = Dd(z.to_f64(), 0.0);
        let ours = coefficients(z);
        let errors = [
            // sin π = 0: relative to what is lost, 1.
            relative(ours.a, even_series(exact, 1)) * even_series(exact, 1).0.max(1e-9),
            relative(ours.b, even_series(exact, 2)),
            relative(ours.c, even_series(exact, 3)),
            relative(
                inverse_coefficient(z),
                crate::oracle::inverse_coefficient(exact),
            ),
        ];
        core::array::from_fn(|i| worst[i].max(errors[i]))
    })
}

#[test]
fn coefficients_against_double_double() {
    for worst in [worst::<f64>(), worst::<f32>()] {
        println!("a, b, c, d: {worst:?}");
        assert!(worst[0] <= 2.0, "a: {} ε", worst[0]);
        assert!(worst[1] <= 4.0, "b: {} ε", worst[1]);
        assert!(worst[2] <= 8.0, "c: {} ε", worst[2]);
    }
}

#[test]
fn inverse_coefficient_against_double_double() {
    for worst in [worst::<f64>(), worst::<f32>()] {
        assert!(worst[3] <= 16.0, "d: {} ε", worst[3]);
    }
}

#[test]
fn limits_at_zero() {
    let at_zero = coefficients(0.0);
    assert_eq!((at_zero.a, at_zero.b, at_zero.c), (1.0, 0.5, 1.0 / 6.0));
    assert_eq!(inverse_coefficient(0.0), 1.0 / 12.0);
}
