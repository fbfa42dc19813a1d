//! The main job: a jump planned, simulated and judged.

pub(crate) mod answer;
pub(crate) mod bounds;
pub(crate) mod envelope;
pub(crate) mod execute;
#[cfg(test)]
mod fuzz;
pub(crate) mod judge;
pub(crate) mod kinematics;
pub(crate) mod log;
pub(crate) mod measure;
mod pace;
pub(crate) mod planned;
pub(crate) mod plant;
pub(crate) mod programs;
pub(crate) mod reference;
pub(crate) mod report;
mod sensors;
mod setup;
pub(crate) mod stored;
pub(crate) mod strip;
pub(crate) mod task;
pub(crate) mod task_file;
mod task_values;
pub(crate) mod whole_body;

use a1_model::{A1Geared, FEET};
use rbd_core::{Configuration, Frame, Tangent};

/// Joints of the robot.
pub(crate) const JOINTS: usize = 12;
/// Its feet.
pub(crate) const FOOT_COUNT: usize = 4;
/// What the forces on its shapes count for: feet first, then shanks, thighs, hips and the trunk.
pub(crate) const OWNERS: usize = a1_model::OWNERS.len();

/// The robot that is planned for and simulated: A1 as published, with rotors.
pub(crate) const ROBOT: A1Geared = A1Geared;

pub(crate) type State = Configuration<f64, JOINTS>;
pub(crate) type Velocity = Tangent<f64, JOINTS>;
pub(crate) type Node = jump_control::Node<f64, JOINTS, FOOT_COUNT>;

/// Configuration and velocity at a node.
pub(crate) fn state(node: &Node) -> (State, Velocity) {
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

/// Frames of the feet: the centres of the balls.
pub(crate) fn feet() -> [Frame<f64>; FOOT_COUNT] {
    FEET.map(|foot| foot.frame)
}
