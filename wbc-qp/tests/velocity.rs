//! The velocity program: levels, feedback that cannot be had, and ticks that were refused.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, VELOCITY_ROWS, config, crouch, each, snapshot};
use icub_model::gazebo::frame;
use icub_model::{Icub23, LIMITS, SOLES};
use nalgebra::Vector3;
use rbd_core::Frame;
use wbc_qp::{
    Contact, Error, Extent, Horizon, Limit, Limited, Rank, Side, Snapshot, VelocityAnswer,
    VelocityQp, Yielded,
};

const HORIZON: Horizon<f64> = Horizon {
    position: 0.04,
    velocity: 0.01,
    acceleration: 1000.0,
};

type Plain = VelocityQp<f64, N, 29, VELOCITY_ROWS>;

fn soles() -> [Contact<f64>; 2] {
    SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0))
}

/// The end of a level takes the costs of tasks and leaves those of slack: a cost and a slack of the same weight meet in the middle, in
/// the third level as in the first.
#[test]
fn slack_outlives_levels() {
    each(config(4, 51), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let com = s.com();
        let rise = |levels: u32| {
            // Of the size of a program that is there already.
            let mut qp = Box::new(VelocityQp::<f64, N, 38, M>::new());
            qp.begin(&Icub23, &s, &soles()).unwrap();
            let (low, high) = ([f64::NEG_INFINITY], [0.1]);
            qp.constrain(&com.select([2]), &low, &high, Rank::Slack(1e4))
                .unwrap();
            for _ in 0..levels {
                qp.next_level();
                qp.minimise(&com, &[0.0, 0.0, 0.3], &[1e4; 3]);
                qp.minimise_joints(&[0.0; N], &[1.0; N]);
            }
            com.of(&qp.solve().unwrap().velocity)[2]
        };
        let [one, three] = [1, 3].map(rise);
        assert!((one - 0.2).abs() < 0.01, "{one}");
        assert!((one - three).abs() < 1e-9, "{one} {three}");
    });
}

/// Soles on the ground and a hand that is not yet there; of all of them these velocities are asked, and of the hand 0.1 m/s upwards.
fn reaching(s: &Snapshot<f64, N>, asked: &[f64; 15]) -> (Box<Plain>, VelocityAnswer<f64, N>) {
    let hand = Contact::ball(&frame::L_FOREARM, 0.0, Vector3::z(), 0.5, 100.0);
    let hand = Contact { load: 0.0, ..hand };
    let [left, right] = soles();
    let mut qp = Box::new(Plain::new());
    qp.begin(&Icub23, s, &[left, right, hand]).unwrap();
    qp.correct_contacts(asked);
    let up = s.frame_position(&Icub23, &frame::L_FOREARM);
    qp.minimise(&up, &[0.0, 0.0, 0.1], &[1e6; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.limit_joints(s, &LIMITS, &HORIZON);
    let answer = qp.solve().unwrap();
    (qp, answer)
}

/// Feedback moves contacts that are there and no other; where no joint is fast enough for it, they rest, and the report says by how much
/// each was missed.
#[test]
fn feedback_is_had_or_its_contacts_rest() {
    each(config(4, 52), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let hand = s.frame_position(&Icub23, &frame::L_FOREARM);
        let rates = |answer: &VelocityAnswer<f64, N>| {
            let up = hand.of(&answer.velocity);
            let away = (Vector3::from(up) - Vector3::z() * 0.1).norm();
            assert!(away < 1e-3, "{up:?}");
            SOLES.map(|sole| {
                let task = s.frame_position(&Icub23, &sole.frame);
                let axes = s.pose(&sole.frame).rotation;
                task.in_axes(&axes).of(&answer.velocity)
            })
        };
        let (_, answer) = reaching(&s, &[0.01; 15]);
        assert_eq!(answer.yielded, Yielded::Nothing);
        for rate in rates(&answer) {
            assert!(rate.iter().all(|x| (x - 0.01).abs() < 1e-8), "{rate:?}");
        }

        // Soles that shall fly apart.
        let asked = core::array::from_fn(|k| [50.0, -50.0, 50.0][k / 6]);
        let (qp, answer) = reaching(&s, &asked);
        assert_eq!(answer.yielded, Yielded::Contacts);
        for rate in rates(&answer) {
            assert!(rate.iter().all(|x| x.abs() < 1e-8), "{rate:?}");
        }
        let lines: Vec<_> = qp.report(&answer, 1e-6).collect();
        for sole in 0..2 {
            let by = lines.iter().find_map(|line| match line.extent {
                Extent::Missed(by) if line.limit == Limit::Contact(sole) => Some(by),
                _ => None,
            });
            assert!((by.unwrap() - 50.0).abs() < 1e-6, "{lines:?}");
        }
        let of_the_hand = |line: &Limited<f64>| line.limit == Limit::Contact(2);
        assert!(!lines.iter().any(of_the_hand), "{lines:?}");
    });
}

/// What was asked of a contact ends with its tick: in the next one, whose feedback is of the first sole alone, the second one shall rest and
/// does.
#[test]
fn feedback_of_an_earlier_tick_is_forgotten() {
    each(config(4, 54), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let (mut qp, _) = reaching(&s, &[0.01; 15]);
        qp.begin(&Icub23, &s, &soles()).unwrap();
        qp.correct_contacts(&[50.0; 6]);
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.limit_joints(&s, &LIMITS, &HORIZON);
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Contacts);
        let lines: Vec<_> = qp.report(&answer, 1e-6).collect();
        let missed = |sole| {
            let of_it = move |line: &&Limited<f64>| line.limit == Limit::Contact(sole);
            lines.iter().filter(of_it).count()
        };
        assert_eq!([missed(0), missed(1)], [6, 0], "{lines:?}");
    });
}

/// A held velocity that no joint is fast enough for is missed by what the report says, what was asked less what is had; and the
/// joints that it names, of which there are some, are as fast as they may be to the side that it says.
#[test]
fn a_velocity_out_of_reach_is_missed_by_what_the_report_says() {
    each(config(4, 55), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let com = s.com();
        let asked = [3.0, -2.0, 50.0];
        let mut qp = Box::new(Plain::new());
        qp.begin(&Icub23, &s, &soles()).unwrap();
        qp.hold(&com, &asked).unwrap();
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.limit_joints(&s, &LIMITS, &HORIZON);
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Tasks);
        let had = com.of(&answer.velocity);
        assert!(had[2] > 0.1, "{had:?}");
        let lines: Vec<_> = qp.report(&answer, 1e-6).collect();
        for (row, (asked, had)) in asked.iter().zip(&had).enumerate() {
            let by = lines.iter().find_map(|line| match line.extent {
                Extent::Missed(by) if line.limit == Limit::Row(row) => Some(by),
                _ => None,
            });
            let missed = (asked - had).abs();
            assert!((by.unwrap_or(0.0) - missed).abs() < 1e-6, "{lines:?}");
        }
        let mut named = 0;
        for line in &lines {
            if let (Limit::Motion(i), Extent::Held(side)) = (line.limit, line.extent) {
                let [low, high] = HORIZON.velocity_range(&LIMITS[i], q.joints[i]);
                let end = if side == Side::Upper { high } else { low };
                let qd = answer.velocity.joints[i];
                assert!((qd - end).abs() < 1e-9, "{line:?}: {qd} {end}");
                named += 1;
            }
        }
        assert!(named > 0, "{lines:?}");
    });
}

/// Room for slack that no row takes changes nothing, and each of its variables is fixed: in what another solver is given none is free
/// without a cost.
#[test]
fn room_for_slack_that_no_row_takes_is_closed() {
    each(config(4, 56), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let com = s.com();
        let trunk = s.frame_pose(&Icub23, &Frame::IDENTITY);
        let mut narrow = Box::new(VelocityQp::<f64, N, 29, VELOCITY_ROWS>::new());
        narrow.begin(&Icub23, &s, &soles()).unwrap();
        narrow.minimise(&com, &[0.0, 0.0, 0.3], &[1e4; 3]);
        narrow.minimise(&trunk, &[0.0; 6], &[1.0; 6]);
        narrow.minimise_joints(&[0.0; N], &[1.0; N]);
        // Of the size of a program that is there already.
        let mut wide = Box::new(VelocityQp::<f64, N, 38, M>::new());
        wide.begin(&Icub23, &s, &soles()).unwrap();
        wide.minimise(&com, &[0.0, 0.0, 0.3], &[1e4; 3]);
        wide.minimise(&trunk, &[0.0; 6], &[1.0; 6]);
        wide.minimise_joints(&[0.0; N], &[1.0; N]);
        let problem = wide.problem();
        let bounds = problem.lower.unwrap().iter().zip(problem.upper.unwrap());
        for (i, (low, high)) in bounds.enumerate() {
            let is_fixed = [*low, *high] == [0.0; 2];
            assert_eq!(is_fixed, problem.hessian[i][i] == 0.0, "variable {i}");
            assert_eq!(is_fixed, i >= N + 6, "variable {i}");
        }
        let [a, b] = [narrow.solve().unwrap(), wide.solve().unwrap()];
        for (a, b) in a.velocity.joints.iter().zip(&b.velocity.joints) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    });
}

/// Rows of a tick that was refused are gone in the next one, which has fewer: a NaN does not stay.
#[test]
fn nothing_is_left_of_a_refused_tick() {
    each(config(4, 53), &crouch(0.1, 0.2), |(q, v)| {
        let s = snapshot(&q, &v);
        let com = s.com();
        let mut broken = com;
        broken.jacobian[2].joints[3] = f64::NAN;
        let rise = |qp: &mut Plain| {
            qp.begin(&Icub23, &s, &soles()).unwrap();
            qp.minimise(&com, &[0.0, 0.0, 0.1], &[1e4; 3]);
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
        };
        let mut qp = Box::new(Plain::new());
        rise(&mut qp);
        qp.hold(&broken, &[0.0; 3]).unwrap();
        assert!(matches!(qp.solve(), Err(Error::Data(_))));
        rise(&mut qp);
        let after = qp.solve().unwrap();
        let mut fresh = Box::new(Plain::new());
        rise(&mut fresh);
        assert_eq!(after, fresh.solve().unwrap());
    });
}
