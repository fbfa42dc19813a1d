//! The plan of `a1/double-backflip` in flash: the container that `saltus plan` writes, read by the compiler into a `static` per scalar,
//! so it takes no memory of the controller. `saltus verify` and `saltus run` take the same file.

use jump_control::container::Container;
use jump_control::{Node, flash_plan};

use crate::Real;

/// The file.
pub const BYTES: &[u8] = include_bytes!("../../plans/a1-double-backflip.bin");
/// What the compiler read there; it would not have gone on after a file that is no plan of twelve joints and four feet.
pub const PLAN: Container<'static, 12, 4> = flash_plan!(BYTES);

/// Take-off, posing, touchdown, s.
pub(super) const TIMES: [f64; 3] = {
    let h = PLAN.header();
    [h.takeoff as f64, h.posing as f64, h.touchdown as f64]
};
/// Wanted heading at the end, rad.
pub(super) const HEADING: f64 = PLAN.header().heading as f64;
/// Joint positions before touchdown, rad.
pub(super) const LANDING: [f32; 12] = PLAN.header().landing_joints;
/// Height of the box that the robot jumps from, and how far behind its middle it ends, m.
pub(super) const BOX: [f64; 2] = match PLAN.header().ground {
    Some(step) => [step.drop as f64, step.distance as f64],
    None => [0.0; 2],
};

/// A scalar in which the plan stands in flash.
pub trait Planned: Real {
    /// Its nodes.
    fn nodes() -> &'static [Node<Self, 12, 4>];
}

static DOUBLE: [Node<f64, 12, 4>; PLAN.count()] = PLAN.nodes_f64();
static SINGLE: [Node<f32, 12, 4>; PLAN.count()] = PLAN.nodes_f32();

impl Planned for f64 {
    fn nodes() -> &'static [Node<Self, 12, 4>] {
        &DOUBLE
    }
}

impl Planned for f32 {
    fn nodes() -> &'static [Node<Self, 12, 4>] {
        &SINGLE
    }
}
