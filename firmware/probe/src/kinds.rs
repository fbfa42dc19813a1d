//! A small robot with a joint of every kind: what A1 and iCub, all revolute and floating, leave out.

use rbd_core::Frame;
use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Link, bodies_f32};
use so3::Scalar;

const JOINTS: usize = 9;

/// A fixed base that carries two identical arms of two joints and one of five.
pub struct Kinds;

static BASE: BaseBody<f64> = BaseBody::<f64>::EMPTY;
static BASE_F32: BaseBody<f32> = BaseBody::<f32>::EMPTY;

const BODIES_F64: [Body<f64>; JOINTS] = [
    body(Kind::RevoluteX, Link::Base, 2),
    body(Kind::PrismaticY, Link::Joint(0), 2),
    body(Kind::RevoluteX, Link::Base, 4),
    body(Kind::PrismaticY, Link::Joint(2), 4),
    body(Kind::RevoluteTilted, Link::Base, 9),
    body(Kind::PrismaticX, Link::Joint(4), 9),
    body(Kind::RevoluteY, Link::Joint(5), 9),
    body(Kind::PrismaticTilted, Link::Joint(6), 9),
    body(Kind::RevoluteZ, Link::Joint(7), 9),
];
static BODIES: [Body<f64>; JOINTS] = BODIES_F64;
static BODIES_F32: [Body<f32>; JOINTS] = bodies_f32(&BODIES_F64);

/// A quarter of a kilogram's rod and ball, off the joint axis; tilted joints turn by 36.87° (3-4-5) about x.
const fn body(kind: Kind, parent: Link, subtree_end: usize) -> Body<f64> {
    let tilt = if kind.is_tilted() {
        [[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]]
    } else {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    };
    Body {
        kind,
        parent,
        subtree_end,
        sign: if kind.is_revolute() { 1.0 } else { -1.0 },
        offset: [0.05, -0.02, -0.2],
        tilt,
        mass: 0.25,
        first: [0.001, 0.002, -0.025],
        second: [0.0006, 0.0005, 0.0035, 0.00001, -0.0001, -0.0002],
        rotor_inertia: 0.0007,
    }
}

rbd_core::tree! {
    impl Tree<f64, 9> for Kinds {
        fixed, BASE, BODIES,
        2 * [RevoluteX, PrismaticY],
        1 * [RevoluteTilted, PrismaticX, RevoluteY, PrismaticTilted, RevoluteZ]
    }
}

rbd_core::tree! {
    impl Tree<f32, 9> for Kinds {
        fixed, BASE_F32, BODIES_F32,
        2 * [RevoluteX, PrismaticY],
        1 * [RevoluteTilted, PrismaticX, RevoluteY, PrismaticTilted, RevoluteZ]
    }
}

/// A tool on the last body of the long arm.
pub(crate) fn hand<T: Scalar>() -> Frame<T> {
    let [zero, one] = [T::ZERO, T::ONE];
    Frame {
        link: Link::Joint(JOINTS - 1),
        offset: [T::of(0.1), T::of(-0.05), T::of(0.02)],
        rotation: [[zero, -one, zero], [one, zero, zero], [zero, zero, one]],
    }
}
