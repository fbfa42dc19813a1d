//! The plan of `a1/double-backflip` in flash, in both scalars: a `static`, so it takes no memory of the controller.
//!
//! `plans/a1-double-backflip.bin` holds little-endian single-precision numbers: times of take-off, posing and touchdown;
//! weight; landing posture; height and near edge of the box behind which the robot lands; then
//! per node its time, rotation of the base by rows, its position, its velocity (linear, angular), positions, velocities and torques
//! of the joints, and the forces of the feet. They are those of `saltus run a1/double-backflip`.

#![allow(
    clippy::indexing_slicing,
    reason = "all of it is evaluated by the compiler, where an index out of range is an error"
)]

use jump_control::Node;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{Motion, Transform};

use crate::Real;

static BYTES: &[u8] = include_bytes!("../../plans/a1-double-backflip.bin");
const HEAD: usize = 18;
const NODE: usize = 67;
/// Nodes of the plan.
const COUNT: usize = (BYTES.len() / 4 - HEAD) / NODE;

/// Number `i` of the file.
const fn number(i: usize) -> f32 {
    f32::from_le_bytes([
        BYTES[4 * i],
        BYTES[4 * i + 1],
        BYTES[4 * i + 2],
        BYTES[4 * i + 3],
    ])
}

const fn numbers<const K: usize>(first: usize) -> [f64; K] {
    let mut out = [0.0; K];
    let mut i = 0;
    while i < K {
        out[i] = number(first + i) as f64;
        i += 1;
    }
    out
}

/// Take-off, posing, touchdown, s.
pub(super) const TIMES: [f64; 3] = numbers(0);
/// Weight that was planned with, N.
pub(super) const WEIGHT: f64 = number(3) as f64;
/// Joint positions before touchdown, rad.
pub(super) const LANDING: [f64; 12] = numbers(4);
/// Height of the box, and how far behind its middle it ends, m.
pub(super) const BOX: [f64; 2] = numbers(16);

/// A scalar in which the plan stands in flash.
pub trait Planned: Real {
    /// Its nodes.
    fn nodes() -> &'static [Node<Self, 12, 4>];
}

macro_rules! planned {
    ($($T:ident $TABLE:ident)*) => { $(
        static $TABLE: [Node<$T, 12, 4>; COUNT] = {
            const fn three(at: usize) -> Vector3<$T> {
                Vector3::new(number(at) as $T, number(at + 1) as $T, number(at + 2) as $T)
            }
            let mut nodes = [Node::<$T, 12, 4>::ZERO; COUNT];
            let mut k = 0;
            while k < COUNT {
                let at = HEAD + k * NODE;
                let node = &mut nodes[k];
                node.time = number(at) as $T;
                let matrix = Matrix3::new(
                    number(at + 1) as $T, number(at + 2) as $T, number(at + 3) as $T,
                    number(at + 4) as $T, number(at + 5) as $T, number(at + 6) as $T,
                    number(at + 7) as $T, number(at + 8) as $T, number(at + 9) as $T,
                );
                let rotation = Rotation3::from_matrix_unchecked(matrix);
                node.base = Transform::new(rotation, three(at + 10));
                node.base_velocity = Motion::new(three(at + 13), three(at + 16));
                let mut i = 0;
                while i < 12 {
                    node.joints[i] = number(at + 19 + i) as $T;
                    node.joint_velocities[i] = number(at + 31 + i) as $T;
                    node.torques[i] = number(at + 43 + i) as $T;
                    i += 1;
                }
                let mut foot = 0;
                while foot < 4 {
                    node.forces_w[foot] = three(at + 55 + 3 * foot);
                    foot += 1;
                }
                k += 1;
            }
            nodes
        };

        impl Planned for $T {
            fn nodes() -> &'static [Node<Self, 12, 4>] {
                &$TABLE
            }
        }
    )* };
}

planned! { f64 DOUBLE f32 SINGLE }
