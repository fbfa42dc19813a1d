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
use contact_sim::ContactSphere;
use rbd_core::{Configuration, Frame, Tangent};

/// Joints of the robot.
pub(crate) const JOINTS: usize = 12;
/// Its feet.
pub(crate) const FOOT_COUNT: usize = 4;
/// Its contact spheres: feet, knees, corners of the trunk.
pub(crate) const SPHERES: usize = 16;
/// The first of the trunk's.
pub(crate) const TRUNK: usize = 8;
/// The published trunk is a box of this size, m.
pub(crate) const TRUNK_SIZE: [f64; 3] = [0.267, 0.194, 0.114];
/// Radius of the spheres at its corners in the native simulator, m.
const CORNER_RADIUS: f64 = 0.01;

/// The robot that is planned for and simulated: A1 as published, with rotors.
pub(crate) const ROBOT: A1Geared = A1Geared;

/// Links with a shape of their own, for people; feet, shanks and the trunk.
pub(crate) const fn owner_name(contact: usize) -> &'static str {
    const NAMES: [&str; TRUNK + 1] = [
        "FL_foot", "FR_foot", "RL_foot", "RR_foot", "FL_shank", "FR_shank", "RL_shank", "RR_shank", "trunk",
    ];
    NAMES[if contact < TRUNK { contact } else { TRUNK }]
}

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

/// Feet, knees and trunk corners as spheres.
pub(crate) fn spheres() -> [ContactSphere<f64>; SPHERES] {
    core::array::from_fn(|i| match (FEET.get(i), i) {
        (Some(foot), _) => ContactSphere {
            link: foot.frame.link,
            offset: foot.frame.offset,
            radius: a1_model::FOOT_RADIUS,
        },
        (None, 4..TRUNK) => ContactSphere {
            link: rbd_core::Link::Joint(3 * (i - 4) + 2),
            offset: [0.0; 3],
            radius: 0.02,
        },
        _ => {
            let corner = |axis: usize| {
                let inside = 0.5 * TRUNK_SIZE[axis] - CORNER_RADIUS;
                if (i >> axis) & 1 == 0 {
                    inside
                } else {
                    -inside
                }
            };
            ContactSphere {
                link: rbd_core::Link::Base,
                offset: core::array::from_fn(corner),
                radius: CORNER_RADIUS,
            }
        }
    })
}
