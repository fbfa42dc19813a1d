//! Tasks, contacts and limits against finite differences and against what they promise.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

mod common;

use common::{N, Rng, oracle, snapshot};
use icub_model::gazebo::frame;
use icub_model::{Icub23, LIMITS, SOLES};
use nalgebra::Vector3;
use rbd_core::{Transform, integrate};
use wbc_qp::{Contact, Horizon, Snapshot, Task, VelocityQp, anchored};

/// The rate is J ν, and the drift is what the rate gains along q̇ = ν at ν̇ = 0.
fn check<const R: usize>(name: &str, task: impl Fn(&Snapshot<f64, N>) -> Task<f64, N, R>) {
    let mut rng = Rng(7);
    let h = 1e-6;
    for _ in 0..10 {
        let (q, v) = rng.state();
        let now = task(&snapshot(&q, &v));
        let later = task(&snapshot(&integrate(&q, &(v * h)), &v));
        let before = task(&snapshot(&integrate(&q, &(v * -h)), &v));
        for (i, rate) in now.of(&v).iter().enumerate() {
            assert!((rate - now.rate[i]).abs() < 1e-10, "{name}: rate {i}");
            let drift = (later.rate[i] - before.rate[i]) / (2.0 * h);
            let error = (drift - now.drift[i]).abs();
            assert!(
                error < 1e-6 * (1.0 + drift.abs()),
                "{name}: drift {i}: {drift} {}",
                now.drift[i]
            );
        }
    }
}

#[test]
fn rates_and_drifts_are_those_of_the_motion() {
    check("centre of mass", Snapshot::com);
    check("linear momentum", Snapshot::linear_momentum);
    check("angular momentum", Snapshot::angular_momentum);
    check("frame", |s| s.frame_pose(&Icub23, &frame::CHEST));
    check("position", |s| s.frame_position(&Icub23, &frame::L_SOLE));
    check("orientation", |s| {
        s.frame_orientation(&Icub23, &frame::R_FOREARM)
    });
}

#[test]
fn an_anchored_foot_rests_where_it_was_put() {
    let mut rng = Rng(3);
    for _ in 0..10 {
        let (q, v) = rng.state();
        let pose = Transform::new(q.base.rotation, Vector3::new(0.1, 0.2, 0.3));
        let foot = &SOLES[0].frame;
        let (q, v) = anchored(&Icub23, &q.joints, &v.joints, foot, &pose);
        let s = snapshot(&q, &v);
        let found = s.pose(foot);
        assert!((found.translation - pose.translation).norm() < 1e-12);
        assert!((found.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-12);
        assert!(
            s.frame_pose(&Icub23, foot)
                .rate
                .iter()
                .all(|x| x.abs() < 1e-10)
        );
    }
}

/// In any state, however far outside its limits: solved as Clarabel solves it, contacts kept, bounds kept.
#[test]
fn the_velocity_program_always_has_an_answer() {
    let mut rng = Rng(11);
    let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 600.0));
    let horizon = Horizon {
        position: 0.02,
        velocity: 0.005,
        acceleration: 500.0,
    };
    let mut qp = VelocityQp::<f64, N, 29, 12>::new();
    for k in 0..200 {
        let (mut q, v) = rng.state();
        for x in &mut q.joints {
            *x += if k % 2 == 0 { 0.5 * rng.next() } else { 0.0 };
        }
        let s = snapshot(&q, &v);
        qp.begin(&Icub23, &s, &contacts).unwrap();
        qp.minimise(
            &s.com(),
            &[rng.next(), rng.next(), 3.0 * rng.next()],
            &[1e6; 3],
        );
        qp.minimise(&s.angular_momentum(), &[0.0; 3], &[1e6; 3]);
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.limit_joints(&s, &LIMITS, &horizon);
        let answer = qp.solve().unwrap();
        if k % 8 == 0 {
            let base = answer.velocity.base.to_array();
            let z = core::array::from_fn(|i| match i {
                0..N => answer.velocity.joints[i],
                _ => base[i - N],
            });
            let (cost, least) = (qp.problem().cost(&z), oracle(&qp.problem()).unwrap());
            let scale = 1.0 + least.abs();
            assert!((cost - least).abs() < 1e-6 * scale, "{cost} {least}");
        }
        for sole in &SOLES {
            let rate = s.frame_pose(&Icub23, &sole.frame).of(&answer.velocity);
            assert!(rate.iter().all(|x| x.abs() < 1e-8), "{rate:?}");
        }
        for ((qd, limits), x) in answer.velocity.joints.iter().zip(&LIMITS).zip(&q.joints) {
            let [low, high] = horizon.velocity_range(limits, *x);
            assert!(*qd >= low - 1e-9 && *qd <= high + 1e-9);
        }
    }
}

/// A contact that is off constrains nothing; a NaN is an error and not a command.
#[test]
fn absent_contacts_and_bad_numbers() {
    let mut rng = Rng(5);
    let (q, v) = rng.state();
    let s = snapshot(&q, &v);
    let mut contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 600.0));
    contacts[1].load = 0.0;
    let mut qp = VelocityQp::<f64, N, 29, 12>::new();
    let foot = s.frame_position(&Icub23, &SOLES[1].frame);
    qp.begin(&Icub23, &s, &contacts).unwrap();
    qp.minimise(&foot, &[0.0, 0.0, 0.3], &[1e6; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    let answer = qp.solve().unwrap();
    assert!((foot.of(&answer.velocity)[2] - 0.3).abs() < 1e-4);
    qp.begin(&Icub23, &s, &contacts).unwrap();
    qp.minimise(&foot, &[f64::NAN, 0.0, 0.3], &[1e6; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    assert!(matches!(qp.solve(), Err(wbc_qp::Error::Data(_))));
    let mut small = VelocityQp::<f64, N, 29, 6>::new();
    assert_eq!(
        small.begin(&Icub23, &s, &contacts),
        Err(wbc_qp::Error::NoRoomForRows)
    );
}
