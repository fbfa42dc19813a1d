//! The two programs of paper B as they are printed, beside what comes out of them.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, VELOCITY_ROWS, config, crouched, each, snapshot};
use icub_model::{Icub23, LIMITS, MOTORS, SOLES, profile};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::{
    Axes, CentroidalMap, ComJacobian, Configuration, FrameJacobian, Tangent, center_of_mass,
    centroidal_bias, centroidal_map, com_jacobian, frame_jacobian, integrate,
};
use wbc_qp::jump::{
    ComReference, TorqueJump, TorqueJumpSettings, VelocityJump, VelocityJumpSettings,
};
use wbc_qp::{Contact, Snapshot, anchored};

const K: usize = 12;
const V: usize = 35;

/// A crouch on both soles with each joint's velocity.
fn crouch(speeds: &[f64; N]) -> (Configuration<f64, N>, Tangent<f64, N>) {
    crouched(&[0.0; N], speeds)
}

fn contacts() -> [Contact<f64>; 2] {
    SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0))
}

/// A little above where it is, and rising.
fn wanted(s: &Snapshot<f64, N>) -> ComReference<f64> {
    ComReference {
        position_w: s.com_w() + Vector3::new(0.0, 0.0, 0.002),
        velocity_w: Vector3::new(0.0, 0.0, 0.05),
        acceleration_w: Vector3::new(0.0, 0.0, 1.0),
    }
}

/// Linear velocity of the centre of mass, world axes.
fn com_rate(s: &Snapshot<f64, N>, v: &Tangent<f64, N>) -> Vector3<f64> {
    let mut jac = ComJacobian::ZERO;
    com_jacobian(&Icub23, &s.posture, &mut jac);
    jac.mul(v)
}

/// A ν, world axes about the centre of mass.
fn angular_momentum(s: &Snapshot<f64, N>, v: &Tangent<f64, N>) -> Vector3<f64> {
    let mut map = CentroidalMap::ZERO;
    centroidal_map(&Icub23, &s.posture, &mut map);
    map.momentum(v).angular
}

/// (3b) to (3e) hold in every tick, and the momentum follows its integral as (4) says.
#[test]
fn velocity_control() {
    let settings = profile::VELOCITY;
    let mut controller =
        VelocityJump::<f64, N, 29, VELOCITY_ROWS>::new(settings, crouch(&[0.0; N]).0.joints);
    let (mut q, mut v) = crouch(&[0.0; N]);
    let (mut integral, dt) = (Vector3::zeros(), 1e-3);
    for k in 0..100 {
        let s = snapshot(&q, &v);
        let goal = wanted(&s);
        integral += s.momentum_w.angular * dt;
        let tick = controller
            .tick(&Icub23, &s, &contacts(), &LIMITS, &goal, dt)
            .unwrap();
        // (3c): the left sole rests by construction, the right one because the program says so.
        let foot = s.kinematics.frame(&SOLES[0].frame);
        let (_, moving) = anchored(&Icub23, &q.joints, &tick.velocities, &SOLES[0].frame, &foot);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(
            &Icub23,
            &s.kinematics,
            &SOLES[1].frame,
            Axes::Local,
            &mut jac,
        );
        let slip = jac
            .mul(&moving)
            .to_array()
            .into_iter()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        assert!(slip < 1e-8, "tick {k}: {slip}");
        // (3b)
        let target = goal.velocity_w + (goal.position_w - s.com_w()) * settings.com_gain;
        let com = (com_rate(&s, &moving) - target).amax();
        assert!(com < 1e-3, "tick {k}: {com} m/s");
        // (3d)
        let momentum = angular_momentum(&s, &moving) + integral * settings.momentum_gain;
        assert!(momentum.amax() < 1e-3, "tick {k}: {momentum}");
        // (3e)
        for (speed, limit) in tick.velocities.iter().zip(&LIMITS) {
            assert!(speed.abs() <= limit.speed + 1e-9);
        }
        q = integrate(&q, &(moving * dt));
        v = moving;
    }
}

/// (6b) to (6f) hold, with (6d) written as in (5): Ḣ_ω = −K H_ω.
#[test]
fn torque_control() {
    let speeds = prop_oneof![7 => prop::array::uniform(-0.02..0.02_f64), 1 => Just([0.0; N])];
    each(config(30, 3), &speeds, |speeds| {
        let (q, v) = crouch(&speeds);
        let s = snapshot(&q, &v);
        let goal = wanted(&s);
        let settings = profile::TORQUE;
        let mut controller = TorqueJump::<f64, N, K, V, M>::new(settings, q.joints);
        let tick = controller
            .tick(&Icub23, &s, &contacts(), (&LIMITS, &MOTORS), &goal, 1e-3)
            .unwrap();
        let a = &tick.answer.acceleration;
        // ν̇ with the bias: rates of momentum and of its linear part.
        let bias = centroidal_bias(&Icub23, &s.posture, &v);
        let mass = center_of_mass(&Icub23, &s.posture).mass;
        // (6b)
        let rise = com_rate(&s, a) + bias.linear / mass;
        let target = goal.acceleration_w
            + (goal.velocity_w - com_rate(&s, &v)) * settings.com.damping
            + (goal.position_w - s.com_w()) * settings.com.stiffness;
        assert!((rise - target).amax() < 0.02, "{rise}, not {target}");
        // (6d)
        let decay = angular_momentum(&s, a) + bias.angular;
        let rate = -angular_momentum(&s, &v) * settings.momentum_gain;
        assert!((decay - rate).amax() < 0.02, "{decay}, not {rate}");
        // (6e)
        for (tau, motor) in tick.answer.torques.iter().zip(&MOTORS) {
            assert!(tau.abs() <= motor.torque + 1e-6);
        }
        // (6c), (6f): the program's own measure of both, and the forces carry the robot.
        assert!(tick.answer.contact_violation < 1e-6);
        for (contact, f) in contacts().iter().zip(tick.answer.forces.chunks(6)) {
            let mut k = 0;
            while let Some(row) = contact.cone(k) {
                let value: f64 = row.iter().zip(f).map(|(r, f)| r * f).sum();
                assert!(value < 1e-6, "row {k}: {value}");
                k += 1;
            }
        }
    });
}

/// Without weight (6d) is left out where it would be held, too: how fast angular momentum should fall is no matter then, and with
/// any weight it falls as fast as it should.
#[test]
fn without_weight_the_momentum_is_not_held() {
    let (q, v) = crouch(&core::array::from_fn(|i| 0.02 * (i as f64 - 11.0)));
    let s = snapshot(&q, &v);
    let bias = centroidal_bias(&Icub23, &s.posture, &v).angular;
    let momentum = angular_momentum(&s, &v);
    assert!(momentum.norm() > 0.01, "{momentum}");
    let tick = |momentum_weight: f64, momentum_gain: f64| {
        let settings = TorqueJumpSettings {
            strict: true,
            momentum_weight,
            momentum_gain,
            ..profile::TORQUE
        };
        let mut controller = TorqueJump::<f64, N, K, V, M>::new(settings, q.joints);
        let joints = (&LIMITS, &MOTORS);
        let tick = controller.tick(&Icub23, &s, &contacts(), joints, &wanted(&s), 1e-3);
        let acceleration = tick.unwrap().answer.acceleration;
        angular_momentum(&s, &acceleration) + bias
    };
    assert_eq!(tick(0.0, 1.0), tick(0.0, 10.0));
    for gain in [1.0, 10.0] {
        let missed = tick(1.0, gain) + momentum * gain;
        assert!(missed.amax() < 1e-6, "{missed}");
    }
}

/// (3a): where nothing else is asked for, joints go to the posture and stay near the last velocities, by Λ and Δ.
#[test]
fn posture_of_the_velocity_program() {
    let (q, v) = crouch(&[0.0; N]);
    let s = snapshot(&q, &v);
    let settings = VelocityJumpSettings {
        com_weight: 0.0,
        momentum_weight: 0.0,
        ..profile::VELOCITY
    };
    let posture = core::array::from_fn(|i| q.joints[i] + 0.002 * (i as f64 - 11.0));
    let mut controller = VelocityJump::<f64, N, 29, VELOCITY_ROWS>::new(settings, posture);
    let mut last = [0.0; N];
    for _ in 0..3 {
        let tick = controller
            .tick(&Icub23, &s, &[], &LIMITS, &wanted(&s), 1e-3)
            .unwrap();
        for i in 0..N {
            let [near, slow] = [settings.posture_weight[i], settings.continuity_weight[i]];
            let goal = settings.posture_gain * (posture[i] - q.joints[i]);
            let best = (near * goal + slow * last[i]) / (near + slow);
            let found = tick.velocities[i];
            assert!(
                (found - best).abs() < 1e-9,
                "joint {i}: {found}, not {best}"
            );
        }
        last = tick.velocities;
    }
}

/// (6a): where nothing else is asked for, s̈ = −K_p (s − s_d) − K_d ṡ.
#[test]
fn posture_of_the_torque_program() {
    let (q, v) = crouch(&core::array::from_fn(|i| 0.01 * (i as f64 - 11.0)));
    let s = snapshot(&q, &v);
    let settings = TorqueJumpSettings {
        com_weight: 0.0,
        momentum_weight: 0.0,
        ..profile::TORQUE
    };
    let posture = core::array::from_fn(|i| q.joints[i] + 0.001 * (i as f64 - 11.0));
    let mut controller = TorqueJump::<f64, N, 0, 23, 29>::new(settings, posture);
    let tick = controller
        .tick(&Icub23, &s, &[], (&LIMITS, &MOTORS), &wanted(&s), 1e-3)
        .unwrap();
    let gains = settings.posture;
    for (i, goal) in posture.iter().enumerate() {
        let wanted = gains.stiffness * (goal - q.joints[i]) - gains.damping * v.joints[i];
        let found = tick.answer.acceleration.joints[i];
        assert!(
            (found - wanted).abs() < 1e-6,
            "joint {i}: {found}, not {wanted}"
        );
    }
}
