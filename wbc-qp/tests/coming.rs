//! Ground that comes: contacts of part of their load, and the landing on them.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, config, crouch, each, snapshot};
use icub_model::{Icub23, LIMITS, MOTORS, SOLES, profile};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use rbd_core::{integrate, joint_friction};
use wbc_qp::jump::{Absorption, ComReference, Landing, LandingReference, LandingSettings};
use wbc_qp::{Contact, Snapshot, TorqueAnswer, TorqueQp};

const K: usize = 12;
const V: usize = 35;

fn contacts(load: f64) -> [Contact<f64>; 2] {
    SOLES.map(|sole| Contact {
        load,
        ..Contact::new(&sole, 0.5, 1000.0)
    })
}

/// Accelerations of the joints where the contacts are asked for these.
fn corrected(s: &Snapshot<f64, N>, load: f64, by: &[f64; K]) -> [f64; N] {
    let mut qp = TorqueQp::<f64, N, K, V, M>::new();
    let friction = joint_friction(&LIMITS, &s.velocity.joints, 0.1);
    qp.begin(&Icub23, s, &contacts(load), &friction).unwrap();
    qp.correct_contacts(by);
    qp.minimise(&s.com(), &[0.0; 3], &[1e3; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0; K], &[1e-3; K]);
    qp.solve().unwrap().acceleration.joints
}

fn apart(a: &[f64; N], b: &[f64; N]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    so3::math::sqrt(squares.sum::<f64>())
}

/// What is asked of a contact that is nearly all there moves the robot as it does where it is all there.
#[test]
fn a_contact_is_corrected_by_as_much_as_there_is() {
    let by = prop::array::uniform(-1.0..1.0_f64);
    each(config(10, 41), &(crouch(0.1, 0.3), by), |((q, v), by)| {
        let s = snapshot(&q, &v);
        let whole = corrected(&s, 1.0, &by);
        let moved = apart(&whole, &corrected(&s, 1.0, &[0.0; K]));
        let nearly = apart(&corrected(&s, 0.998, &by), &whole);
        assert!(nearly < 0.1 * moved, "{nearly} {moved}");
    });
}

/// To rest with the centre of mass moved from where it is, and the trunk turned from upright.
fn resting(s: &Snapshot<f64, N>, shift: [f64; 3], turn: [f64; 3]) -> LandingReference<f64, N> {
    LandingReference {
        com: ComReference {
            position_w: s.com_w() + Vector3::from(shift),
            velocity_w: Vector3::zeros(),
            acceleration_w: Vector3::zeros(),
        },
        trunk: Rotation3::new(Vector3::from(turn)),
        posture: s.configuration.joints,
        velocity: [0.0; N],
    }
}

/// The first tick of a landing.
fn landed(
    settings: LandingSettings<f64, N>,
    s: &Snapshot<f64, N>,
    load: f64,
    wanted: &LandingReference<f64, N>,
) -> TorqueAnswer<f64, N, K> {
    let mut landing = Landing::<f64, N, K, V, M>::new(settings);
    let limits = (&LIMITS, &MOTORS);
    let tick = landing.tick(&Icub23, s, &contacts(load), limits, wanted);
    tick.unwrap().answer
}

/// On the ground the angular momentum falls at its rate where it counts most.
#[test]
fn angular_momentum_falls_at_its_rate() {
    let cases = (crouch(0.1, 0.3), 1.0..10.0_f64);
    each(config(10, 44), &cases, |((q, v), gain)| {
        let s = snapshot(&q, &v);
        let settings = LandingSettings {
            momentum_gain: gain,
            momentum_weight: 1e7,
            com_weight: 1.0,
            trunk_weight: 1.0,
            ..profile::LANDING
        };
        let answer = landed(settings, &s, 1.0, &resting(&s, [0.0; 3], [0.0; 3]));
        let rate = Vector3::from(s.angular_momentum().reached(&answer.acceleration));
        let wanted = -s.momentum_w.angular * gain;
        assert!(
            (rate - wanted).norm() < 0.01 * (wanted.norm() + 0.1),
            "{rate} {wanted}"
        );
    });
}

/// A tick stays near the torques of the one before; after a restart there was none, and the answer is that of a new controller.
#[test]
fn a_landing_that_starts_again_has_no_memory_of_torques() {
    let cases = (crouch(0.1, 0.3), crouch(0.1, 0.3));
    each(config(4, 46), &cases, |((q0, v0), (q, v))| {
        let (before, now) = (snapshot(&q0, &v0), snapshot(&q, &v));
        let settings = LandingSettings {
            continuity_weight: 1.0,
            ..profile::LANDING
        };
        let tick = |landing: &mut Landing<f64, N, K, V, M>, s: &Snapshot<f64, N>| {
            let wanted = resting(s, [0.0; 3], [0.0; 3]);
            let limits = (&LIMITS, &MOTORS);
            let tick = landing.tick(&Icub23, s, &contacts(1.0), limits, &wanted);
            tick.unwrap().answer.torques
        };
        let fresh = tick(&mut Landing::new(settings), &now);
        let mut landing = Landing::new(settings);
        let first = tick(&mut landing, &before);
        let mut restarted = landing.clone();
        restarted.restart();
        assert!(apart(&tick(&mut restarted, &now), &fresh) < 1e-6);
        let second = tick(&mut landing, &now);
        assert!(apart(&second, &first) < apart(&fresh, &first) - 1e-3);
    });
}

/// In the air nothing is asked of the centre of mass or the trunk; on the ground it is.
#[test]
fn without_ground_the_body_is_left_alone() {
    let places = [-0.1..0.1, -0.1..0.1, -0.1..0.1_f64];
    let turn = [-0.3..0.3, -0.3..0.3, -0.3..0.3_f64];
    let cases = (crouch(0.1, 0.3), places, turn);
    each(config(10, 42), &cases, |((q, v), shift, turn)| {
        let s = snapshot(&q, &v);
        let torques = |load: f64, shift: [f64; 3], turn: [f64; 3]| {
            let wanted = resting(&s, shift, turn);
            landed(profile::LANDING, &s, load, &wanted).torques
        };
        let none = [0.0; 3];
        assert_eq!(torques(0.0, shift, turn), torques(0.0, none, none));
        for load in [0.3, 1.0] {
            let still = torques(load, none, none);
            assert!(apart(&torques(load, shift, none), &still) > 1e-3);
            assert!(apart(&torques(load, none, turn), &still) > 1e-3);
        }
    });
}

/// In the air tilted soles come level within a fall, though the posture to keep is the tilted one and the body turns.
#[test]
fn soles_come_level_in_the_air() {
    let tilts = prop::array::uniform4(0.1..0.25_f64);
    each(
        config(3, 45),
        &(crouch(0.05, 0.3), tilts),
        |((q, v), by)| {
            let (mut q, mut v) = (q, v);
            for (joint, tilt) in [4, 5, 10, 11].into_iter().zip(by) {
                q.joints[joint] += tilt;
            }
            let wanted = resting(&snapshot(&q, &v), [0.0; 3], [0.0; 3]);
            let tilt = |s: &Snapshot<f64, N>| {
                SOLES.map(|sole| {
                    let normal = s.pose(&sole.frame).rotation * Vector3::z();
                    normal.cross(&Vector3::z()).norm()
                })
            };
            let before = tilt(&snapshot(&q, &v));
            let mut landing = Landing::<f64, N, K, V, M>::new(profile::LANDING);
            let dt = 2e-3;
            for _ in 0..150 {
                let s = snapshot(&q, &v);
                let limits = (&LIMITS, &MOTORS);
                let tick = landing.tick(&Icub23, &s, &contacts(0.0), limits, &wanted);
                v = v + tick.unwrap().answer.acceleration * dt;
                q = integrate(&q, &(v * dt));
            }
            let after = tilt(&snapshot(&q, &v));
            for (before, after) in before.into_iter().zip(after) {
                assert!(before > 0.1 && after < 0.1 * before, "{before} {after}");
            }
        },
    );
}

/// The way from touchdown to rest begins with the speed, ends at rest after the distance, and its speeds and accelerations are derivatives.
#[test]
fn a_landing_comes_to_rest_in_its_distance() {
    let cases = (-3.0..-0.1_f64, 0.01..0.3_f64, 0.05..2.0_f64, 0.01..0.99_f64);
    each(config(256, 43), &cases, |(speed, distance, longest, x)| {
        let way = Absorption::new(speed, distance, longest);
        let within = 3.0 * distance / speed.abs() < longest;
        assert!(way.duration <= longest && (within || way.duration == longest));
        assert_eq!(way.at(0.0)[..2], [0.0, speed]);
        let [end, rest, _] = way.at(way.duration * (1.0 + x));
        assert_eq!(rest, 0.0);
        assert!(
            !within || (end + distance).abs() < 1e-12,
            "{end} {distance}"
        );
        let (t, h) = (x * way.duration, 1e-6 * way.duration);
        let ([before, slow, _], [after, fast, _]) = (way.at(t - h), way.at(t + h));
        let [_, velocity, acceleration] = way.at(t);
        assert!(((after - before) / (2.0 * h) - velocity).abs() < 1e-6);
        assert!(
            ((fast - slow) / (2.0 * h) - acceleration).abs() < 1e-6 * (1.0 + acceleration.abs())
        );
    });
    // Nothing to slow down takes the longest time.
    assert_eq!(Absorption::new(0.0, 0.1, 0.7).duration, 0.7);
}
