//! Rows of the user in both programs: what they keep, how they give way, and what the report says of it.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{
    M, N, VELOCITY_ROWS, config, crouch, crouched, each, least_without_limits, oracle, snapshot,
    unknowns,
};
use icub_model::{Icub23, LIMITS, MOTORS, SOLES};
use proptest::prelude::*;
use wbc_qp::{
    Contact, Error, Extent, Horizon, Limit, Limited, Rank, Side, Snapshot, TorqueAnswer, TorqueQp,
    VelocityQp, Yielded,
};

const K: usize = 12;
const FREE: f64 = f64::INFINITY;

/// Without, and with, room for three slacks.
type Strict = TorqueQp<f64, N, K, 35, M>;
type Slack = TorqueQp<f64, N, K, 38, M>;

const HORIZON: Horizon<f64> = Horizon {
    position: 0.04,
    velocity: 0.01,
    acceleration: 1000.0,
};

fn contacts() -> [Contact<f64>; 2] {
    SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0))
}

/// A crouch on both soles, every joint displaced and moving.
fn example() -> Snapshot<f64, N> {
    let some = |most: f64| core::array::from_fn(|i| most * [1.0, -0.6, 0.3, -0.9, 0.7][i % 5]);
    let (q, v) = crouched(&some(0.1), &some(0.2));
    snapshot(&q, &v)
}

fn crouches() -> impl Strategy<Value = Snapshot<f64, N>> {
    crouch(0.1, 0.2).prop_map(|(q, v)| snapshot(&q, &v))
}

/// Centre of mass as asked for, little else, torques inside their limits.
fn begin<const V: usize>(qp: &mut TorqueQp<f64, N, K, V, M>, s: &Snapshot<f64, N>, up: [f64; 3]) {
    qp.begin(&Icub23, s, &contacts(), &[0.0; N]).unwrap();
    qp.minimise(&s.com(), &up, &[1e3; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0; K], &[1e-3; K]);
    qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))
        .unwrap();
    qp.limit_joints(s, &LIMITS, &HORIZON);
}

fn report<const V: usize>(
    qp: &TorqueQp<f64, N, K, V, M>,
    answer: &TorqueAnswer<f64, N, K>,
) -> Vec<Limited<f64>> {
    qp.report(answer, 1e-6).collect()
}

fn missed(report: &[Limited<f64>], what: Limit) -> f64 {
    let found = report.iter().find_map(|line| match line.extent {
        Extent::Missed(by) if line.limit == what => Some(by),
        _ => None,
    });
    found.unwrap_or(0.0)
}

fn gap<const R: usize>(a: &[f64; R], b: &[f64; R]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

#[test]
fn a_range_is_kept_named_and_optimal() {
    let cases = (crouches(), prop_oneof![6 => 0.2..0.8_f64, 1 => Just(0.0)]);
    each(config(20, 21), &cases, |(s, high)| {
        let mut qp = Box::new(Strict::new());
        begin(&mut qp, &s, [0.0, 0.0, 2.0]);
        qp.constrain(&s.com(), &[-FREE; 3], &[FREE, FREE, high], Rank::Limit)
            .unwrap();
        let least = oracle(&qp.problem()).cost().unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing);
        let reached = s.com().reached(&answer.acceleration)[2];
        assert!((reached - high).abs() < 1e-7, "{reached} {high}");
        let cost = qp.problem().cost(&unknowns(&s, &answer));
        assert!((cost - least).abs() < 1e-6 * (1.0 + least.abs()));
        let row = Limited {
            limit: Limit::Row(2),
            extent: Extent::Held(Side::Upper),
        };
        assert!(report(&qp, &answer).contains(&row));
    });
}

/// A normal force at its largest is named by its contact, and with room none is.
#[test]
fn a_largest_normal_force_is_named() {
    let cases = (crouches(), 0.3..0.7_f64);
    each(config(4, 26), &cases, |(s, share)| {
        let named = |most: f64| {
            let mut qp = Box::new(Strict::new());
            let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, most));
            qp.begin(&Icub23, &s, &contacts, &[0.0; N]).unwrap();
            qp.minimise(&s.com(), &[0.0, 0.0, 2.0], &[1e3; 3]);
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
            qp.minimise_forces(&[0.0; K], &[1e-3; K]);
            let answer = qp.solve().unwrap();
            let at_most = [0, 1].map(|k| (answer.forces[6 * k + 2] - most).abs() < 1e-6 * most);
            let line = |k| Limited {
                limit: Limit::NormalForce(k),
                extent: Extent::Held(Side::Upper),
            };
            let report = report(&qp, &answer);
            (at_most, [0, 1].map(|k| report.contains(&line(k))))
        };
        let half_weight = 0.5 * 9.81 * s.centroidal.mass;
        assert_eq!(named(share * half_weight), ([true; 2], [true; 2]));
        assert_eq!(named(10.0 * half_weight), ([false; 2], [false; 2]));
    });
}

/// Rows without limits change nothing, and an equality is the held task.
#[test]
fn masked_rows_are_not_there_and_equal_limits_hold() {
    each(config(4, 22), &crouches(), |s| {
        let solve = |rows: &dyn Fn(&mut Strict)| {
            let mut qp = Box::new(Strict::new());
            begin(&mut qp, &s, [0.1, 0.0, 1.0]);
            rows(&mut qp);
            let answer = qp.solve().unwrap();
            assert_eq!(answer.yielded, Yielded::Nothing);
            answer.torques
        };
        let (com, turn) = (s.com(), s.angular_momentum());
        let plain = solve(&|_| ());
        let masked = solve(&|qp| {
            qp.constrain(&com, &[-FREE; 3], &[FREE; 3], Rank::Task)
                .unwrap();
        });
        assert!(gap(&plain, &masked) < 1e-9);
        let target = [0.0, 0.2, 0.0];
        let held = solve(&|qp| qp.hold(&turn, &target).unwrap());
        let equal = solve(&|qp| {
            qp.constrain(&turn, &target, &target, Rank::Limit).unwrap();
        });
        assert!(gap(&held, &equal) < 1e-9 && gap(&held, &plain) > 1e-3);
        // One row of three, by choosing it and by masking the others.
        let one = solve(&|qp| qp.hold(&turn.select([1]), &[0.2]).unwrap());
        let mask = solve(&|qp| {
            let rows = ([-FREE, 0.2, -FREE], [FREE, 0.2, FREE]);
            qp.constrain(&turn, &rows.0, &rows.1, Rank::Task).unwrap();
        });
        assert!(gap(&one, &mask) < 1e-9 && gap(&one, &held) > 1e-4);
    });
}

/// Slack of weight w: Clarabel's optimum, the miss in the report is the slack, and it falls as 1/w to the strict answer.
#[test]
fn slack_costs_what_it_is_given() {
    each(config(4, 23), &crouches(), |s| {
        let solve = |weight: f64| {
            let mut qp = Box::new(Slack::new());
            begin(&mut qp, &s, [0.0, 0.0, 2.0]);
            qp.constrain(
                &s.com(),
                &[-FREE; 3],
                &[FREE, FREE, 0.5],
                Rank::Slack(weight),
            )
            .unwrap();
            let least = oracle(&qp.problem()).cost().unwrap();
            let answer = qp.solve().unwrap();
            let over = s.com().reached(&answer.acceleration)[2] - 0.5;
            let unit = s.centroidal.mass * 0.981;
            let mut z: [f64; 38] = core::array::from_fn(|i| match i {
                0..N => answer.acceleration.joints[i],
                N..35 => answer.forces[i - N] / unit,
                _ => 0.0,
            });
            z[37] = -over;
            let cost = qp.problem().cost(&z);
            assert!((cost - least).abs() < 1e-6 * (1.0 + least.abs()));
            assert!((missed(&report(&qp, &answer), Limit::Row(2)) - over).abs() < 1e-9);
            over
        };
        let [light, middle, heavy] = [1e3, 1e5, 1e7].map(solve);
        // The slack's force w s tends to the strict row's multiplier.
        assert!(light > 0.1 && middle < 0.1 * light, "{light} {middle}");
        let ratio = 1e7 * heavy / (1e5 * middle);
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    });
}

/// The end of a level takes the costs of tasks and leaves those of slack.
#[test]
fn slack_outlives_a_level() {
    each(config(4, 30), &crouches(), |s| {
        let com = s.com();
        let costs = |qp: &mut Slack| {
            qp.minimise(&com, &[0.0, 0.0, 2.0], &[1e3; 3]);
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
            qp.minimise_forces(&[0.0; K], &[1e-3; K]);
        };
        let solve = |level: bool| {
            let mut qp = Box::new(Slack::new());
            qp.begin(&Icub23, &s, &contacts(), &[0.0; N]).unwrap();
            costs(&mut qp);
            let rank = Rank::Slack(1e3);
            qp.constrain(&com.select([2]), &[-FREE], &[0.5], rank)
                .unwrap();
            if level {
                qp.next_level();
                costs(&mut qp);
            }
            qp.solve().unwrap().torques
        };
        assert!(gap(&solve(false), &solve(true)) < 1e-9);
    });
}

/// A task that contradicts a limit yields first; the limit stays, and the report says by how much the task was missed.
#[test]
fn tasks_yield_before_limits() {
    each(config(4, 24), &crouches(), |s| {
        let mut qp = Box::new(Strict::new());
        begin(&mut qp, &s, [0.0; 3]);
        let com = s.com();
        let height = com.select([2]);
        qp.constrain(&height, &[-FREE], &[0.4], Rank::Limit)
            .unwrap();
        qp.hold(&height, &[3.0]).unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Tasks);
        let reached = com.reached(&answer.acceleration)[2];
        assert!((reached - 0.4).abs() < 1e-6, "{reached}");
        let report = report(&qp, &answer);
        assert!((missed(&report, Limit::Row(1)) - 2.6).abs() < 1e-5);
        assert_eq!(missed(&report, Limit::Row(0)), 0.0);

        // Two limits against each other: both go, after the tasks, and the contacts stay.
        let mut qp = Box::new(Strict::new());
        begin(&mut qp, &s, [0.0; 3]);
        qp.constrain(&height, &[2.0], &[FREE], Rank::Limit).unwrap();
        qp.constrain(&height, &[-FREE], &[1.0], Rank::Limit)
            .unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::MotionLimits);
        assert!(answer.contact_violation < 1e-6);
    });
}

/// Each thing that can limit a tick is named when it does, and without it the cost would be lower; where nothing is named, costs alone
/// decide. In a few of these states a sole's cone limits a step up already.
#[test]
fn the_report_names_torque_friction_and_motion() {
    each(config(4, 25), &crouches(), |s| {
        let mut qp = Box::new(Strict::new());
        begin(&mut qp, &s, [0.0, 0.0, 1.0]);
        let free = qp.solve().unwrap();
        let least = least_without_limits(&qp.problem());
        let above = (qp.problem().cost(&unknowns(&s, &free)) - least) / (1.0 + least.abs());
        let names = report(&qp, &free);
        assert!(
            above > -1e-6 && (above < 1e-6 || !names.is_empty()),
            "{above:e} {names:?}"
        );
        assert!(above > 1e-9 || names.is_empty(), "{above:e} {names:?}");

        // A knee that gives half of what it gave.
        let knee = 3;
        let half = 0.5 * free.torques[knee].abs();
        qp.begin(&Icub23, &s, &contacts(), &[0.0; N]).unwrap();
        qp.minimise(&s.com(), &[0.0, 0.0, 1.0], &[1e3; 3]);
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.minimise_forces(&[0.0; K], &[1e-3; K]);
        let mut ranges = MOTORS.map(|m| [-m.torque, m.torque]);
        ranges[knee] = [-half, half];
        qp.limit_torques(&ranges).unwrap();
        let answer = qp.solve().unwrap();
        let names: Vec<Limit> = report(&qp, &answer).iter().map(|x| x.limit).collect();
        assert!(names.contains(&Limit::Torque(knee)), "{names:?}");
        assert!((answer.torques[knee].abs() - half).abs() < 1e-6);

        // To the side with 1 g: the ground's friction is one half.
        begin(&mut qp, &s, [0.0, 9.0, 0.0]);
        let answer = qp.solve().unwrap();
        let names: Vec<Limit> = report(&qp, &answer).iter().map(|x| x.limit).collect();
        assert!(
            names.iter().any(|x| matches!(x, Limit::Cone(0 | 1))),
            "{names:?}"
        );

        // A joint at its limit.
        let mut limits = LIMITS;
        let joint = 14;
        limits[joint].upper = s.configuration.joints[joint];
        qp.begin(&Icub23, &s, &contacts(), &[0.0; N]).unwrap();
        let mut wanted = [0.0; N];
        wanted[joint] = 500.0;
        qp.minimise_joints(&wanted, &[1.0; N]);
        qp.minimise_forces(&[0.0; K], &[1e-3; K]);
        qp.limit_joints(&s, &limits, &HORIZON);
        let answer = qp.solve().unwrap();
        let line = Limited {
            limit: Limit::Motion(joint),
            extent: Extent::Held(Side::Upper),
        };
        assert!(report(&qp, &answer).contains(&line));
    });
}

#[test]
fn a_row_over_forces_bounds_them() {
    each(config(4, 26), &crouches(), |s| {
        let mut qp = Box::new(Strict::new());
        begin(&mut qp, &s, [0.0; 3]);
        // A third of the weight on the left sole at most.
        let most = s.centroidal.mass * 9.81 / 3.0;
        let normal = core::array::from_fn(|k| if k == 2 { 1.0 } else { 0.0 });
        qp.constrain_forces(&normal, [-FREE, most], Rank::Limit)
            .unwrap();
        let answer = qp.solve().unwrap();
        assert!((answer.forces[2] - most).abs() < 1e-6 && answer.forces[8] > most);
    });
}

type Velocity = VelocityQp<f64, N, 29, VELOCITY_ROWS>;

fn begin_velocity(qp: &mut Velocity, s: &Snapshot<f64, N>) {
    qp.begin(&Icub23, s, &contacts()).unwrap();
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.limit_joints(s, &LIMITS, &HORIZON);
}

#[test]
fn rows_of_the_velocity_program() {
    each(config(4, 27), &crouches(), |s| {
        let (com, turn) = (s.com(), s.angular_momentum());
        let mut qp = Box::new(Velocity::new());
        // A range that is active, and its name.
        begin_velocity(&mut qp, &s);
        qp.minimise(&com, &[0.0, 0.0, 0.3], &[1e4; 3]);
        qp.constrain(&com.select([2]), &[-FREE], &[0.1], Rank::Limit)
            .unwrap();
        let answer = qp.solve().unwrap();
        assert!((com.of(&answer.velocity)[2] - 0.1).abs() < 1e-9);
        let line = Limited {
            limit: Limit::Row(0),
            extent: Extent::Held(Side::Upper),
        };
        assert!(qp.report(&answer, 1e-9).any(|x| x == line));

        // Strict levels: the second does not move the first, and is Clarabel's least among what is left.
        begin_velocity(&mut qp, &s);
        qp.hold(&com, &[0.0, 0.0, 0.1]).unwrap();
        qp.minimise(&turn, &[0.3, 0.0, 0.0], &[1e4; 3]);
        let first = turn.of(&qp.solve().unwrap().velocity);
        qp.hold(&turn, &first).unwrap();
        qp.next_level();
        let mut wanted = [0.0; N];
        wanted[15] = 1.0;
        qp.minimise_joints(&wanted, &[1.0; N]);
        let least = oracle(&qp.problem()).cost().unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing);
        assert!(gap(&turn.of(&answer.velocity), &first) < 1e-8);
        assert!(gap(&com.of(&answer.velocity), &[0.0, 0.0, 0.1]) < 1e-8);
        let base = answer.velocity.base.to_array();
        let z = core::array::from_fn(|i| match i {
            0..N => answer.velocity.joints[i],
            _ => base[i - N],
        });
        assert!((qp.problem().cost(&z) - least).abs() < 1e-6 * (1.0 + least.abs()));

        // Contradictions: the task misses, the limit allows rest, and bounds and contacts are kept.
        begin_velocity(&mut qp, &s);
        qp.hold(&com, &[0.0, 0.0, 50.0]).unwrap();
        qp.constrain(&com.select([2]), &[-FREE], &[-40.0], Rank::Limit)
            .unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::MotionLimits);
        let lines: Vec<_> = qp.report(&answer, 1e-6).collect();
        assert!(missed(&lines, Limit::Row(2)) > 40.0 && missed(&lines, Limit::Row(3)) > 30.0);
        for sole in &SOLES {
            let rate = s.frame_pose(&Icub23, &sole.frame).of(&answer.velocity);
            assert!(rate.iter().all(|x| x.abs() < 1e-8), "{rate:?}");
        }
        for ((qd, limits), q) in answer
            .velocity
            .joints
            .iter()
            .zip(&LIMITS)
            .zip(&s.configuration.joints)
        {
            let [low, high] = HORIZON.velocity_range(limits, *q);
            assert!(*qd >= low - 1e-9 && *qd <= high + 1e-9);
        }
    });
}

/// In any state and for any rows: a finite command inside bounds and contacts.
mod edges {
    use super::*;

    proptest! {
        #![proptest_config(config(48, 20))]
        #[test]
        fn no_rows_break_bounds_or_torques(
            s in crouches(),
            low in prop::array::uniform3(-1e3..1e3),
            size in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..10.0, Just(FREE)]),
            rank in prop_oneof![Just(Rank::Task), Just(Rank::Limit)],
        ) {
            let high = core::array::from_fn(|i| low[i] + size[i]);
            let mut qp = Box::new(Strict::new());
            begin(&mut qp, &s, [0.0; 3]);
            qp.constrain(&s.com(), &low, &high, rank).unwrap();
            let answer = qp.solve().unwrap();
            for (tau, motor) in answer.torques.iter().zip(&MOTORS) {
                prop_assert!(tau.abs() <= motor.torque + 1e-6, "{}", tau);
            }
            let task = s.com().reached(&answer.acceleration);
            let lines = report(&qp, &answer);
            for i in 0..3 {
                let by = (low[i] - task[i]).max(task[i] - high[i]);
                let told = missed(&lines, Limit::Row(i));
                prop_assert!((told - by.max(0.0)).abs() < 2e-6, "{} {}", told, by);
                prop_assert!(answer.yielded != Yielded::Nothing || by < 1e-5);
            }

            let mut qp = Box::new(Velocity::new());
            begin_velocity(&mut qp, &s);
            qp.constrain(&s.com(), &low, &high, rank).unwrap();
            let answer = qp.solve().unwrap();
            for ((qd, limits), q) in
                answer.velocity.joints.iter().zip(&LIMITS).zip(&s.configuration.joints)
            {
                let [low, high] = HORIZON.velocity_range(limits, *q);
                prop_assert!(*qd >= low - 1e-7 && *qd <= high + 1e-7);
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_an_error() {
    let s = example();
    let mut qp = Box::new(Strict::new());
    begin(&mut qp, &s, [0.0; 3]);
    let com = s.com();
    let slack = Rank::Slack(1.0);
    assert_eq!(
        qp.constrain(&com, &[0.0; 3], &[1.0; 3], slack),
        Err(Error::NoRoomForSlack)
    );
    qp.hold(&com, &[0.0; 3]).unwrap();
    assert_eq!(
        qp.hold(&s.frame_pose(&Icub23, &SOLES[0].frame), &[0.0; 6]),
        Err(Error::NoRoomForRows)
    );
    begin(&mut qp, &s, [0.0; 3]);
    qp.constrain(&com, &[1.0; 3], &[0.0; 3], Rank::Limit)
        .unwrap();
    assert!(matches!(qp.solve(), Err(Error::Data(_))));
    begin(&mut qp, &s, [0.0; 3]);
    qp.constrain(&com, &[f64::NAN; 3], &[FREE; 3], Rank::Limit)
        .unwrap();
    assert!(matches!(qp.solve(), Err(Error::Data(_))));
}

/// However absurd a held task is, it alone yields: joints and torques stay inside their limits.
#[test]
fn an_absurd_task_takes_no_limit_with_it() {
    each(config(3, 29), &crouches(), |s| {
        for size in [1e2, 1e3, 1e4, 1e5, 1e6] {
            for way in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.3, 0.0]] {
                let mut qp = Box::new(Strict::new());
                begin(&mut qp, &s, [0.0; 3]);
                qp.hold(&s.com(), &way.map(|x| size * x)).unwrap();
                let answer = qp.solve().unwrap();
                assert_eq!(answer.yielded, Yielded::Tasks, "{size} {way:?}");
                assert!(answer.limit_violation < 1e-6, "{answer:?}");
            }
        }
    });
}
