//! Laws that hold for every robot, on random trees of every joint kind.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, Model, close, masked, model, rotation, size, state, vector};
use proptest::prelude::*;
use rbd_core::{
    AbaWorkspace, Axes, BaseBody, BaseKind, Body, BodyMotions, CentroidalMap, ComJacobian,
    Configuration, Effort, Force, Frame, FrameJacobian, Kinematics, Limbs, Link, MassMatrix,
    Motion, Posture, Tangent, aba, bias_accelerations, centroidal_bias, centroidal_map,
    centroidal_momentum_rate, centroidal_state, com_jacobian, com_motion, crba,
    forward_accelerations, forward_kinematics, frame_jacobian, rnea,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn mass_matrix_is_made_of_rnea_columns(model in model(), (q, [v, a]) in state()) {
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        let bias = rnea(&model, &posture, &v, &Tangent::ZERO);
        let full = rnea(&model, &posture, &v, &a);
        let product = m.mul(&a) + bias;
        for i in 0..6 + CAP {
            prop_assert!(close(product.coordinate(i), full.coordinate(i), size(&full)), "row {i}");
        }
    }

    #[test]
    fn aba_inverts_rnea(model in model(), (q, [v, a]) in state()) {
        use rbd_core::Tree;
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let tau = rnea(&model, &posture, &v, &a);
        let mut ws = AbaWorkspace::new();
        let mut back = aba(&model, &posture, &v, &tau, &mut ws);
        if model.base_kind() == BaseKind::Fixed {
            back.base = Motion::ZERO;
        }
        // The acceleration is only as good as the condition of M allows: judge it by its effort.
        let again = rnea(&model, &posture, &v, &back);
        for i in 0..6 + CAP {
            let (x, y) = (again.coordinate(i), tau.coordinate(i));
            prop_assert!((x - y).abs() <= 1e-9 * size(&tau).max(1.0), "row {i}: {x} {y}");
        }
    }

    #[test]
    fn jacobians_carry_velocity_and_force(
        model in model(), (q, [v, a]) in state(), link in 0..2 * CAP, rot in rotation(), arm in vector(0.3),
    ) {
        use rbd_core::Tree;
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &posture, &mut kinematics);
        let mut motions = BodyMotions::ZERO;
        forward_accelerations(&model, &posture, &v, &masked(&model, a), &mut motions);
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let row = |i: usize| [rot.matrix()[(i, 0)], rot.matrix()[(i, 1)], rot.matrix()[(i, 2)]];
        let frame = Frame { link, offset: arm.into(), rotation: [row(0), row(1), row(2)] };
        let pose = kinematics.frame(&frame);
        for axes in [Axes::Local, Axes::LocalWorldAligned, Axes::World] {
            let mut jac = FrameJacobian::ZERO;
            frame_jacobian(&model, &kinematics, &frame, axes, &mut jac);
            let direct = axes.motion(&pose, &motions.frame_velocity(&frame));
            let through = jac.mul(&v);
            for (x, y) in direct.to_array().into_iter().zip(through.to_array()) {
                prop_assert!(close(x, y, 30.0), "{axes:?}: {x} {y}");
            }
            // Power of a wrench is the same on both sides.
            let wrench = Force::new(arm, pose.translation);
            prop_assert!(close(through.dot(&wrench), v.dot(&jac.tr_mul(&wrench)), 100.0));
        }
        // J ν̇ + J̇ν is the acceleration.
        let mut bias = BodyMotions::ZERO;
        bias_accelerations(&model, &posture, &v, &mut bias);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::Local, &mut jac);
        let sum = jac.mul(&masked(&model, a)) + bias.frame_acceleration(&frame);
        for (x, y) in motions.frame_acceleration(&frame).to_array().into_iter().zip(sum.to_array()) {
            prop_assert!(close(x, y, 1e3), "{x} {y}");
        }
    }

    #[test]
    fn ends_of_limbs_are_frames_seen_from_the_base(
        model in model(), (q, [v, _]) in state(), link in 0..2 * CAP, arm in vector(0.3),
    ) {
        use rbd_core::Tree;
        let v = masked(&model, v);
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let frame = Frame { link, offset: arm.into(), ..Frame::IDENTITY };
        let limbs = Limbs::new(&model, &q, &[frame]);
        let (end, rot_wb) = (&limbs.ends[0], &q.base.rotation);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &Posture::new(&model, &q), &mut kinematics);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::LocalWorldAligned, &mut jac);
        let pos_w = q.base.point(&end.position);
        prop_assert!((pos_w - kinematics.frame(&frame).translation).norm() < 1e-12);
        let still = Tangent { base: Motion::ZERO, ..v };
        prop_assert!((rot_wb * end.mul(&v.joints) - jac.mul(&still).linear).norm() < 1e-10);
        let mut torques = v.joints;
        end.add_tr_mul(&(rot_wb.inverse() * arm), &mut torques);
        let through = jac.tr_mul(&Force::new(arm, nalgebra::Vector3::zeros()));
        for ((x, before), y) in torques.iter().zip(v.joints).zip(through.joints) {
            prop_assert!(close(*x, before + y, 10.0), "{x} {before} {y}");
        }
    }

    #[test]
    fn centroidal_quantities_agree(model in model(), (q, [v, a]) in state()) {
        use rbd_core::Tree;
        let (v, a) = (masked(&model, v), masked(&model, a));
        let posture = Posture::new(&model, &q);
        let mut map = CentroidalMap::ZERO;
        centroidal_map(&model, &posture, &mut map);
        let state = centroidal_state(&model, &posture, &v);
        let scale = size(&Effort { base: state.momentum_w, joints: [0.0; CAP] });
        for (x, y) in map.momentum(&v).to_array().into_iter().zip(state.momentum_w.to_array()) {
            prop_assert!(close(x, y, scale), "momentum {x} {y}");
        }
        let mut jac = ComJacobian::ZERO;
        let com = com_jacobian(&model, &posture, &mut jac);
        prop_assert!((com.position_w - state.com_w).norm() < 1e-12);
        prop_assert!((map.com_w - state.com_w).norm() < 1e-12);
        prop_assert!((jac.mul(&v) - state.com_velocity_w).norm() < 1e-10);
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        prop_assert!(close(m.kinetic_energy(&v), state.kinetic_energy, state.kinetic_energy));
        // The rate of momentum is the sum of external forces but gravity.
        let rate = centroidal_momentum_rate(&model, &posture, &v, &a);
        let bias = centroidal_bias(&model, &posture, &v) + map.momentum(&a);
        let tau = rnea(&model, &posture, &v, &a);
        // A fixed base stands in the world: its weight is the ground's, not the robot's.
        let ground = if model.base_kind() == BaseKind::Fixed { model.base().mass } else { 0.0 };
        let weight = (map.mass + ground) * 9.81;
        let force_w = posture.base().rotation * tau.base.linear;
        for (x, y) in rate.to_array().into_iter().zip(bias.to_array()) {
            prop_assert!(close(x, y, size(&tau)), "rate {x} {y}");
        }
        prop_assert!(close(rate.linear.z, force_w.z - weight, size(&tau)));
        let com = com_motion(&model, &posture, &v, &a);
        prop_assert!((com.position_w - state.com_w).norm() < 1e-12);
        prop_assert!((com.velocity_w - state.com_velocity_w).norm() < 1e-10);
        let acceleration = rate.linear / map.mass;
        let near = 1e-10 * acceleration.norm().max(1e3);
        prop_assert!((com.acceleration_w - acceleration).norm() < near, "{}", com.acceleration_w);
        prop_assert!(close(rate.linear.x, force_w.x, size(&tau)));
    }
}

#[test]
fn a_force_on_a_lone_base_obeys_newton() {
    let base = BaseBody {
        mass: 2.0,
        first: [0.0; 3],
        second: [0.01, 0.02, 0.03, 0.0, 0.0, 0.0],
    };
    let row = Body {
        mass: 1e-3,
        second: [1e-9, 1e-9, 1e-9, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let model = Model::new(BaseKind::Floating, base, &[row]).unwrap();
    let posture = Posture::new(&model, &Configuration::NEUTRAL);
    let effort = Effort {
        base: Force::from_array([0.0, 0.0, 4.0, 0.0, 0.0, 0.0]),
        joints: [0.0; CAP],
    };
    let a = aba(
        &model,
        &posture,
        &Tangent::ZERO,
        &effort,
        &mut AbaWorkspace::new(),
    );
    assert!((a.base.linear.z - (4.0 / 2.001 - 9.81)).abs() < 1e-12);
}
