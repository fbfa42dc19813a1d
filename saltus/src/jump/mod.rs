//! The main job: a jump planned, simulated and judged.

pub(crate) mod execute;
pub(crate) mod judge;
pub(crate) mod kinematics;
pub(crate) mod log;
pub(crate) mod reference;
pub(crate) mod report;
pub(crate) mod task;

use a1_model::{A1Geared, FEET};
use contact_sim::{ContactSphere, NativeSimulator};
use rbd_core::{Configuration, Frame, Tangent};

/// Joints of the robot.
pub(crate) const JOINTS: usize = 12;
/// Its feet.
pub(crate) const FOOT_COUNT: usize = 4;
/// Its contact spheres: feet, knees, corners of the trunk.
pub(crate) const SPHERES: usize = 16;

/// The robot that is planned for and simulated: A1 as published, with rotors.
pub(crate) const ROBOT: A1Geared = A1Geared;

pub(crate) type State = Configuration<f64, JOINTS>;
pub(crate) type Velocity = Tangent<f64, JOINTS>;
pub(crate) type Node = jump_control::Node<f64, JOINTS, FOOT_COUNT>;
pub(crate) type Plant = NativeSimulator<f64, A1Geared, JOINTS, SPHERES>;

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
        (None, 4..8) => ContactSphere {
            link: rbd_core::Link::Joint(3 * (i - 4) + 2),
            offset: [0.0; 3],
            radius: 0.02,
        },
        _ => {
            // The published trunk is a box of 0.267 x 0.194 x 0.114 m; its corners, rounded.
            let side = |bit: usize| if (i >> bit) & 1 == 0 { 1.0 } else { -1.0 };
            ContactSphere {
                link: rbd_core::Link::Base,
                offset: [0.1235 * side(0), 0.087 * side(1), 0.047 * side(2)],
                radius: 0.01,
            }
        }
    })
}
