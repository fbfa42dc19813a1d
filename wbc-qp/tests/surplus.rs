//! What the torque program of a push-off does about a robot that does not move as it is told.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, config, crouch, each, snapshot};
use icub_model::{Icub23, LIMITS, MOTORS, SOLES, profile};
use nalgebra::Vector3;
use wbc_qp::jump::{ComReference, Residuals, TorqueJump, TorqueJumpSettings};
use wbc_qp::{Contact, Snapshot};

const DT: f64 = 1e-3;

type Program = TorqueJump<f64, N, 12, 35, M>;

/// A tick of a program that is to let the centre of mass rise: accelerations of the centre of mass and rates of the angular
/// momentum that it asks for.
fn asked(program: &mut Program, s: &Snapshot<f64, N>) -> ([f64; 3], [f64; 3]) {
    let wanted = ComReference {
        position_w: s.com_w(),
        velocity_w: Vector3::zeros(),
        acceleration_w: Vector3::z(),
    };
    let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0));
    let joints = (&LIMITS, &MOTORS);
    let tick = program.tick(&Icub23, s, &contacts, joints, &wanted, DT);
    let tick = tick.unwrap();
    let Residuals { com, momentum } = tick.residuals;
    assert!(com < 0.02 && momentum < 0.02, "{com} {momentum}");
    let a = &tick.answer.acceleration;
    (s.com().reached(a), s.angular_momentum().reached(a))
}

fn program(surplus_gain: f64, s: &Snapshot<f64, N>) -> Program {
    let settings = TorqueJumpSettings {
        surplus_gain,
        ..profile::TORQUE
    };
    TorqueJump::new(settings, s.configuration.joints)
}

/// Where the motion is not what was asked for, more is asked for: of a robot that goes on as it is, after n ticks without any answer to what
/// was asked, by what an observer with both poles at the gain has found, and that is taken off again.
#[test]
fn more_is_asked_of_a_robot_that_does_not_follow() {
    each(config(4, 61), &crouch(0.02, 0.1), |(q, v)| {
        let s = snapshot(&q, &v);
        let gain = 20.0;
        let mut program = program(gain, &s);
        let (com, momentum) = asked(&mut program, &s);
        let first: Vec<f64> = com.into_iter().chain(momentum).collect();
        // (x̂ − x, d, a): the robot never accelerates.
        let mut expected: Vec<[f64; 3]> = first.iter().map(|a| [0.0, 0.0, *a]).collect();
        for _ in 0..30 {
            let (com, momentum) = asked(&mut program, &s);
            let found = com.into_iter().chain(momentum);
            for ((state, first), found) in expected.iter_mut().zip(&first).zip(found) {
                let [ahead, surplus, asked] = *state;
                let error = -(ahead + (asked + surplus) * DT);
                let surplus = surplus + gain * gain * DT * error;
                let next = first - surplus;
                *state = [2.0 * gain * DT * error - error, surplus, next];
                assert!(
                    (found - next).abs() < 0.05 + 0.02 * next.abs(),
                    "{found} {next}"
                );
            }
        }
    });
}

/// Without the gain, and after a restart, nothing is known of earlier ticks.
#[test]
fn a_program_that_starts_again_knows_of_no_surplus() {
    each(config(4, 62), &crouch(0.02, 0.1), |(q, v)| {
        let s = snapshot(&q, &v);
        let apart = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
            let a = a.0.into_iter().chain(a.1);
            let gaps = a
                .zip(b.0.into_iter().chain(b.1))
                .map(|(a, b)| (a - b).abs());
            gaps.fold(0.0, f64::max)
        };
        for gain in [0.0, 20.0] {
            let mut program = program(gain, &s);
            let first = asked(&mut program, &s);
            let last = (0..50).fold(first, |_, _| asked(&mut program, &s));
            assert_eq!(apart(first, last) > 0.05, gain > 0.0, "{first:?} {last:?}");
            program.restart(&q.joints);
            assert!(apart(first, asked(&mut program, &s)) < 1e-9);
        }
    });
}
