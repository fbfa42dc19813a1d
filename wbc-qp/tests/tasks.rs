//! Tasks, contacts and limits against finite differences and against what they promise.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{N, VELOCITY_ROWS, Verdict, config, each, oracle, snapshot, state};
use core::cell::{Cell, RefCell};
use icub_model::gazebo::frame;
use icub_model::{Icub23, LIMITS, SOLES};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::{Shape, Transform, integrate};
use wbc_qp::{Contact, Horizon, Rank, Snapshot, Task, VelocityQp, anchored};

/// The rate is J ν, and the drift is what the rate gains along q̇ = ν at ν̇ = 0.
fn check<const R: usize>(name: &str, task: impl Fn(&Snapshot<f64, N>) -> Task<f64, N, R>) {
    let h = 1e-6;
    each(config(10, 7), &state(), |(q, v)| {
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
    });
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

/// Turned by a fixed rotation a task is the same task, and rows are chosen by index.
#[test]
fn tasks_in_other_axes() {
    let turn = so3::exp(&Vector3::new(0.3, -0.7, 1.1));
    check("turned", |s| s.com().in_axes(&turn));
    check("chosen", |s| {
        s.frame_pose(&Icub23, &frame::CHEST).select([5, 0])
    });
    each(config(10, 8), &state(), |(q, v)| {
        let s = snapshot(&q, &v);
        let local = s.com().in_axes(&turn).rate;
        let wanted = turn.inverse() * s.com_velocity_w();
        assert!((Vector3::from(local) - wanted).norm() < 1e-12);
    });
}

/// Limbs, chest and hands as capsules and balls.
fn capsule(frame: &rbd_core::Frame<f64>, to: [f64; 3], radius: f64) -> Shape<f64> {
    let placement = frame.placement();
    Shape {
        link: frame.link,
        from: frame.offset,
        to: placement.point(&Vector3::from(to)).into(),
        radius,
        owner: 0,
    }
}

/// Distances are those of a dense search, and rate and drift those of the motion: between sides, ends, and a side and an end.
#[test]
fn distances_and_their_derivatives() {
    let pairs = [
        (
            capsule(&frame::L_FOREARM, [0.0, 0.0, 0.15], 0.03),
            capsule(&frame::CHEST, [0.0, 0.0, 0.3], 0.1),
        ),
        (
            capsule(&frame::L_FOREARM, [0.1, 0.1, 0.15], 0.03),
            capsule(&frame::R_FOREARM, [-0.1, 0.1, 0.15], 0.03),
        ),
        (
            capsule(&frame::L_FOREARM, [0.0; 3], 0.03),
            capsule(&frame::R_SOLE, [0.2, 0.0, 0.0], 0.02),
        ),
        (
            capsule(&frame::L_SOLE, [0.0; 3], 0.03),
            capsule(&frame::R_FOREARM, [0.0; 3], 0.02),
        ),
    ];
    let (smooth, sides) = (Cell::new(0), Cell::new(0));
    let h = 1e-6;
    each(
        config(400, 9),
        &(0..pairs.len(), state()),
        |(pair, (q, v))| {
            let (a, b) = &pairs[pair];
            let at = |t: f64| snapshot(&integrate(&q, &(v * t)), &v);
            let s = at(0.0);
            let near = s.clearance(a, b);
            let ends = |c: &Shape<f64>| {
                let link = s.kinematics.link(c.link);
                [c.from, c.to].map(|end| link.point(&Vector3::from(end)))
            };
            let ([p0, p1], [r0, r1]) = (ends(a), ends(b));
            let mut least = f64::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 {
                    let p = p0 + (p1 - p0) * (f64::from(i) / 60.0);
                    let r = r0 + (r1 - r0) * (f64::from(j) / 60.0);
                    least = least.min((p - r).norm());
                }
            }
            let found = near.distance + a.radius + b.radius;
            assert!(
                found <= least + 1e-12 && found > least - 0.01,
                "{found} {least}"
            );
            let task = s.distance(&Icub23, a, b);
            assert!((task.of(&v)[0] - task.rate[0]).abs() < 1e-10);
            let rate =
                (at(h).clearance(a, b).distance - at(-h).clearance(a, b).distance) / (2.0 * h);
            assert!(
                (rate - task.rate[0]).abs() < 1e-6,
                "{rate} {}",
                task.rate[0]
            );
            // The second derivative where both sides of now agree: elsewhere a nearest point is just coming to an end.
            let of = |t: f64| at(t).distance(&Icub23, a, b).rate[0];
            let (left, right) = ((of(0.0) - of(-h)) / h, (of(h) - of(0.0)) / h);
            if (left - right).abs() < 1e-3 {
                let drift = (of(h) - of(-h)) / (2.0 * h);
                let error = (drift - task.drift[0]).abs();
                assert!(
                    error < 1e-5 * (1.0 + drift.abs()),
                    "{drift} {}",
                    task.drift[0]
                );
                smooth.set(smooth.get() + 1);
                let inside = |x: Vector3<f64>, [e, f]: [Vector3<f64>; 2]| {
                    (x - e).norm() > 1e-9 && (x - f).norm() > 1e-9
                };
                let both = inside(near.points_w[0], [p0, p1]) && inside(near.points_w[1], [r0, r1]);
                sides.set(sides.get() + usize::from(both));
            }
        },
    );
    let (smooth, sides) = (smooth.get(), sides.get());
    assert!(smooth > 300 && sides > 10, "{smooth} {sides}");
}

/// A velocity damper comes to the distance it is to keep and not nearer.
#[test]
fn capsules_stay_apart() {
    let hand = capsule(&frame::L_FOREARM, [0.0, 0.0, -0.1], 0.03);
    let chest = capsule(&frame::CHEST, [0.0, 0.0, 0.2], 0.1);
    let horizon = Horizon {
        position: 0.1,
        velocity: 0.02,
        acceleration: 1e3,
    };
    let mut q = rbd_core::Configuration::NEUTRAL;
    for arm in [15, 19] {
        (q.joints[arm], q.joints[arm + 1], q.joints[arm + 3]) = (-0.5, 0.8, 0.8);
    }
    let mut v = rbd_core::Tangent::ZERO;
    let margin = 0.02;
    let mut least = f64::INFINITY;
    for _ in 0..1500 {
        let s = snapshot(&q, &v);
        let task = s.distance(&Icub23, &hand, &chest);
        let left = s.clearance(&hand, &chest).distance - margin;
        least = least.min(left);
        let mut air = VelocityQp::<f64, N, 29, VELOCITY_ROWS>::new();
        air.begin(&Icub23, &s, &[]).unwrap();
        air.constrain(
            &task,
            &[horizon.least_rate(left)],
            &[f64::INFINITY],
            Rank::Limit,
        )
        .unwrap();
        let mut inwards = [0.0; N];
        (inwards[16], inwards[15]) = (-1.0, 0.2);
        air.minimise_joints(&inwards, &[1.0; N]);
        air.minimise(
            &s.frame_pose(&Icub23, &rbd_core::Frame::IDENTITY),
            &[0.0; 6],
            &[1e3; 6],
        );
        let answer = air.solve().unwrap();
        assert_eq!(answer.yielded, wbc_qp::Yielded::Nothing);
        v = answer.velocity;
        q = integrate(&q, &(v * 2e-3));
    }
    let s = snapshot(&q, &v);
    let left = s.clearance(&hand, &chest).distance - margin;
    assert!(least > -1e-4 && left < 0.005, "{least} {left}");
}

#[test]
fn an_anchored_foot_rests_where_it_was_put() {
    each(config(10, 3), &state(), |(q, v)| {
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
    });
}

/// In any state, however far outside its limits: solved as Clarabel solves it, contacts kept, bounds kept.
#[test]
fn the_velocity_program_always_has_an_answer() {
    let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 600.0));
    let horizon = Horizon {
        position: 0.02,
        velocity: 0.005,
        acceleration: 500.0,
    };
    let (qp, certain) = (
        RefCell::new(VelocityQp::<f64, N, 29, VELOCITY_ROWS>::new()),
        Cell::new(0),
    );
    let outside = prop_oneof![Just([0.0; N]), prop::array::uniform(-0.5..0.5_f64)];
    let cases = (
        state(),
        outside,
        [-1.0..1.0, -1.0..1.0, -3.0..3.0_f64],
        prop::bool::weighted(0.125),
    );
    each(
        config(200, 11),
        &cases,
        |((mut q, v), outside, com, judged)| {
            let qp = &mut *qp.borrow_mut();
            for (x, out) in q.joints.iter_mut().zip(outside) {
                *x += out;
            }
            let s = snapshot(&q, &v);
            qp.begin(&Icub23, &s, &contacts).unwrap();
            qp.minimise(&s.com(), &com, &[1e6; 3]);
            qp.minimise(&s.angular_momentum(), &[0.0; 3], &[1e6; 3]);
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
            qp.limit_joints(&s, &LIMITS, &horizon);
            let answer = qp.solve().unwrap();
            if judged {
                let base = answer.velocity.base.to_array();
                let z = core::array::from_fn(|i| match i {
                    0..N => answer.velocity.joints[i],
                    _ => base[i - N],
                });
                let cost = qp.problem().cost(&z);
                let off = |least: f64| (cost - least) / (1.0 + least.abs());
                match oracle(&qp.problem()) {
                    Verdict::Least(least) => {
                        assert!(off(least).abs() < 1e-6, "{cost} {least}");
                        certain.set(certain.get() + 1);
                    }
                    Verdict::Nearly(least) => assert!(off(least) < 1e-6, "{cost} {least}"),
                    // It stops early where many joints are far outside their limits.
                    Verdict::Unsure => {}
                    Verdict::Infeasible => unreachable!("standing still is possible"),
                }
            }
            for sole in &SOLES {
                let rate = s.frame_pose(&Icub23, &sole.frame).of(&answer.velocity);
                assert!(rate.iter().all(|x| x.abs() < 1e-8), "{rate:?}");
            }
            for ((qd, limits), x) in answer.velocity.joints.iter().zip(&LIMITS).zip(&q.joints) {
                let [low, high] = horizon.velocity_range(limits, *x);
                assert!(*qd >= low - 1e-9 && *qd <= high + 1e-9);
            }
        },
    );
    assert!(certain.get() > 15, "{}", certain.get());
}

/// A contact that is off constrains nothing; a NaN is an error and not a command.
#[test]
fn absent_contacts_and_bad_numbers() {
    each(config(10, 5), &state(), |(q, v)| {
        let s = snapshot(&q, &v);
        let mut contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 600.0));
        contacts[1].load = 0.0;
        let mut qp = VelocityQp::<f64, N, 29, VELOCITY_ROWS>::new();
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
    });
}
