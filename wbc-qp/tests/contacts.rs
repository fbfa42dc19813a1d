//! Contacts on inclined ground, polygons, feedback, and what is refused.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use crate::common::{M, N, VELOCITY_ROWS, config, each, snapshot};
use a1_model::{A1, FEET, FOOT_RADIUS};
use core::cell::Cell;
use core::f64::consts::{PI, TAU};
use icub_model::{Icub23, SOLES};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use rbd_core::{Configuration, ContactShape, Frame, Tangent, Transform, integrate, rnea};
use so3::math;
use wbc_qp::{
    Contact, Error, Extent, Limit, Patch, Rank, Snapshot, TorqueQp, VelocityQp, Yielded, anchored,
};

/// Standing A1, turned and moved as a whole by `ground`.
fn standing(ground: &Transform<f64>) -> Snapshot<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
    q.base = *ground;
    let mut v = Tangent::ZERO;
    v.joints = core::array::from_fn(|i| 0.1 * (i as f64 - 5.0));
    let mut s = Snapshot::ZERO;
    s.update(&A1, &q, &v);
    s
}

fn feet(normal: Vector3<f64>) -> [Contact<f64>; 4] {
    FEET.map(|foot| Contact::ball(&foot.frame, FOOT_RADIUS, normal, 0.5, 300.0))
}

/// A turned world is the same world but for gravity: rows of contacts and cones turn with the plane.
#[test]
fn velocities_do_not_see_how_the_ground_is_inclined() {
    let solve = |turn: Rotation3<f64>| {
        let s = standing(&Transform::new(turn, Vector3::new(0.1, 0.2, 0.3)));
        let normal = turn * Vector3::z();
        let mut qp = VelocityQp::<f64, 12, 18, 15>::new();
        qp.begin(&A1, &s, &feet(normal)).unwrap();
        let up: [f64; 3] = (normal * 0.1).into();
        qp.minimise(&s.com(), &up, &[1e4; 3]);
        qp.minimise_joints(&[0.0; 12], &[1.0; 12]);
        qp.solve().unwrap().velocity
    };
    let level = solve(Rotation3::identity());
    for turn in [
        [0.3, 0.0, 0.0],
        [0.0, -0.5, 0.2],
        [2.0, 1.0, 0.3],
        [3.1, 0.1, 0.0],
    ] {
        let turned = solve(so3::exp(&Vector3::from(turn)));
        for (a, b) in level.joints.iter().zip(&turned.joints) {
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
    }
}

/// On a slope steeper than friction allows contacts yield, on one below it they hold: the cone stands on the plane's normal, and
/// the inscribed pyramid gives up earlier on a diagonal.
#[test]
fn friction_is_that_of_the_plane() {
    let holds = |degrees: f64, about: [f64; 2], inscribed: bool| {
        let axis = Vector3::new(about[0], about[1], 0.0).normalize();
        let turn = so3::exp(&(axis * degrees.to_radians()));
        let mut q = Configuration::NEUTRAL;
        q.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
        q.base = Transform::new(turn, Vector3::zeros());
        let mut s = Snapshot::<f64, 12>::ZERO;
        s.update(&A1, &q, &Tangent::ZERO);
        let mut qp = TorqueQp::<f64, 12, 12, 24, 46>::new();
        let contacts = feet(turn * Vector3::z()).map(|c| if inscribed { c.inscribed() } else { c });
        qp.begin(&A1, &s, &contacts, &[0.0; 12]).unwrap();
        // At rest: all of the weight is carried.
        qp.constrain(&s.com(), &[0.0; 3], &[0.0; 3], Rank::Task)
            .unwrap();
        qp.minimise_joints(&[0.0; 12], &[1.0; 12]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        let answer = qp.solve().unwrap();
        // The equations of motion, with forces from their coordinates.
        let mut rest = rnea(&A1, &s.posture, &s.velocity, &answer.acceleration).base;
        for (contact, f) in contacts.iter().zip(answer.forces.chunks(3)) {
            let (point, f) = contact.wrench_w(&s, [f[0], f[1], f[2], 0.0, 0.0, 0.0]);
            let arm = q.base.inverse().point(&point);
            let f = turn.inverse() * f.linear;
            rest = rest - rbd_core::Force::new(f, arm.cross(&f));
        }
        assert!(rest.to_array().iter().all(|x| x.abs() < 1e-8), "{rest:?}");
        answer.yielded == Yielded::Nothing
    };
    // atan 0.5 = 26.6°.
    assert!(holds(25.0, [1.0, 0.0], false) && !holds(28.0, [1.0, 0.0], false));
    // Along a diagonal the pyramid reaches to atan 0.707 = 35.3°, the inscribed one to 26.6°.
    assert!(holds(33.0, [1.0, 1.0], false) && !holds(37.0, [1.0, 1.0], false));
    assert!(holds(25.0, [1.0, 1.0], true) && !holds(28.0, [1.0, 1.0], true));
}

/// The pyramid is the same to either side of both tangents: a force is allowed exactly where neither of its tangential parts is larger
/// than μ times the normal one.
#[test]
fn the_pyramid_has_four_sides() {
    let foot = Contact::ball(&FEET[0].frame, FOOT_RADIUS, Vector3::z(), 0.5, 300.0);
    let forces = [-1.0..1.0, -1.0..1.0, -0.5..1.5_f64];
    let friction = 0.1..1.0_f64;
    each(config(1000, 33), &(forces, friction), |(f, friction)| {
        let foot = Contact { friction, ..foot };
        let is_allowed = (0..).map_while(|k| foot.cone(k)).all(|row| {
            let value: f64 = row.iter().zip(&f).map(|(a, f)| a * f).sum();
            value <= 0.0
        });
        let [x, y, z] = f;
        assert_eq!(is_allowed, x.abs().max(y.abs()) <= friction * z, "{f:?}");
    });
}

static SQUARE: [[f64; 2]; 4] = [[0.1, -0.04], [0.1, 0.06], [-0.05, 0.06], [-0.05, -0.04]];
/// There and back: both corners turn left, by half a turn.
static TWO: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 1.0]];
static TRIANGLE: [[f64; 2]; 3] = [[0.1, 0.0], [-0.05, 0.05], [-0.05, -0.05]];
static STAR: [[f64; 2]; 5] = [
    [1.0, 0.0],
    [-0.8, 0.6],
    [0.3, -0.95],
    [0.3, 0.95],
    [-0.8, -0.6],
];
static CLOCKWISE: [[f64; 2]; 3] = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];

/// A polygon of four is the rectangle; of three, a wrench is allowed exactly where its centre of pressure is inside.
#[test]
fn a_polygon_bounds_the_centre_of_pressure() {
    let frame = SOLES[0].frame;
    let square = Contact::polygon(&frame, &SQUARE, 0.5, 100.0).unwrap();
    let rectangle = rbd_core::Contact {
        name: "",
        frame,
        shape: ContactShape::Rectangle {
            x: [-0.05, 0.1],
            y: [-0.04, 0.06],
        },
    };
    let rectangle = Contact::new(&rectangle, 0.5, 100.0);
    let allowed = |contact: &Contact<f64>, f: &[f64; 6]| {
        let rows = (0..).map_while(|k| contact.cone(k));
        rows.fold(f64::NEG_INFINITY, |m, row| {
            m.max(row.iter().zip(f).map(|(a, b)| a * b).sum())
        }) <= 0.0
    };
    assert!((square.yaw - rectangle.yaw).abs() < 1e-15);
    let triangle = Contact::polygon(&frame, &TRIANGLE, 0.5, 100.0).unwrap();
    let inside = [const { Cell::new(0) }; 2];
    let unit = || -1.0..1.0_f64;
    let places = (unit(), unit()).prop_map(|(x, y)| (0.15 * x, 0.1 * y));
    let wrenches = (places, [unit(), unit(), unit()]);
    each(
        config(20_000, 31),
        &wrenches,
        |((x, y), [side, across, yaw])| {
            let f = [10.0 * side, 10.0 * across, 30.0, 30.0 * y, -30.0 * x, yaw];
            assert_eq!(allowed(&square, &f), allowed(&rectangle, &f));
            inside[0].set(inside[0].get() + u32::from(allowed(&square, &f)));
            // No tangential force and no yaw: the triangle alone decides.
            let f = [0.0, 0.0, 30.0, f[3], f[4], 0.0];
            let is_inside = x > -0.05 && y.abs() < (0.1 - x) / 3.0;
            assert_eq!(allowed(&triangle, &f), is_inside, "{x} {y}");
            inside[1].set(inside[1].get() + u32::from(is_inside));
        },
    );
    let inside = inside.map(|count| count.get());
    assert!(inside[0] > 1000 && inside[1] > 1000, "{inside:?}");
    for vertices in [&STAR[..], &CLOCKWISE, &SQUARE[..2], &TWO, &[]] {
        assert_eq!(
            Contact::polygon(&frame, vertices, 0.5, 1.0),
            Err(Error::NotConvex)
        );
    }
}

/// A round sole is a polygon of many corners: taken in every size, with the yaw moment of a square of its perimeter, and refused where it
/// goes around twice.
#[test]
fn a_round_sole_has_many_corners() {
    let around = |radius: f64, corners: u32, turns: u32| -> &'static [[f64; 2]] {
        let corner = |i| {
            let angle = TAU * f64::from(turns * i) / f64::from(corners);
            let (sin, cos) = math::sin_cos(angle);
            [radius * cos, radius * sin]
        };
        (0..corners).map(corner).collect::<Vec<_>>().leak()
    };
    let frame = SOLES[0].frame;
    for (radius, corners) in [(1e-3, 17), (0.05, 17), (0.05, 101), (10.0, 17)] {
        let round = Contact::polygon(&frame, around(radius, corners, 1), 0.5, 1.0).unwrap();
        let corners_on_it = f64::from(corners);
        let half = corners_on_it * radius * math::sin(PI / corners_on_it) / 4.0;
        let square = rbd_core::Contact {
            name: "",
            frame,
            shape: ContactShape::Rectangle {
                x: [-half, half],
                y: [-half, half],
            },
        };
        let square = Contact::new(&square, 0.5, 1.0);
        assert!((round.yaw / square.yaw - 1.0).abs() < 1e-12);
        let twice = Contact::polygon(&frame, around(radius, corners, 2), 0.5, 1.0);
        assert_eq!(twice, Err(Error::NotConvex));
    }
}

/// A foot in the air changes nothing for the others, wherever it stands among them, and is not missed.
#[test]
fn the_order_of_feet_is_no_matter() {
    let s = standing(&Transform::IDENTITY);
    let solve = |order: [usize; 4]| {
        let mut all = feet(Vector3::z());
        all[1].load = 0.0;
        let contacts = order.map(|i| all[i]);
        let mut qp = TorqueQp::<f64, 12, 12, 24, 46>::new();
        qp.begin(&A1, &s, &contacts, &[0.0; 12]).unwrap();
        qp.minimise(&s.com(), &[0.5, 0.5, 0.0], &[1e3; 3]);
        qp.minimise(&s.angular_momentum(), &[0.0; 3], &[1e3; 3]);
        qp.minimise_joints(&[0.0; 12], &[1.0; 12]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing);
        for line in qp.report(&answer, 0.0) {
            if let (Limit::Contact(k), Extent::Missed(_)) = (line.limit, line.extent) {
                assert!(order[k] != 1, "{line:?}");
            }
        }
        let mut forces = [[0.0; 3]; 4];
        for (i, f) in order.into_iter().zip(answer.forces.chunks(3)) {
            forces[i].copy_from_slice(f);
        }
        forces
    };
    let first = solve([1, 0, 2, 3]);
    let last = solve([0, 2, 3, 1]);
    let middle = solve([3, 1, 0, 2]);
    assert_eq!(first[1], [0.0; 3]);
    assert!(first[0][0].abs() > 0.1 && first[3][1].abs() > 0.1);
    for (i, f) in first.iter().enumerate() {
        for (k, x) in f.iter().enumerate() {
            assert!((x - last[i][k]).abs() < 1e-6 && (x - middle[i][k]).abs() < 1e-6);
        }
    }
}

/// The error's rate along a motion is minus the contact's velocity, and in both programs a displaced sole goes back.
#[test]
fn contacts_go_back_to_where_they_were() {
    let shifts = prop::array::uniform::<_, 12>(-0.02..0.02_f64);
    each(config(2, 32), &shifts, |shifts| {
        let mut q = [0.0; N];
        for leg in [0, 6] {
            (q[leg], q[leg + 3], q[leg + 4]) = (1.2, -1.7, -0.7);
        }
        let (q, v) = anchored(
            &Icub23,
            &q,
            &[0.0; N],
            &SOLES[0].frame,
            &Transform::IDENTITY,
        );
        let home = snapshot(&q, &v);
        let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0));
        let places = contacts.map(|c| home.pose(&c.frame));
        let mut q = q;
        for (x, shift) in q.joints.iter_mut().zip(shifts) {
            *x += shift;
        }
        let miss = |s: &Snapshot<f64, N>| {
            let each = contacts
                .iter()
                .zip(&places)
                .flat_map(|(c, at)| c.error(s, at));
            each.collect::<Vec<f64>>()
        };
        let size = |e: &[f64]| e.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let before = size(&miss(&snapshot(&q, &v)));
        let mut qp = VelocityQp::<f64, N, 29, VELOCITY_ROWS>::new();
        for _ in 0..100 {
            let s = snapshot(&q, &Tangent::ZERO);
            qp.begin(&Icub23, &s, &contacts).unwrap();
            let wanted: Vec<f64> = miss(&s).iter().map(|e| 5.0 * e).collect();
            qp.correct_contacts(&wanted);
            qp.minimise_joints(&[0.0; N], &[1.0; N]);
            let answer = qp.solve().unwrap();
            assert_eq!(answer.yielded, Yielded::Nothing);
            q = integrate(&q, &(answer.velocity * 0.01));
        }
        let after = size(&miss(&snapshot(&q, &v)));
        assert!(before > 0.005 && after < 0.02 * before, "{before} {after}");

        // At the level of torques: the acceleration asked for is had.
        let s = snapshot(&q, &Tangent::ZERO);
        let mut qp = TorqueQp::<f64, N, 12, 35, M>::new();
        qp.begin(&Icub23, &s, &contacts, &[0.0; N]).unwrap();
        let wanted = core::array::from_fn(|k| 0.1 * (k as f64 - 6.0));
        qp.correct_contacts(&wanted);
        qp.minimise_joints(&[0.0; N], &[1.0; N]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        let answer = qp.solve().unwrap();
        assert!(answer.contact_violation < 1e-7);
        let sole = s.frame_pose(&Icub23, &SOLES[0].frame);
        let rotation = s.pose(&SOLES[0].frame).rotation;
        let linear = sole.select([0, 1, 2]).in_axes(&rotation);
        for (a, b) in linear.reached(&answer.acceleration).iter().zip(&wanted) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    });
}

#[test]
fn forces_that_contradict_each_other_are_refused() {
    let s = standing(&Transform::IDENTITY);
    let mut contacts = feet(Vector3::z());
    contacts[2].min_force = 301.0;
    let mut qp = TorqueQp::<f64, 12, 12, 24, 46>::new();
    let refused = Err(Error::NormalForces { contact: 2 });
    assert_eq!(qp.begin(&A1, &s, &contacts, &[0.0; 12]), refused);
    contacts[2].min_force = f64::NAN;
    assert_eq!(qp.begin(&A1, &s, &contacts, &[0.0; 12]), refused);
    let frame: Frame<f64> = contacts[0].frame;
    assert!(matches!(
        Contact::ball(&frame, 0.02, Vector3::z(), 0.5, 1.0).shape,
        Patch::Ball { .. }
    ));
}
