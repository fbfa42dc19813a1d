//! Roll, pitch, yaw: both orders against products of elementary rotations, gimbal lock, rates.
#![allow(clippy::disallowed_methods, reason = "std is the reference here")]

use core::f64::consts::{FRAC_PI_2, PI};

use crate::cases::{matrix_error, rotation_vector, rotation_vectors};
use proptest::prelude::*;
use so3::euler::{RollPitchYaw, rotation_x, rotation_y, rotation_z};
use so3::{Error, Rotation3, Scalar, Vector3, exp, vee};

const ORDERS: [RollPitchYaw; 2] = [RollPitchYaw::Zyx, RollPitchYaw::Zxy];

fn product(order: RollPitchYaw, rpy: &Vector3<f64>) -> Rotation3<f64> {
    let (x, y, z) = (rotation_x(rpy.x), rotation_y(rpy.y), rotation_z(rpy.z));
    match order {
        RollPitchYaw::Zyx => z * y * x,
        RollPitchYaw::Zxy => z * x * y,
    }
}

fn angles() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-7.0..7.0_f64).prop_map(Vector3::from)
}

#[test]
fn elementary_rotations_are_exp() {
    for angle in [-3.0, -0.4, 0.0, 1e-9, 2.0, 20.0] {
        let pairs = [
            (rotation_x(angle), Vector3::x()),
            (rotation_y(angle), Vector3::y()),
            (rotation_z(angle), Vector3::z()),
        ];
        for (rot, axis) in pairs {
            assert!(matrix_error(rot.matrix(), exp(&(axis * angle)).matrix()) < 16.0);
        }
    }
}

fn round_trip<T: Scalar>() -> f64 {
    let mut worst: f64 = 0.0;
    for rot in rotation_vectors::<T>().iter().map(exp) {
        for order in ORDERS {
            let rpy = order.angles(&rot);
            worst = worst.max(matrix_error(order.rotation(&rpy).matrix(), rot.matrix()));
            let middle = if order == RollPitchYaw::Zyx {
                rpy.y
            } else {
                rpy.x
            };
            assert!(middle.to_f64().abs() <= FRAC_PI_2 + 1e-7);
        }
    }
    worst
}

#[test]
fn angles_round_trip() {
    for worst in [round_trip::<f64>(), round_trip::<f32>()] {
        println!("matrix -> angles -> matrix: {worst} ε");
        assert!(worst <= 8.0);
    }
}

#[test]
fn at_gimbal_lock() {
    let mut worst: f64 = 0.0;
    for order in ORDERS {
        for sign in [-1.0, 1.0] {
            for off in [0.0, 1e-17, 1e-15, 1e-12, 1e-9, 1e-8, 1e-6, 1e-3] {
                for (a, b) in [(0.0, 0.0), (0.3, -1.0), (-3.0, 2.0), (0.5, 0.5)] {
                    let middle = sign * (FRAC_PI_2 - off);
                    let rpy = match order {
                        RollPitchYaw::Zyx => Vector3::new(a, middle, b),
                        RollPitchYaw::Zxy => Vector3::new(middle, a, b),
                    };
                    let rot = order.rotation(&rpy);
                    let again = order.rotation(&order.angles(&rot));
                    worst = worst.max(matrix_error(again.matrix(), rot.matrix()));
                    let locked = off < f64::EPSILON.sqrt();
                    assert_eq!(
                        order.rates_from_omega(&rpy) == Err(Error::GimbalLock),
                        locked
                    );
                }
            }
        }
    }
    println!("at gimbal lock: {worst} ε");
    assert!(worst <= 8.0);
    // With exact zeros the innermost angle is zero.
    let up =
        Rotation3::from_matrix_unchecked(so3::Matrix3::new(0., 0., 1., 0., 1., 0., -1., 0., 0.));
    assert_eq!(
        RollPitchYaw::Zyx.angles(&up),
        Vector3::new(0.0, FRAC_PI_2, 0.0)
    );
    let nan = Vector3::new(f64::NAN, 0.0, 0.0);
    let error = Err(Error::NotFinite { parameter: "rpy" });
    assert_eq!(RollPitchYaw::Zyx.rates_from_omega(&nan), error);
}

/// A double barrel roll in zyx and a double backflip in zxy, sampled as a planner samples them.
#[test]
fn angles_near_unwrap_a_double_roll() {
    for (order, axis, total) in [
        (RollPitchYaw::Zyx, Vector3::x(), 4.0 * PI),
        (RollPitchYaw::Zxy, Vector3::y(), -4.0 * PI),
    ] {
        let tilt = Vector3::new(0.02, -0.03, 0.1);
        let mut hint = Vector3::zeros();
        for i in 0..=200 {
            let turn = axis * (total * f64::from(i) / 200.0);
            hint = order.angles_near(&order.rotation(&(turn + tilt)), &hint);
            assert!((hint - turn - tilt).norm() < 1e-12);
        }
    }
}

proptest! {
    #[test]
    fn matches_products_of_elementary_rotations(rpy in angles()) {
        for order in ORDERS {
            prop_assert!(matrix_error(order.rotation(&rpy).matrix(), product(order, &rpy).matrix()) < 8.0);
        }
    }

    #[test]
    fn angles_near_their_hint(w in rotation_vector(), rpy in angles()) {
        for order in ORDERS {
            let rot = exp(&w);
            let near = order.angles_near(&rot, &rpy);
            prop_assert!(matrix_error(order.rotation(&near).matrix(), rot.matrix()) < 32.0);
            // The angles themselves are a fixed point, away from gimbal lock.
            let middle = if order == RollPitchYaw::Zyx { rpy.y } else { rpy.x };
            if middle.cos().abs() > 1e-3 {
                let same = order.angles_near(&order.rotation(&rpy), &rpy);
                prop_assert!((same - rpy).norm() < 1e-11, "{same} is not {rpy}");
            }
        }
    }

    #[test]
    fn rates_are_the_derivative(rpy in angles(), rates in angles()) {
        for order in ORDERS {
            let h = 1e-5;
            let at = |t: f64| *order.rotation(&(rpy + rates * t)).matrix();
            // Rᵀ Ṙ = hat(ω_b)
            let omega = vee(&(at(0.0).transpose() * (at(h) - at(-h)) / (2.0 * h)));
            let ours = order.omega_from_rates(&rpy) * rates;
            prop_assert!((omega - ours).norm() < 1e-6, "{omega} {ours}");
            if let Ok(inverse) = order.rates_from_omega(&rpy) {
                let condition = inverse.norm();
                prop_assert!((inverse * ours - rates).norm() < 1e-14 * condition * condition);
            }
        }
    }

    #[test]
    fn acceleration_is_the_derivative(rpy in angles(), rates in angles()) {
        for order in ORDERS {
            let h = 1e-5;
            let at = |t: f64| order.omega_from_rates(&(rpy + rates * t)) * rates;
            let difference = (at(h) - at(-h)) / (2.0 * h);
            let ours = order.omega_bias(&rpy, &rates);
            prop_assert!((difference - ours).norm() < 1e-6 * (1.0 + ours.norm()));
        }
    }
}
