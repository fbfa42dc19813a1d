//! Configurations form a manifold, and the algorithms live on it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, masked, model, state};
use proptest::prelude::*;
use rbd_core::{
    Axes, BodyMotions, Configuration, Frame, FrameJacobian, Kinematics, Link, MassMatrix, Posture,
    Tangent, Tree, centroidal_momentum_rate, centroidal_state, crba, difference,
    forward_accelerations, forward_kinematics, frame_jacobian, generalized_gravity, integrate,
    interpolate, rnea,
};

const H: f64 = 1e-5;

/// The robot `t` seconds later, on a path with this velocity and acceleration now.
fn later(
    q: &Configuration<f64, CAP>,
    v: &Tangent<f64, CAP>,
    a: &Tangent<f64, CAP>,
    t: f64,
) -> (Configuration<f64, CAP>, Tangent<f64, CAP>) {
    (integrate(q, &(*v * t + *a * (0.5 * t * t))), *v + *a * t)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn difference_inverts_integrate((q, [v, _]) in state(), fraction in -0.5..1.5f64) {
        let d = v * 0.4;
        let there = integrate(&q, &d);
        let back = difference(&q, &there);
        for i in 0..6 + CAP {
            prop_assert!((back.coordinate(i) - d.coordinate(i)).abs() < 1e-12);
        }
        let between = interpolate(&q, &there, fraction);
        let part = difference(&q, &between);
        for i in 0..6 + CAP {
            prop_assert!((part.coordinate(i) - fraction * d.coordinate(i)).abs() < 1e-12);
        }
    }

    #[test]
    fn power_flows_into_energy(model in model(), (q, [v, a]) in state()) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let energy = |t: f64| {
            let (q, v) = later(&q, &v, &a, t);
            let state = centroidal_state(&model, &Posture::new(&model, &q), &v);
            (state.kinetic_energy, state.potential_energy)
        };
        let (after, before) = (energy(H), energy(-H));
        let posture = Posture::new(&model, &q);
        let tau = rnea(&model, &posture, &v, &a);
        let gravity = generalized_gravity(&model, &posture);
        let size = energy(0.0).0.max(10.0);
        let potential = (after.1 - before.1) / (2.0 * H);
        prop_assert!((potential - v.dot(&gravity)).abs() <= 1e-5 * size.max(potential.abs()));
        let total = (after.0 + after.1 - before.0 - before.1) / (2.0 * H);
        let power = v.dot(&tau);
        prop_assert!((total - power).abs() <= 1e-5 * size.max(power.abs()), "{total} {power}");
    }

    #[test]
    fn momentum_changes_at_its_rate(model in model(), (q, [v, a]) in state()) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let momentum = |t: f64| {
            let (q, v) = later(&q, &v, &a, t);
            centroidal_state(&model, &Posture::new(&model, &q), &v).momentum_w
        };
        let difference = (momentum(H) - momentum(-H)) * (0.5 / H);
        let rate = centroidal_momentum_rate(&model, &Posture::new(&model, &q), &v, &a);
        let size = rate.to_array().into_iter().map(f64::abs).fold(10.0, f64::max);
        for (x, y) in difference.to_array().into_iter().zip(rate.to_array()) {
            prop_assert!((x - y).abs() <= 1e-5 * size, "{x} {y}");
        }
    }

    #[test]
    fn frames_move_as_kinematics_says(model in model(), (q, [v, a]) in state(), link in 0..CAP) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let frame = Frame { link, offset: [0.1, -0.2, 0.05], rotation };
        let pose = |t: f64| {
            let (q, _) = later(&q, &v, &a, t);
            let mut kinematics = Kinematics::IDENTITY;
            forward_kinematics(&model, &Posture::new(&model, &q), &mut kinematics);
            (kinematics.frame(&frame), kinematics)
        };
        let (now, kinematics) = pose(0.0);
        let mut motions = BodyMotions::ZERO;
        forward_accelerations(&model, &Posture::new(&model, &q), &v, &a, &mut motions);
        let velocity = now.rotation * motions.frame_velocity(&frame).linear;
        let moved = (pose(H).0.translation - pose(-H).0.translation) / (2.0 * H);
        prop_assert!((moved - velocity).norm() <= 1e-5 * velocity.norm().max(10.0));
        let turned = so3::log(&(pose(-H).0.rotation.transpose() * pose(H).0.rotation)) / (2.0 * H);
        let omega = motions.frame_velocity(&frame).angular;
        prop_assert!((turned - omega).norm() <= 1e-5 * omega.norm().max(10.0));
        let mut jacobian = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::LocalWorldAligned, &mut jacobian);
        prop_assert!((jacobian.mul(&v).linear - velocity).norm() <= 1e-9 * velocity.norm().max(1.0));
        // The classical acceleration is the second difference of the position.
        let acceleration = now.rotation * motions.frame_classical_acceleration(&frame).linear;
        let h = 1e-4;
        let second =
            (pose(h).0.translation + pose(-h).0.translation - now.translation * 2.0) / (h * h);
        prop_assert!((second - acceleration).norm() <= 1e-4 * acceleration.norm().max(50.0));
    }

    #[test]
    fn a_change_of_world_frame_changes_no_joint_torque(model in model(), (q, [v, a]) in state(), yaw in -3.0..3.0f64) {
        // A shift and a turn about the vertical leave gravity as it is.
        let (v, a) = (masked(&model, v), masked(&model, a));
        let turn = so3::exp(&nalgebra::Vector3::new(0.0, 0.0, yaw));
        let shift = rbd_core::Transform::new(turn, nalgebra::Vector3::new(1.0, -2.0, 3.0));
        let moved = Configuration { base: shift.compose(&q.base), ..q };
        let tau = rnea(&model, &Posture::new(&model, &q), &v, &a);
        let same = rnea(&model, &Posture::new(&model, &moved), &v, &a);
        let size = (0..6 + CAP).map(|i| tau.coordinate(i).abs()).fold(1.0, f64::max);
        for i in 0..6 + CAP {
            prop_assert!((tau.coordinate(i) - same.coordinate(i)).abs() <= 1e-11 * size);
        }
        let (mut m, mut n) = (MassMatrix::ZERO, MassMatrix::ZERO);
        crba(&model, &Posture::new(&model, &q), &mut m);
        crba(&model, &Posture::new(&model, &moved), &mut n);
        prop_assert_eq!(m, n);
    }
}
