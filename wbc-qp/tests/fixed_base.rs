//! Both programs on an arm that is bolted to the world, beside the recursive dynamics.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use nalgebra::Vector3;
use rbd_core::joint::Kind;
use rbd_core::{
    Axes, BaseBody, BaseKind, Body, Configuration, Contact, ContactShape, Effort, Force, Frame,
    FrameJacobian, JointLimits, Link, TableModel, Tangent, frame_jacobian, rnea,
};
use wbc_qp::{
    Error, Extent, Horizon, Limit, Limited, Rank, Side, Snapshot, TorqueQp, VelocityQp, Yielded,
};

const N: usize = 4;
type Arm = TableModel<f64, N>;

/// A turntable and three rods of 2 kg and 0.3 m.
fn arm() -> Arm {
    mounted(Link::Joint(2), 0.3)
}

/// The last rod on this link, at this x.
fn mounted(last: Link, x: f64) -> Arm {
    let base = BaseBody {
        mass: 30.0,
        first: [1.0, 2.0, 3.0],
        second: [5.0, 5.0, 5.0, 0.0, 0.0, 0.0],
    };
    let turntable = Body {
        kind: Kind::RevoluteZ,
        mass: 1.0,
        second: [0.002, 0.002, 0.002, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let rod = |parent, x| Body {
        kind: Kind::RevoluteY,
        parent,
        offset: [x, 0.0, 0.1],
        mass: 2.0,
        first: [0.3, 0.0, 0.0],
        second: [0.06, 0.001, 0.001, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    Arm::new(
        BaseKind::Fixed,
        base,
        &[
            turntable,
            rod(Link::Joint(0), 0.0),
            rod(Link::Joint(1), 0.3),
            rod(last, x),
        ],
    )
    .unwrap()
}

const TOOL: Frame<f64> = Frame {
    link: Link::Joint(3),
    offset: [0.3, 0.0, 0.0],
    ..Frame::IDENTITY
};

fn state() -> Snapshot<f64, N> {
    let mut q = Configuration::NEUTRAL;
    q.joints = [0.3, -0.8, 1.2, 0.4];
    let mut v = Tangent::ZERO;
    v.joints = [0.5, -0.4, 0.3, 0.9];
    let mut s = Snapshot::ZERO;
    s.update(&arm(), &q, &v);
    s
}

#[test]
fn torques_are_those_of_the_inverse_dynamics() {
    let s = state();
    let mut qp = TorqueQp::<f64, N, 0, N, 7>::new();
    qp.begin(&arm(), &s, &[], &[0.0; N]).unwrap();
    let tool = s.frame_position(&arm(), &TOOL);
    qp.hold(&tool, &[0.5, -0.3, 1.0]).unwrap();
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    let answer = qp.solve().unwrap();
    assert_eq!(answer.yielded, Yielded::Nothing);
    let reached = tool.reached(&answer.acceleration);
    for (a, b) in reached.iter().zip([0.5, -0.3, 1.0]) {
        assert!((a - b).abs() < 1e-9, "{reached:?}");
    }
    assert_eq!(answer.acceleration.base.to_array(), [0.0; 6]);
    let wanted = rnea(&arm(), &s.posture, &s.velocity, &answer.acceleration);
    for (a, b) in answer.torques.iter().zip(&wanted.joints) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
    // Holding up the arm takes torque.
    assert!(answer.torques[1].abs() > 5.0);
}

/// The tool leans on a table: M q̈ + h = τ + Jᵀ f, the force inside its cone, the tool at rest.
#[test]
fn a_contact_of_an_arm() {
    let s = state();
    let ball = Contact {
        name: "tool",
        frame: TOOL,
        shape: ContactShape::Sphere { radius: 0.0 },
    };
    let contact = wbc_qp::Contact::new(&ball, 0.5, 50.0);
    let mut qp = TorqueQp::<f64, N, 3, 7, 14>::new();
    qp.begin(&arm(), &s, &[contact], &[0.0; N]).unwrap();
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0, 0.0, 20.0], &[1.0; 3]);
    let answer = qp.solve().unwrap();
    assert!(answer.contact_violation < 1e-9);
    assert!((answer.forces[2] - 20.0).abs() < 1e-6);
    let mut j = FrameJacobian::ZERO;
    let axes = Axes::LocalWorldAligned;
    frame_jacobian(&arm(), &s.kinematics, &TOOL, axes, &mut j);
    let [x, y, z] = answer.forces;
    let pushed: Effort<f64, N> = j.tr_mul(&Force::from_array([x, y, z, 0.0, 0.0, 0.0]));
    let wanted = rnea(&arm(), &s.posture, &s.velocity, &answer.acceleration);
    for i in 0..N {
        let rest = wanted.joints[i] - pushed.joints[i] - answer.torques[i];
        assert!(rest.abs() < 1e-9, "{rest}");
    }
}

/// The tool as a point on a table, with forces of up to 50 N.
fn leaning() -> wbc_qp::Contact<f64> {
    wbc_qp::Contact::ball(&TOOL, 0.0, Vector3::z(), 0.5, 50.0)
}

/// A contact that still moves is braked at the rate of its damping: what it accelerates by is −k times its velocity.
#[test]
fn a_contact_that_moves_is_braked() {
    let s = state();
    let tool = s.frame_position(&arm(), &TOOL);
    assert!(tool.rate.iter().all(|x| x.abs() > 0.05), "{:?}", tool.rate);
    for damping in [0.0, 5.0, 20.0] {
        let mut qp = TorqueQp::<f64, N, 3, 7, 14>::new();
        qp.contact_damping = damping;
        qp.begin(&arm(), &s, &[leaning()], &[0.0; N]).unwrap();
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.minimise_forces(&[0.0; 3], &[1.0; 3]);
        let answer = qp.solve().unwrap();
        let reached = tool.reached(&answer.acceleration);
        for (a, rate) in reached.iter().zip(&tool.rate) {
            assert!((a + damping * rate).abs() < 1e-9, "{a} {rate}");
        }
    }
}

/// A normal force that is to be less than its least is the least, and one that is to be more than its largest is the largest, of which
/// a contact of half its load has half.
#[test]
fn a_normal_force_stays_in_its_range() {
    let s = state();
    let cases = [
        (5.0, 1.0, 0.0, 5.0),
        (40.0, 1.0, 0.0, 40.0),
        (40.0, 1.0, 45.0, 45.0),
        (40.0, 1.0, 60.0, 50.0),
        (5.0, 0.5, 0.0, 5.0),
        (5.0, 0.5, 60.0, 25.0),
        (40.0, 0.5, 0.0, 25.0),
    ];
    for (min_force, load, asked, wanted) in cases {
        let contact = wbc_qp::Contact {
            min_force,
            load,
            ..leaning()
        };
        let mut qp = TorqueQp::<f64, N, 3, 7, 14>::new();
        qp.begin(&arm(), &s, &[contact], &[0.0; N]).unwrap();
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.minimise_forces(&[0.0, 0.0, asked], &[1.0; 3]);
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing);
        let force = answer.forces[2];
        assert!((force - wanted).abs() < 1e-6, "{force}, not {wanted}");
    }
}

/// A force that is to leave the friction pyramid ends on it, and the report names the contact's cone and nothing else, whichever side it
/// is.
#[test]
fn every_side_of_the_pyramid_is_named() {
    let s = state();
    for asked in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
        let mut qp = TorqueQp::<f64, N, 3, 7, 14>::new();
        qp.begin(&arm(), &s, &[leaning()], &[0.0; N]).unwrap();
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        let [x, y] = asked.map(|share| 30.0 * share);
        qp.minimise_forces(&[x, y, 20.0], &[1.0; 3]);
        let answer = qp.solve().unwrap();
        let [x, y, z] = answer.forces;
        let along = x * asked[0] + y * asked[1];
        assert!(z > 1.0 && (along - 0.5 * z).abs() < 1e-6, "{along} {z}");
        let cone = Limited {
            limit: Limit::Cone(0),
            extent: Extent::Held(Side::Upper),
        };
        let lines: Vec<_> = qp.report(&answer, 1e-6).collect();
        assert_eq!(lines, [cone], "{asked:?}");
    }
}

/// The iterations that an answer tells are those that the cap counts: as many are enough, and with one less the search ends without
/// an answer.
#[test]
fn as_many_iterations_as_an_answer_tells_are_enough() {
    let s = state();
    let solve = |cap: u32| {
        let mut qp = TorqueQp::<f64, N, 0, N, 7>::new();
        qp.settings.max_iterations = cap;
        qp.begin(&arm(), &s, &[], &[0.0; N]).unwrap();
        let tool = s.frame_position(&arm(), &TOOL);
        qp.minimise(&tool, &[30.0, 0.0, 40.0], &[1e3; 3]);
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.limit_torques(&[[-20.0, 20.0]; N]).unwrap();
        qp.solve()
    };
    let answer = solve(1000).unwrap();
    let enough = answer.iterations;
    assert!(answer.yielded == Yielded::Nothing && enough > 0);
    assert_eq!(solve(enough).unwrap(), answer);
    assert!(matches!(solve(enough - 1), Err(Error::Unsolved(_))));
}

#[test]
fn a_torque_limit_is_kept_and_named() {
    let s = state();
    let mut qp = TorqueQp::<f64, N, 0, N, 7>::new();
    qp.begin(&arm(), &s, &[], &[0.0; N]).unwrap();
    qp.hold(&s.frame_position(&arm(), &TOOL), &[0.0, 0.0, 40.0])
        .unwrap();
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.limit_torques(&[[-20.0, 20.0]; N]).unwrap();
    let answer = qp.solve().unwrap();
    assert_eq!(answer.yielded, Yielded::Tasks);
    assert!(answer.torques.iter().all(|tau| tau.abs() < 20.0 + 1e-6));
    let named: Vec<Limit> = qp.report(&answer, 1e-6).map(|x| x.limit).collect();
    assert!(
        named.contains(&Limit::Torque(1)) && named.contains(&Limit::Row(2)),
        "{named:?}"
    );
}

/// Beside an arm that is too weak to keep its tip where it is stands a rod that has no part in that: its limit stays, though contacts,
/// which come after limits, yield.
#[test]
fn a_limit_without_a_part_in_it_does_not_yield() {
    let model = mounted(Link::Base, 1.0);
    let mut q = Configuration::NEUTRAL;
    q.joints = [0.3, -0.8, 1.2, 0.4];
    let mut s = Snapshot::ZERO;
    s.update(&model, &q, &Tangent::ZERO);
    let elbow = Frame {
        link: Link::Joint(2),
        ..TOOL
    };
    let contact = wbc_qp::Contact::ball(&elbow, 0.0, Vector3::z(), 0.5, 0.0);
    let mut qp = TorqueQp::<f64, N, 3, 7, 14>::new();
    qp.begin(&model, &s, &[contact], &[0.0; N]).unwrap();
    qp.limit_torques(&[1.0, 1.0, 1.0, 100.0].map(|most| [-most, most]))
        .unwrap();
    let height = s.frame_position(&model, &TOOL).select([2]);
    let free = [f64::NEG_INFINITY];
    qp.constrain(&height, &free, &[1.0], Rank::Limit).unwrap();
    qp.minimise(&height, &[3.0], &[1e3]);
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    qp.minimise_forces(&[0.0; 3], &[1.0; 3]);
    let answer = qp.solve().unwrap();
    assert_eq!(answer.yielded, Yielded::Contacts);
    assert!(answer.contact_violation > 1.0);
    let reached = height.reached(&answer.acceleration)[0];
    assert!((reached - 1.0).abs() < 1e-9, "{reached}");
    let held = Limited {
        limit: Limit::Row(0),
        extent: Extent::Held(Side::Upper),
    };
    assert!(qp.report(&answer, 1e-6).any(|line| line == held));
}

#[test]
fn the_velocity_program_leaves_the_base_alone() {
    let s = state();
    let mut qp = VelocityQp::<f64, N, 10, 3>::new();
    qp.begin(&arm(), &s, &[]).unwrap();
    let tool = s.frame_position(&arm(), &TOOL);
    qp.constrain(&tool, &[0.1, 0.0, 0.0], &[0.1, 0.0, 0.0], Rank::Task)
        .unwrap();
    qp.minimise_joints(&[0.0; N], &[1.0; N]);
    let horizon = Horizon {
        position: 0.02,
        velocity: 0.005,
        acceleration: 500.0,
    };
    qp.limit_joints(&s, &[JointLimits::NONE; N], &horizon);
    let answer = qp.solve().unwrap();
    assert_eq!(answer.velocity.base.to_array(), [0.0; 6]);
    assert!((tool.of(&answer.velocity)[0] - 0.1).abs() < 1e-9);
}
