//! One test for each line of CONVENTIONS.md.

use a1_model::{A1, A1Reference};
use icub_model::Icub23;
use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    Axes, Configuration, Effort, Force, FrameJacobian, Kinematics, Model, Motion, Posture, Tangent,
    Transform, aba, center_of_mass, centroidal_map, forward_kinematics, frame_jacobian, integrate,
    rnea,
};
use so3::quat;

const CROUCH: [f64; 12] = [
    0.0, 0.9, -1.8, 0.0, 0.9, -1.8, 0.0, 0.9, -1.8, 0.0, 0.9, -1.8,
];

fn quarter_turn_about_z() -> Rotation3<f64> {
    so3::exp(&Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2))
}

#[test]
fn world_z_is_up_and_gravity_pulls_down() {
    assert_eq!(rbd_core::GRAVITY, [0.0, 0.0, -9.81]);
    let posture = Posture::new(&A1, &Configuration::NEUTRAL);
    let mut ws = rbd_core::AbaWorkspace::new();
    let fall = aba(&A1, &posture, &Tangent::ZERO, &Effort::ZERO, &mut ws);
    assert!((fall.base.linear - Vector3::new(0.0, 0.0, -9.81)).norm() < 1e-12);
    // Holding the robot takes its weight upwards.
    let hold = rnea(&A1, &posture, &Tangent::ZERO, &Tangent::ZERO);
    assert!(hold.base.linear.z > 0.0);
}

#[test]
fn rotations_are_active_and_map_base_to_world() {
    let rot_wb = quarter_turn_about_z();
    assert!((rot_wb * Vector3::x() - Vector3::y()).norm() < 1e-15);
}

#[test]
fn six_vectors_are_linear_first() {
    let motion = Motion::from_array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(motion.linear, Vector3::new(1.0, 2.0, 3.0));
    let force = Force::from_array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(force.angular, Vector3::new(4.0, 5.0, 6.0));
    assert_eq!(Tangent::<f64, 2>::unit(0).base.linear, Vector3::x());
    assert_eq!(Tangent::<f64, 2>::unit(6).joints, [1.0, 0.0]);
}

#[test]
fn quaternions_are_x_y_z_w_at_the_edge() {
    let half = core::f64::consts::FRAC_1_SQRT_2;
    let q = quat::from_xyzw([0.0, 0.0, half, half]).unwrap();
    assert!((quat::to_rotation(&q).matrix() - quarter_turn_about_z().matrix()).norm() < 1e-15);
    assert_eq!(quat::to_wxyz(&q)[0], quat::to_xyzw(&q)[3]);
}

#[test]
fn base_velocity_is_in_base_axes() {
    let base = Transform::new(quarter_turn_about_z(), Vector3::zeros());
    let q = Configuration::<f64, 12> {
        base,
        joints: CROUCH,
    };
    let forward = Tangent {
        base: Motion::new(Vector3::x(), Vector3::zeros()),
        ..Tangent::ZERO
    };
    // The base's x axis is the world's y axis.
    let moved = integrate(&q, &(forward * 0.1));
    assert!((moved.base.translation - Vector3::new(0.0, 0.1, 0.0)).norm() < 1e-15);
}

#[test]
fn efforts_on_the_base_are_in_base_axes_about_its_origin() {
    let base = Transform::new(quarter_turn_about_z(), Vector3::new(5.0, 0.0, 0.0));
    let posture = Posture::new(
        &A1,
        &Configuration {
            base,
            joints: CROUCH,
        },
    );
    let push = Effort {
        base: Force::from_array([100.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ..Effort::ZERO
    };
    let mut ws = rbd_core::AbaWorkspace::new();
    let free = aba(&A1, &posture, &Tangent::ZERO, &Effort::ZERO, &mut ws);
    let pushed = aba(&A1, &posture, &Tangent::ZERO, &push, &mut ws);
    let mut map = rbd_core::CentroidalMap::ZERO;
    centroidal_map(&A1, &posture, &mut map);
    let gain = map.momentum(&(pushed - free)).linear;
    assert!(
        (gain - Vector3::new(0.0, 100.0, 0.0)).norm() < 1e-9,
        "{gain}"
    );
}

#[test]
fn jacobians_are_local_world_aligned_by_default() {
    assert_eq!(Axes::default(), Axes::LocalWorldAligned);
    let base = Transform::new(quarter_turn_about_z(), Vector3::zeros());
    let posture = Posture::new(
        &A1,
        &Configuration {
            base,
            joints: CROUCH,
        },
    );
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(&A1, &posture, &mut kinematics);
    let foot = Model::<f64, 12>::frame(&A1, "FL_foot").unwrap();
    let mut jacobian = FrameJacobian::ZERO;
    frame_jacobian(&A1, &kinematics, &foot, Axes::default(), &mut jacobian);
    // Base forward is world y.
    assert!((jacobian.base[0].linear - Vector3::y()).norm() < 1e-15);
}

#[test]
fn a1_legs_are_fl_fr_rl_rr_and_joints_hip_thigh_calf() {
    let names = Model::<f64, 12>::joint_names(&A1);
    for (leg, names) in ["FL", "FR", "RL", "RR"].into_iter().zip(names.chunks(3)) {
        for (joint, name) in ["hip", "thigh", "calf"].into_iter().zip(names) {
            assert_eq!(*name, format!("{leg}_{joint}_joint"));
        }
    }
    // Left is +y, front is +x.
    let mut kinematics = Kinematics::IDENTITY;
    let q = Configuration {
        joints: CROUCH,
        ..Configuration::NEUTRAL
    };
    forward_kinematics(&A1, &Posture::<f64, 12>::new(&A1, &q), &mut kinematics);
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    for (leg, (front, left)) in ["FL", "FR", "RL", "RR"].into_iter().zip(signs) {
        let foot = Model::<f64, 12>::frame(&A1, &format!("{leg}_foot")).unwrap();
        let pos = kinematics.frame(&foot).translation;
        assert!(pos.x * front > 0.0 && pos.y * left > 0.0 && pos.z < 0.0);
    }
}

#[test]
fn icub_is_legs_torso_arms_and_its_root_looks_backwards() {
    let names = Model::<f64, 23>::joint_names(&Icub23);
    let starts = ["l_hip", "r_hip", "torso", "l_shoulder", "r_shoulder"];
    for (first, start) in [0, 6, 12, 15, 19].into_iter().zip(starts) {
        assert!(
            names[first].starts_with(start),
            "{} at {first}",
            names[first]
        );
    }
    let mut kinematics = Kinematics::IDENTITY;
    let posture = Posture::<f64, 23>::new(&Icub23, &Configuration::NEUTRAL);
    forward_kinematics(&Icub23, &posture, &mut kinematics);
    let sole = kinematics.frame(&Model::<f64, 23>::frame(&Icub23, "l_sole").unwrap());
    // The sole's x axis points forward, the root's backwards; left is at negative y of the root.
    assert!((sole.rotation * Vector3::x() + Vector3::x()).norm() < 1e-6);
    assert!(sole.translation.y < 0.0);
}

#[test]
fn parameter_sets_are_different_robots() {
    let q = Configuration::<f64, 12>::NEUTRAL;
    let published = center_of_mass(&A1, &Posture::new(&A1, &q)).mass;
    let reference = center_of_mass(&A1Reference, &Posture::new(&A1Reference, &q)).mass;
    assert!((published - 13.741).abs() < 5e-4, "{published}");
    assert!((reference - 12.453).abs() < 5e-4, "{reference}");
}
