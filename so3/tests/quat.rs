//! Quaternions: round trips, storage orders, exp and log, slerp, bad input.

use crate::cases::{matrix_error, rotation_vector, rotation_vectors, to_f64};
use proptest::prelude::*;
use so3::nalgebra::Quaternion;
use so3::{Error, Geodesic, Rotation3, Scalar, UnitQuaternion, Vector3, exp, log, quat};
use so3::{Matrix3, orthogonality_defect};

fn round_trip<T: Scalar>() -> f64 {
    rotation_vectors::<T>()
        .iter()
        .map(exp)
        .fold(0.0, |worst, rot| {
            let q = quat::from_rotation(&rot);
            assert!(q.w >= T::ZERO, "w is not negative");
            let length = (q.norm_squared() - T::ONE).to_f64().abs() / T::EPSILON.to_f64();
            f64::max(
                worst,
                matrix_error(quat::to_rotation(&q).matrix(), rot.matrix()),
            )
            .max(length)
        })
}

#[test]
fn quaternion_round_trip() {
    for worst in [round_trip::<f64>(), round_trip::<f32>()] {
        println!("matrix -> quaternion -> matrix: {worst} ε");
        assert!(worst <= 8.0);
    }
}

/// A quarter turn about z, written down by hand in every order.
#[test]
fn storage_orders() {
    let h = core::f64::consts::FRAC_1_SQRT_2;
    let quarter =
        Rotation3::from_matrix_unchecked(Matrix3::new(0., -1., 0., 1., 0., 0., 0., 0., 1.));
    let q = quat::from_rotation(&quarter);
    for (ours, hand) in quat::to_xyzw(&q).iter().zip([0.0, 0.0, h, h]) {
        assert!((ours - hand).abs() < 1e-15);
    }
    for (ours, hand) in quat::to_wxyz(&q).iter().zip([h, 0.0, 0.0, h]) {
        assert!((ours - hand).abs() < 1e-15);
    }
    // MuJoCo's and Unitree's identity is (1, 0, 0, 0).
    assert_eq!(
        quat::from_wxyz([1.0, 0.0, 0.0, 0.0]).unwrap(),
        UnitQuaternion::identity()
    );
    assert_eq!(
        quat::from_xyzw([0.0, 0.0, 0.0, 1.0_f32]).unwrap(),
        UnitQuaternion::identity()
    );
    // A quarter turn about x brings y to z: (w, x, y, z) = (h, h, 0, 0).
    let q = quat::from_wxyz([h, h, 0.0, 0.0]).unwrap();
    assert!((quat::to_rotation(&q) * Vector3::y() - Vector3::z()).norm() < 1e-15);
}

#[test]
fn bad_quaternions_are_refused() {
    assert_eq!(quat::from_xyzw([0.0_f64; 4]), Err(Error::ZeroQuaternion));
    assert_eq!(quat::from_wxyz([1e-9_f32; 4]), Err(Error::ZeroQuaternion));
    for bad in [f64::NAN, f64::INFINITY] {
        let error = quat::from_xyzw([0.0, bad, 0.0, 1.0]).unwrap_err();
        assert_eq!(
            error,
            Error::NotFinite {
                parameter: "quaternion"
            }
        );
        assert!(error.to_string().contains("quaternion"));
    }
    // Long ones are normalised, even where their squares overflow.
    let q = quat::from_xyzw([0.0, 0.0, 3e200_f64, 4e200]).unwrap();
    assert!((q.k - 0.6).abs() < 1e-15 && (q.w - 0.8).abs() < 1e-15);
    let q = quat::from_rotation(&Rotation3::from_matrix_unchecked(Matrix3::repeat(f64::NAN)));
    assert!(q.w.is_nan());
}

/// Whether the logarithm of a quaternion `factor` times as long as the unit one of `w` is the unit one's, bit for bit.
fn keeps_its_log<T: Scalar>(w: &Vector3<f64>, factor: f64) -> bool {
    let unit = quat::exp(&w.map(T::of));
    let scaled = UnitQuaternion::new_unchecked(unit.into_inner() * T::of(factor));
    to_f64(&quat::log(&scaled)) == to_f64(&quat::log(&unit))
}

proptest! {
    /// A quaternion's length says nothing of its rotation: times a power of two, which rounds nothing, it has the same logarithm, bit for bit.
    #[test]
    fn a_longer_or_shorter_quaternion_has_the_same_log(w in rotation_vector(), base in prop_oneof![Just(2.0), Just(0.5_f64)], power in 0..=32_u32) {
        let factor = so3::math::powi(base, power);
        prop_assert!(keeps_its_log::<f64>(&w, factor) && keeps_its_log::<f32>(&w, factor));
    }

    #[test]
    fn quaternion_exp_and_log(w in rotation_vector(), turns in -3..=3_i32) {
        let rot = exp(&w);
        prop_assert!(matrix_error(quat::to_rotation(&quat::exp(&w)).matrix(), rot.matrix()) < 8.0);
        prop_assert!((quat::log(&quat::exp(&w)) - w).norm() < 1e-14
            || w.norm() > core::f64::consts::PI - 1e-14);
        let minus = UnitQuaternion::new_unchecked(-quat::exp(&w).into_inner());
        prop_assert!((quat::log(&minus) - quat::log(&quat::exp(&w))).norm() < 1e-14);
        // Many turns: the same rotation.
        prop_assume!(w.norm() > 1e-3);
        let wound = w * (1.0 + f64::from(turns) * core::f64::consts::TAU / w.norm());
        prop_assert!(matrix_error(quat::to_rotation(&quat::exp(&wound)).matrix(), rot.matrix()) < 256.0);
    }

    #[test]
    fn products_agree(u in rotation_vector(), v in rotation_vector()) {
        let product = quat::exp(&u) * quat::exp(&v);
        prop_assert!(matrix_error(quat::to_rotation(&product).matrix(), (exp(&u) * exp(&v)).matrix()) < 16.0);
    }

    #[test]
    fn slerp_is_the_geodesic(u in rotation_vector(), v in rotation_vector(), f in -0.5..1.5_f64) {
        let (start, end) = (exp(&u), exp(&v));
        // At half a turn both ways are shortest.
        prop_assume!(log(&(start.transpose() * end)).norm() < 3.1);
        let ours = quat::slerp(&quat::from_rotation(&start), &quat::from_rotation(&end), f);
        let path = Geodesic::shortest(&start, &end).at(f);
        prop_assert!(matrix_error(quat::to_rotation(&ours).matrix(), path.matrix()) < 64.0);
    }

    #[test]
    fn drifted_quaternions_give_rotations(w in rotation_vector(), scale in 0.5..2.0_f64) {
        let drifted = UnitQuaternion::new_unchecked(Quaternion::from(quat::exp(&w).coords * scale));
        let rot = quat::to_rotation(&drifted);
        prop_assert!(orthogonality_defect(rot.matrix()) < 8.0 * f64::EPSILON);
        prop_assert!(matrix_error(rot.matrix(), exp(&w).matrix()) < 8.0);
    }
}
