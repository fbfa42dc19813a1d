//! Conversions: each goes back to where it came from, and means what it says.

use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::convert::{
    acceleration_from_mixed, acceleration_from_mujoco, acceleration_to_mixed,
    acceleration_to_mujoco, base_from_mujoco, base_from_pinocchio, base_to_mujoco,
    base_to_pinocchio, force_from_mixed, force_from_mujoco, force_to_mixed, force_to_mujoco,
    order_by_names, pose_from_com, pose_to_com, reordered, swap_unitree_joints, swap_unitree_legs,
    velocity_from_com, velocity_from_mixed, velocity_from_mujoco, velocity_to_com,
    velocity_to_mixed, velocity_to_mujoco,
};
use rbd_core::hardware::motors_f32;
use rbd_core::model::{frames_f32, limits_f32};
use rbd_core::{Force, Frame, JointLimits, Link, Motion, Motor, Shape, Transform};

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    proptest::array::uniform3(-2.0..2.0_f64).prop_map(Vector3::from)
}

fn pose() -> impl Strategy<Value = Transform<f64>> {
    (vector(), vector()).prop_map(|(w, p)| Transform::new(so3::exp(&(w * 1.5)), p))
}

fn motion() -> impl Strategy<Value = Motion<f64>> {
    (vector(), vector()).prop_map(|(linear, angular)| Motion { linear, angular })
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

fn distance(a: &Transform<f64>, b: &Transform<f64>) -> f64 {
    let turned = (a.rotation.matrix() - b.rotation.matrix()).amax();
    turned.max((a.translation - b.translation).amax())
}

/// Rounded, a number moves by half of the last digit at most.
fn nearest(double: &[f64], single: &[f32]) -> Result<(), TestCaseError> {
    prop_assert_eq!(double.len(), single.len());
    for (&x, &y) in double.iter().zip(single) {
        let off = (f64::from(y) - x).abs();
        prop_assert!(off <= x.abs() * f64::from(f32::EPSILON) / 2.0, "{x} {y}");
    }
    Ok(())
}

/// The base a moment later: it moves with `velocity`, which changes by `acceleration`.
fn later(base: &Transform<f64>, velocity: &Motion<f64>, dt: f64) -> Transform<f64> {
    Transform::new(
        base.rotation * so3::exp(&(velocity.angular * dt)),
        base.translation + base.rotation * velocity.linear * dt,
    )
}

proptest! {
    #[test]
    fn positions_go_there_and_back(base in pose()) {
        prop_assert!(distance(&base, &base_from_pinocchio(&base_to_pinocchio(&base)).unwrap()) < 1e-14);
        prop_assert!(distance(&base, &base_from_mujoco(&base_to_mujoco(&base)).unwrap()) < 1e-14);
        let [px, py, pz, x, y, z, w] = base_to_pinocchio(&base);
        prop_assert_eq!(base_to_mujoco(&base), [px, py, pz, w, x, y, z]);
        prop_assert!((x * x + y * y + z * z + w * w - 1.0).abs() < 1e-14);
    }

    #[test]
    fn velocities_and_forces_go_there_and_back_and_keep_their_power(
        base in pose(), v in motion(), f in motion(),
    ) {
        let force = Force { linear: f.linear, angular: f.angular };
        let power = v.dot(&force);
        let qvel = velocity_to_mujoco(&base, &v);
        let qfrc = force_to_mujoco(&base, &force);
        prop_assert!(far(&velocity_from_mujoco(&base, &qvel).to_array(), &v.to_array()) < 1e-14);
        prop_assert!(far(&force_from_mujoco(&base, &qfrc).to_array(), &force.to_array()) < 1e-14);
        let theirs: f64 = qvel.iter().zip(&qfrc).map(|(x, y)| x * y).sum();
        prop_assert!((theirs - power).abs() < 1e-12);
        let (mixed, wrench) = (velocity_to_mixed(&base, &v), force_to_mixed(&base, &force));
        prop_assert!(far(&velocity_from_mixed(&base, &mixed).to_array(), &v.to_array()) < 1e-14);
        prop_assert!(far(&force_from_mixed(&base, &wrench).to_array(), &force.to_array()) < 1e-14);
        prop_assert!((mixed.dot(&wrench) - power).abs() < 1e-12);
        // The linear part of both is the world velocity of the origin.
        let moved = later(&base, &v, 1e-7).translation - later(&base, &v, -1e-7).translation;
        prop_assert!((moved / 2e-7 - mixed.linear).amax() < 1e-6);
        prop_assert_eq!(Vector3::new(qvel[0], qvel[1], qvel[2]), mixed.linear);
        // MuJoCo's angular part is in base axes, the mixed one in the world's.
        prop_assert_eq!(Vector3::new(qvel[3], qvel[4], qvel[5]), v.angular);
        prop_assert!((mixed.angular - base.rotation * v.angular).amax() < 1e-15);
    }

    /// Accelerations are the time derivatives of the velocities as the other side writes them.
    #[test]
    fn accelerations_are_derivatives(base in pose(), v in motion(), a in motion()) {
        let h = 1e-6;
        let at = |dt: f64| {
            let moved = later(&base, &Motion {
                linear: v.linear + a.linear * (dt / 2.0),
                angular: v.angular + a.angular * (dt / 2.0),
            }, dt);
            (moved, Motion { linear: v.linear + a.linear * dt, angular: v.angular + a.angular * dt })
        };
        let ((b0, v0), (b1, v1)) = (at(-h), at(h));
        let rate = |x: [f64; 6], y: [f64; 6]| -> Vec<f64> {
            x.iter().zip(y).map(|(x, y)| (y - x) / (2.0 * h)).collect()
        };
        let mujoco = rate(velocity_to_mujoco(&b0, &v0), velocity_to_mujoco(&b1, &v1));
        prop_assert!(far(&acceleration_to_mujoco(&base, &v, &a), &mujoco) < 1e-7);
        let mixed = rate(velocity_to_mixed(&b0, &v0).to_array(), velocity_to_mixed(&b1, &v1).to_array());
        prop_assert!(far(&acceleration_to_mixed(&base, &v, &a).to_array(), &mixed) < 1e-7);
        let back = acceleration_from_mujoco(&base, &v, &acceleration_to_mujoco(&base, &v, &a));
        prop_assert!(far(&back.to_array(), &a.to_array()) < 1e-13);
        let back = acceleration_from_mixed(&base, &v, &acceleration_to_mixed(&base, &v, &a));
        prop_assert!(far(&back.to_array(), &a.to_array()) < 1e-13);
    }

    /// A table in single precision holds, entry by entry, the number nearest to that in double precision.
    #[test]
    fn tables_in_single_precision_hold_the_nearest_numbers(x in proptest::collection::vec(-5.0..5.0_f64, 15)) {
        let limits: [_; 3] = core::array::from_fn(|i| JointLimits {
            lower: x[i], upper: x[i + 1], speed: x[i + 2], effort: x[i + 3], damping: x[i + 4], friction: x[i + 5],
        });
        for (a, b) in limits.iter().zip(limits_f32(&limits)) {
            nearest(
                &[a.lower, a.upper, a.speed, a.effort, a.damping, a.friction],
                &[b.lower, b.upper, b.speed, b.effort, b.damping, b.friction],
            )?;
        }
        let motors: [_; 3] = core::array::from_fn(|i| Motor {
            gear: x[i], torque: x[i + 1], corner_speed: x[i + 2], no_load_speed: x[i + 3], rotor_inertia: x[i + 4],
        });
        for (a, b) in motors.iter().zip(motors_f32(&motors)) {
            nearest(
                &[a.gear, a.torque, a.corner_speed, a.no_load_speed, a.rotor_inertia],
                &[b.gear, b.torque, b.corner_speed, b.no_load_speed, b.rotor_inertia],
            )?;
        }
        let row = |i: usize| [x[i], x[i + 1], x[i + 2]];
        let frames: [_; 3] = core::array::from_fn(|i| Frame {
            link: Link::Joint(i), offset: row(i), rotation: [row(i + 3), row(i + 6), row(i + 9)],
        });
        for (a, b) in frames.iter().zip(frames_f32(&frames)) {
            prop_assert_eq!(a.link, b.link);
            nearest(&a.offset, &b.offset)?;
            nearest(a.rotation.as_flattened(), b.rotation.as_flattened())?;
        }
        let link = Link::Joint(2);
        let shape = Shape { link, from: row(0), to: row(3), radius: x[6], owner: 4 };
        let single = shape.to_f32();
        prop_assert_eq!((single.link, single.owner), (link, 4));
        nearest(&[row(0), row(3), row(6)].as_flattened()[..7], &[single.from, single.to, [single.radius; 3]].as_flattened()[..7])?;
    }

    /// The CoM's velocity is the derivative of the CoM's position.
    #[test]
    fn com_coordinates(base in pose(), v in motion(), com in vector(), rate in vector()) {
        let body = pose_to_com(&base, &com);
        prop_assert!(distance(&pose_from_com(&body, &com), &base) < 1e-14);
        let about_com = velocity_to_com(&v, &com, &rate);
        prop_assert!(far(&velocity_from_com(&about_com, &com, &rate).to_array(), &v.to_array()) < 1e-14);
        let h = 1e-6;
        let at = |dt: f64| pose_to_com(&later(&base, &v, dt), &(com + rate * dt)).translation;
        let measured = (at(h) - at(-h)) / (2.0 * h);
        prop_assert!((base.rotation * about_com.linear - measured).amax() < 1e-7);
    }
}

#[test]
fn bad_quaternions_are_errors() {
    assert!(base_from_pinocchio(&[0.0; 7]).is_err());
    assert!(base_from_mujoco(&[0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0, 1.0]).is_err());
}

#[test]
fn unitree_names_its_right_legs_first() {
    assert_eq!(
        swap_unitree_legs(["FL", "FR", "RL", "RR"]),
        ["FR", "FL", "RR", "RL"]
    );
    let ours = [
        "FL_hip", "FL_thigh", "FL_calf", "FR_hip", "FR_thigh", "FR_calf", "RL_hip", "RL_thigh",
        "RL_calf", "RR_hip", "RR_thigh", "RR_calf",
    ];
    let theirs = [
        "FR_hip", "FR_thigh", "FR_calf", "FL_hip", "FL_thigh", "FL_calf", "RR_hip", "RR_thigh",
        "RR_calf", "RL_hip", "RL_thigh", "RL_calf",
    ];
    assert_eq!(swap_unitree_joints(ours), theirs);
    assert_eq!(swap_unitree_joints(theirs), ours);
    // By names it is the same permutation.
    let order = order_by_names(&ours, &theirs).unwrap();
    let values: [f64; 12] = core::array::from_fn(|i| i as f64);
    assert_eq!(reordered(&values, &order), swap_unitree_joints(values));
}

#[test]
fn orders_by_names() {
    let order = order_by_names(&["knee", "hip", "neck"], &["hip", "knee"]).unwrap();
    assert_eq!(order, [1, 0]);
    assert_eq!(reordered(&[10.0, 20.0, 30.0], &order), [20.0, 10.0]);
    assert_eq!(order_by_names(&["knee"], &["hip"]), None);
}
