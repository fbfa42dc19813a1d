//! The torque program against the equations of motion, its limits, and Clarabel.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, Verdict, config, crouch, crouched, each, oracle, snapshot, unknowns};
use core::cell::{Cell, RefCell};
use icub_model::hardware::{MOTORS_F32, SOLES_F32};
use icub_model::{Icub23, LIMITS, MOTORS, SOLES, limits::LIMITS_F32, profile};
use proptest::prelude::*;
use rbd_core::{Axes, Force, Frame, FrameJacobian, Transform};
use rbd_core::{frame_jacobian, joint_friction, rnea};
use wbc_qp::jump::{ComReference, TorqueJump, TorqueJumpSettings};
use wbc_qp::{
    Contact, Horizon, Snapshot, Task, TorqueAnswer, TorqueQp, Yielded, anchored, torque_range,
};

const K: usize = 12;
const V: usize = 35;

fn contacts(friction: f64) -> [Contact<f64>; 2] {
    SOLES.map(|sole| Contact::new(&sole, friction, 1000.0))
}

const HORIZON: Horizon<f64> = Horizon {
    position: 0.04,
    velocity: 0.01,
    acceleration: 1000.0,
};

/// Accelerations of the centre of mass to ask for.
fn up() -> impl Strategy<Value = [f64; 3]> {
    [-1.0..1.0, -1.0..1.0, -6.0..6.0_f64]
}

/// A program like the push-off's.
fn program(
    qp: &mut TorqueQp<f64, N, K, V, M>,
    s: &Snapshot<f64, N>,
    up: &[f64; 3],
    torque_share: f64,
) -> [f64; N] {
    let friction = joint_friction(&LIMITS, &s.velocity.joints, 0.1);
    qp.begin(&Icub23, s, &contacts(0.5), &friction).unwrap();
    qp.minimise(&s.com(), up, &[1e3; 3]);
    qp.minimise(&s.angular_momentum(), &[0.0; 3], &[1e3; 3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0; K], &[1e-3; K]);
    qp.limit_joints(s, &LIMITS, &HORIZON);
    let ranges = core::array::from_fn(|i| {
        torque_range(&MOTORS[i], s.velocity.joints[i], f64::INFINITY).map(|x| x * torque_share)
    });
    qp.limit_torques(&ranges).unwrap();
    friction
}

/// Also where the tick before was in another state.
#[test]
fn an_answer_obeys_the_equations_of_motion_and_every_limit() {
    let qp = RefCell::new(TorqueQp::new());
    each(config(60, 1), &(crouch(0.1, 0.3), up()), |((q, v), up)| {
        let qp = &mut *qp.borrow_mut();
        let s = snapshot(&q, &v);
        let friction = program(qp, &s, &up, 1.0);
        let a = qp.solve().unwrap();
        // M ν̇ + h = S τ + τ_fric + Jᵀ f
        let mut rest = rnea(&Icub23, &s.posture, &v, &a.acceleration);
        for (i, tau) in rest.joints.iter_mut().enumerate() {
            *tau -= a.torques[i] + friction[i];
        }
        for (sole, f) in SOLES.iter().zip(a.forces.chunks(6)) {
            let mut j = FrameJacobian::ZERO;
            frame_jacobian(&Icub23, &s.kinematics, &sole.frame, Axes::Local, &mut j);
            let f = Force::from_array(core::array::from_fn(|i| f[i]));
            rest = rest - j.tr_mul(&f);
        }
        let worst = rest.base.to_array().into_iter().chain(rest.joints);
        let worst = worst.fold(0.0, |m: f64, x| m.max(x.abs()));
        assert!(worst < 1e-8, "{worst}");

        assert_eq!(a.yielded, Yielded::Nothing);
        assert!(
            a.contact_violation < 1e-6 && a.limit_violation < 1e-6,
            "{a:?}"
        );
        for (tau, motor) in a.torques.iter().zip(&MOTORS) {
            assert!(tau.abs() <= motor.torque + 1e-6);
        }
        for (contact, f) in contacts(0.5).iter().zip(a.forces.chunks(6)) {
            let mut k = 0;
            while let Some(row) = contact.cone(k) {
                let value: f64 = row.iter().zip(f).map(|(r, f)| r * f).sum();
                assert!(value < 1e-6, "row {k}: {value}");
                k += 1;
            }
            assert!(k == 10 && f[2] >= -1e-6);
        }
    });
}

/// From states well inside the limits, with torques without end too, to such where torques (none at last) or speeds do not allow both
/// contacts.
#[test]
fn costs_are_those_of_clarabel_and_what_yields_is_infeasible() {
    let (solved, yielded) = (Cell::new(0), Cell::new(0));
    let case = prop_oneof![
        20 => (Just(0.6), crouch(0.1, 0.3)),
        2 => (Just(f64::INFINITY), crouch(0.1, 0.3)),
        10 => (Just(0.1), crouch(0.1, 12.0)),
        1 => (Just(0.0), crouch(0.1, 0.3)),
    ];
    each(config(60, 2), &(case, up()), |((share, (q, v)), up)| {
        let mut qp = TorqueQp::new();
        let s = snapshot(&q, &v);
        program(&mut qp, &s, &up, share);
        let wanted = oracle(&qp.problem());
        let a = qp.solve().unwrap();
        if a.yielded == Yielded::Nothing {
            let z: [f64; V] = unknowns(&s, &a);
            let (cost, wanted) = (qp.problem().cost(&z), wanted.cost().unwrap());
            assert!(
                (cost - wanted).abs() < 1e-6 * (1.0 + wanted.abs()),
                "{cost} {wanted}"
            );
            solved.set(solved.get() + 1);
        } else {
            assert_eq!(wanted, Verdict::Infeasible, "what rows yielded to");
            yielded.set(yielded.get() + 1);
        }
        for (tau, motor) in a.torques.iter().zip(&MOTORS) {
            assert!(tau.abs() <= share * motor.torque + 1e-6);
        }
    });
    let (solved, yielded) = (solved.get(), yielded.get());
    assert!(
        solved > 20 && yielded > 0,
        "{solved} solved, {yielded} yielded"
    );
}

/// As the tasks' weight grows, the weighed solution tends to the one that holds them. There is none in a few of these states, where torques
/// do not allow what is held: the tasks yield there, and only there.
#[test]
fn weights_tend_to_strict_priority() {
    let held = Cell::new(0);
    each(config(10, 3), &crouch(0.1, 0.3), |(q, v)| {
        let s = snapshot(&q, &v);
        let solve = |weight: Option<f64>| {
            let mut qp = TorqueQp::<f64, N, K, V, M>::new();
            qp.begin(&Icub23, &s, &contacts(0.5), &[0.0; N]).unwrap();
            let (com, turn) = (s.com(), s.angular_momentum());
            match weight {
                Some(w) => {
                    qp.minimise(&com, &[0.1, 0.0, 2.0], &[w; 3]);
                    qp.minimise(&turn, &[0.0, 0.5, 0.0], &[w; 3]);
                }
                None => {
                    qp.hold(&com, &[0.1, 0.0, 2.0]).unwrap();
                    qp.hold(&turn, &[0.0, 0.5, 0.0]).unwrap();
                }
            }
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
            qp.minimise_forces(&[0.0; K], &[1e-3; K]);
            qp.limit_torques(&core::array::from_fn(|i| {
                [-1.0, 1.0].map(|x| x * MOTORS[i].torque)
            }))
            .unwrap();
            let verdict = oracle(&qp.problem());
            let answer = qp.solve().unwrap();
            let is_possible = verdict != Verdict::Infeasible;
            assert_eq!(answer.yielded == Yielded::Nothing, is_possible);
            assert!(is_possible || (weight.is_none() && answer.yielded == Yielded::Tasks));
            is_possible.then_some(answer.torques)
        };
        let Some(strict) = solve(None) else { return };
        held.set(held.get() + 1);
        let gap = |weight| {
            let torques = solve(Some(weight)).unwrap();
            let pairs = torques.iter().zip(&strict);
            pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
        };
        let gaps = [1e2, 1e4, 1e6].map(gap);
        assert!(
            gaps[1] < 0.1 * gaps[0] && gaps[2] < 0.1 * gaps[1],
            "{gaps:?}"
        );
    });
    assert!(held.get() >= 7, "{}", held.get());
}

/// A program of four levels.
type Levels = TorqueQp<f64, N, K, V, 67>;

/// Its tasks in a state: centre of mass, push, trunk, angular momentum.
struct Tasks {
    unit: f64,
    com: Task<f64, N, 3>,
    push: Task<f64, N, 3>,
    trunk: Task<f64, N, 3>,
    turn: Task<f64, N, 3>,
}

/// Up; then a push down that contradicts it, and a turn of the trunk; then the angular momentum.
const UP: [f64; 3] = [0.1, 0.0, 2.0];
const DOWN: [f64; 3] = [0.0, 3.0, -30.0];
const TILT: [f64; 3] = [0.3, 0.0, 0.0];
const SPIN: [f64; 3] = [0.0, 0.5, 0.0];

fn levels(s: &Snapshot<f64, N>) -> (Tasks, Levels) {
    let tasks = Tasks {
        unit: s.centroidal.mass * 0.981,
        com: s.com(),
        push: s.linear_momentum(),
        trunk: s.frame_orientation(&Icub23, &Frame::IDENTITY),
        turn: s.angular_momentum(),
    };
    let mut qp = Levels::new();
    qp.begin(&Icub23, s, &contacts(0.5), &[0.0; N]).unwrap();
    qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))
        .unwrap();
    (tasks, qp)
}

/// The posture, which comes last.
fn posture(qp: &mut Levels) {
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0; K], &[1e-3; K]);
}

/// Every level has a little cost on everything: without it most of its Hessian would be zero.
fn little(qp: &mut Levels) {
    qp.minimise_joints(&[0.0; N], &[1e-5; N]);
    qp.minimise_forces(&[0.0; K], &[1e-8; K]);
}

/// Solves a level, whose cost must be Clarabel's.
fn optimum(qp: &mut Levels, unit: f64) -> TorqueAnswer<f64, N, K> {
    let wanted = oracle(&qp.problem()).cost().unwrap();
    let answer = qp.solve().unwrap();
    assert_eq!(answer.yielded, Yielded::Nothing);
    let z = core::array::from_fn(|i| match i {
        0..N => answer.acceleration.joints[i],
        _ => answer.forces[i - N] / unit,
    });
    let cost = qp.problem().cost(&z);
    let scale = 1.0 + wanted.abs();
    assert!((cost - wanted).abs() < 1e-5 * scale, "{cost} {wanted}");
    answer
}

/// Level after level, each held at what it reached.
fn strictly(tasks: &Tasks, qp: &mut Levels) -> TorqueAnswer<f64, N, K> {
    let (com, trunk, turn) = (&tasks.com, &tasks.trunk, &tasks.turn);
    little(qp);
    qp.minimise(com, &UP, &[1.0; 3]);
    let first = com.reached(&optimum(qp, tasks.unit).acceleration);
    assert!(first.iter().zip(&UP).all(|(a, b)| (a - b).abs() < 1e-2));
    qp.hold(com, &first).unwrap();
    qp.next_level();
    little(qp);
    qp.minimise(&tasks.push, &DOWN, &[1e-3; 3]);
    qp.minimise(trunk, &TILT, &[1.0; 3]);
    let second = trunk.reached(&optimum(qp, tasks.unit).acceleration);
    qp.hold(trunk, &second).unwrap();
    qp.next_level();
    little(qp);
    qp.minimise(turn, &SPIN, &[1.0; 3]);
    let third = turn.reached(&optimum(qp, tasks.unit).acceleration);
    qp.hold(turn, &third).unwrap();
    qp.next_level();
    posture(qp);
    let strict = optimum(qp, tasks.unit);
    for (task, value) in [(com, first), (trunk, second), (turn, third)] {
        let now = task.reached(&strict.acceleration);
        assert!(now.iter().zip(&value).all(|(a, b)| (a - b).abs() < 1e-6));
    }
    strict
}

/// What the levels cost, the posture last.
fn costs(tasks: &Tasks, a: &TorqueAnswer<f64, N, K>) -> [f64; 4] {
    let miss = |task: &Task<f64, N, 3>, wanted: &[f64; 3]| -> f64 {
        let now = task.reached(&a.acceleration);
        0.5 * now
            .iter()
            .zip(wanted)
            .map(|(a, b)| (a - b) * (a - b))
            .sum::<f64>()
    };
    let [joints, forces] = efforts(a);
    [
        miss(&tasks.com, &UP),
        1e-3 * miss(&tasks.push, &DOWN) + miss(&tasks.trunk, &TILT),
        miss(&tasks.turn, &SPIN),
        joints + 1e-3 * forces,
    ]
}

/// ½ Σ q̈², ½ Σ f².
fn efforts(a: &TorqueAnswer<f64, N, K>) -> [f64; 2] {
    [&a.acceleration.joints[..], &a.forces[..]].map(|x| 0.5 * x.iter().map(|x| x * x).sum::<f64>())
}

/// All levels at once, each with w times the next one's weight.
fn weighed(tasks: &Tasks, qp: &mut Levels, w: f64) -> TorqueAnswer<f64, N, K> {
    qp.minimise(&tasks.com, &UP, &[w * w * w; 3]);
    qp.minimise(&tasks.push, &DOWN, &[1e-3 * w * w; 3]);
    qp.minimise(&tasks.trunk, &TILT, &[w * w; 3]);
    qp.minimise(&tasks.turn, &SPIN, &[w; 3]);
    posture(qp);
    qp.solve().unwrap()
}

/// Four levels of strict priority, the second against the first: each level's cost is Clarabel's least, no level spoils
/// one before it, and weights that grow by the same factor from level to level tend to the same torques.
///
/// What the weighed optimum is, is a law in each state: not dearer by its weights than the strict one, which is a point of its program, so
/// that it is within 1/w of the others' costs of the first level; and not better than the strict one in that level but by what little cost
/// on everything makes of it. How fast torques follow is none: where levels compete for the same ones, a factor of ten in w takes half
/// of the way in some states and a quarter in others.
#[test]
fn levels_are_optimal_one_after_the_other() {
    let sums = RefCell::new([0.0; 3]);
    each(config(8, 8), &crouch(0.1, 0.3), |(q, v)| {
        let s = snapshot(&q, &v);
        let (tasks, mut qp) = levels(&s);
        let strict = strictly(&tasks, &mut qp);
        let wanted = costs(&tasks, &strict);
        for (sum, w) in sums.borrow_mut().iter_mut().zip([1e1, 1e2, 1e3]) {
            let (tasks, mut qp) = levels(&s);
            let answer = weighed(&tasks, &mut qp, w);
            let found = costs(&tasks, &answer);
            let total = |c: &[f64; 4]| c[0] + (c[1] + (c[2] + c[3] / w) / w) / w;
            assert!(
                total(&found) <= total(&wanted) * (1.0 + 1e-6),
                "{w}: {found:?} {wanted:?}"
            );
            let [joints, forces] = efforts(&answer);
            let little = 1e-5 * joints + 1e-8 * forces;
            assert!(
                wanted[0] <= found[0] + little + 1e-6,
                "{w}: {found:?} {wanted:?} {little}"
            );
            let pairs = answer.torques.iter().zip(&strict.torques);
            *sum += pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        }
    });
    let sums = sums.into_inner();
    assert!(sums[1] < sums[0] && sums[2] < sums[1], "{sums:?}");
}

/// A held task that limits make impossible yields, is reported, and everything harder stays.
#[test]
fn a_held_task_yields_before_limits_and_contacts() {
    each(config(8, 6), &crouch(0.05, 0.0), |(q, v)| {
        let s = snapshot(&q, &v);
        let mut qp = TorqueQp::<f64, N, K, V, M>::new();
        qp.begin(&Icub23, &s, &contacts(0.5), &[0.0; N]).unwrap();
        // No ground pulls a robot down at 3 g.
        qp.hold(&s.com(), &[0.0, 0.0, -30.0]).unwrap();
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.minimise_forces(&[0.0; K], &[1e-3; K]);
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Tasks);
        assert!(answer.contact_violation < 1e-6);
        let reached = s.com().of(&answer.acceleration)[2];
        assert!(reached < -5.0 && reached > -9.82, "{reached}");
    });
}

/// States and targets far from any jump under every cap: a command inside its limits, honest about the cap, optimal where it was not
/// needed; and the next ticks find the optimum of where they begin.
#[test]
fn a_capped_command_is_inside_its_limits() {
    let (capped, whole) = (Cell::new(0), Cell::new(0));
    let state = prop_oneof![1 => crouch(0.1, 0.3), 2 => crouch(0.5, 8.0)];
    each(config(120, 12), &(state, up()), |((q, v), up)| {
        let s = snapshot(&q, &v);
        let solve = |qp: &mut TorqueQp<f64, N, K, V, M>| {
            program(qp, &s, &up, 0.6);
            qp.solve().unwrap()
        };
        let best = solve(&mut TorqueQp::new());
        assert!(!best.capped);
        for max_steps in [0, 2, 5, 10, 20, 40, 80, 160] {
            let mut qp = TorqueQp::new();
            qp.max_steps = max_steps;
            let a = solve(&mut qp);
            for (i, (tau, motor)) in a.torques.iter().zip(&MOTORS).enumerate() {
                let [low, high] = torque_range(motor, v.joints[i], f64::INFINITY);
                assert!(tau.is_finite());
                assert!(
                    *tau >= 0.6 * low - 1e-6 && *tau <= 0.6 * high + 1e-6,
                    "{tau}"
                );
            }
            if a.capped {
                capped.set(capped.get() + 1);
                // It goes on where it ended; with time enough, to the end.
                let start = a.yielded;
                qp.max_steps = u32::MAX;
                let next = solve(&mut qp);
                assert!(!next.capped && next.yielded >= start);
            } else {
                whole.set(whole.get() + 1);
                assert_eq!(a.yielded, best.yielded);
                for (x, y) in a.torques.iter().zip(&best.torques) {
                    assert!((x - y).abs() < 1e-5, "{x} {y}");
                }
            }
        }
    });
    let (capped, whole) = (capped.get(), whole.get());
    assert!(capped > 100 && whole > 100, "{capped} {whole}");
}

/// What had yielded where the cap ended a tick comes back as soon as nothing is missed: the second tick of a calm stand is that of a
/// program without a past.
#[test]
fn what_yielded_at_the_cap_comes_back() {
    each(config(3, 14), &(crouch(0.1, 0.3), up()), |((q, v), up)| {
        let s = snapshot(&q, &v);
        // Soles shall fly apart, for which there is no torque; some caps end the tick after something has yielded to that.
        let apart = core::array::from_fn(|k| [500.0, -500.0][k / 6]);
        let mut qp = TorqueQp::new();
        let ended = (0..1000).step_by(10).find(|cap| {
            qp = TorqueQp::new();
            qp.max_steps = *cap;
            program(&mut qp, &s, &up, 1.0);
            qp.correct_contacts(&apart);
            let answer = qp.solve().unwrap();
            answer.capped && answer.yielded == Yielded::Contacts
        });
        assert!(ended.is_some());
        qp.max_steps = u32::MAX;
        let (q, v) = crouched(&[0.0; N], &[0.0; N]);
        let calm = snapshot(&q, &v);
        let stand = |qp: &mut TorqueQp<f64, N, K, V, M>| {
            program(qp, &calm, &[0.0; 3], 1.0);
            qp.solve().unwrap()
        };
        let first = stand(&mut qp);
        assert_eq!(first.yielded, Yielded::Contacts);
        assert!(first.contact_violation < 0.1 && first.limit_violation < 0.1);
        let (second, fresh) = (stand(&mut qp), stand(&mut TorqueQp::new()));
        assert_eq!(second.yielded, Yielded::Nothing);
        for (x, y) in second.torques.iter().zip(&fresh.torques) {
            assert!((x - y).abs() < 1e-6, "{x} {y}");
        }
    });
}

/// From here upwards.
fn rising<T: so3::Scalar>(position_w: nalgebra::Vector3<T>) -> ComReference<T> {
    ComReference {
        position_w,
        velocity_w: nalgebra::Vector3::z() * T::of(0.1),
        acceleration_w: nalgebra::Vector3::z() * T::TWO,
    }
}

/// States are drawn here, not moved to: nothing moves the robot besides.
fn strict<T: so3::Scalar>() -> TorqueJumpSettings<T, N> {
    TorqueJumpSettings {
        strict: true,
        surplus_gain: T::ZERO,
        ..profile::TORQUE.cast()
    }
}

#[test]
fn single_precision_follows() {
    let controllers = RefCell::new((
        TorqueJump::<f64, N, K, V, M>::new(strict(), [0.0; N]),
        TorqueJump::<f32, N, K, V, M>::new(strict(), [0.0; N]),
    ));
    let f = |x: f64| x as f32;
    let soles = SOLES_F32.map(|sole| Contact::new(&sole, 0.5, 1000.0));
    each(config(30, 4), &crouch(0.02, 0.1), |(q, v)| {
        let (double, single) = &mut *controllers.borrow_mut();
        let s = snapshot(&q, &v);
        let (wanted, limits) = (rising(s.com_w()), (&LIMITS, &MOTORS));
        let a = double
            .tick(&Icub23, &s, &contacts(0.5), limits, &wanted, 1e-3)
            .unwrap();
        let (q, v) = anchored(
            &Icub23,
            &q.joints.map(f),
            &v.joints.map(f),
            &soles[0].frame,
            &Transform::IDENTITY,
        );
        let mut s = Snapshot::<f32, N>::ZERO;
        s.update(&Icub23, &q, &v);
        let wanted = rising(s.com_w());
        let limits = (&LIMITS_F32, &MOTORS_F32);
        let b = single.tick(&Icub23, &s, &soles, limits, &wanted, 1e-3);
        for (x, y) in a.answer.torques.iter().zip(b.unwrap().answer.torques) {
            assert!((x - f64::from(y)).abs() < 0.05, "{x} {y}");
        }
    });
}
