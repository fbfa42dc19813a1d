#![doc = include_str!("../README.md")]

pub mod answer;
mod apart;
pub mod audit;
pub mod bounds;
mod edge;
pub mod file;
mod folding;
mod grid;
mod kept;
mod lengths;
mod no_plan;
mod pace;
mod plan;
pub mod planned;
pub mod range;
pub mod reference;
pub mod robot;
pub mod scene;
mod search;
mod setup;
mod stops;
pub mod stored;
mod stronger;
pub mod task;
pub mod terrain;
mod tightening;
pub mod track;
pub mod whole_body;

pub use kept::Kept;
pub use no_plan::NoPlan;
pub use plan::{Options, Outcome, Step, plan, replan};
pub use whole_body::Timing;

use core::ops::ControlFlow;
use ocp_solver::Progress;
use rbd_core::{Configuration, Tangent};

/// Joints of the robot.
pub const JOINTS: usize = 12;
/// Its feet.
pub const FOOT_COUNT: usize = 4;

/// Where a quadruped is.
pub type State = Configuration<f64, JOINTS>;
/// How it moves.
pub type Velocity = Tangent<f64, JOINTS>;
/// Who hears every iteration of a solver, and stops it by `Break`: of one type, so that the solvers are compiled once and here.
pub(crate) type Observe<'a> = &'a mut dyn FnMut(&Progress<f64>) -> ControlFlow<()>;
/// A node of its plan.
pub type Node = jump_control::Node<f64, JOINTS, FOOT_COUNT>;

/// How many threads a plan takes: those of rayon's pool, as many as the machine has cores unless the program has asked for fewer.
/// What is planned does not depend on it.
#[must_use]
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Configuration and velocity at a node.
#[must_use]
pub fn state(node: &Node) -> (State, Velocity) {
    let q = State {
        base: node.base,
        joints: node.joints,
    };
    let v = Velocity {
        base: node.base_velocity,
        joints: node.joint_velocities,
    };
    (q, v)
}
