//! Collision shapes of every link of A1.

use rbd_core::{Link, Shape};

use crate::a1::frame;
use crate::hardware::FOOT_RADIUS;

/// What forces count for: feet, shanks, thighs and hips by leg (FL FR RL RR), and the trunk.
pub static OWNERS: [&str; 17] = [
    "FL_foot", "FR_foot", "RL_foot", "RR_foot", "FL_shank", "FR_shank", "RL_shank", "RR_shank",
    "FL_thigh", "FR_thigh", "RL_thigh", "RR_thigh", "FL_hip", "FR_hip", "RL_hip", "RR_hip",
    "trunk",
];

/// Size of the trunk's box in the URDF, m.
pub const TRUNK: [f64; 3] = [0.267, 0.194, 0.114];
/// Radius by which the trunk's edges are rounded, m. The URDF's box has square edges, the robot's plastic shell has not; read off
/// pictures, to half a centimetre.
pub const TRUNK_ROUNDING: f64 = 0.03;
/// Length and thickness of the thigh's box, m; its other side is 0.0245.
pub const THIGH: [f64; 2] = [0.2, 0.034];
/// Length and thickness of the shank's box, m.
pub const SHANK: [f64; 2] = [0.2, 0.016];
/// The hip's motor and the thigh's beside it are cylinders across the leg: from 0.020 m inside of the hip's joint to 0.097 m outside of it
/// (0.081 and half of 0.032), with radii of 0.046 and 0.041.
pub const HIP: [f64; 2] = [-0.020, 0.097];
/// The smaller of the two radii, m.
pub const HIP_RADIUS: f64 = 0.041;

/// Shapes of all links, from the `<collision>` elements of the published URDF by one rule: a capsule along the longest axis of a link's
/// boxes or cylinders, as long as they are and as thick as their thicker side, so that only corners are cut off. The trunk is
/// capsules along all edges of its box, and along the middles of its upper and lower sides.
pub static SHAPES: [Shape<f64>; 26] = shapes();

const fn shapes() -> [Shape<f64>; 26] {
    let mut out = [Shape::ball(Link::Base, [0.0; 3], 0.0, 0); 26];
    let feet = [
        frame::FL_FOOT,
        frame::FR_FOOT,
        frame::RL_FOOT,
        frame::RR_FOOT,
    ];
    let mut leg = 0;
    while leg < 4 {
        let foot = &feet[leg];
        out[leg] = Shape::ball(foot.link, foot.offset, FOOT_RADIUS, leg);
        out[4 + leg] = along_z(3 * leg + 2, SHANK, 4 + leg);
        out[8 + leg] = along_z(3 * leg + 1, THIGH, 8 + leg);
        // Left legs are at positive y.
        let side = if leg % 2 == 0 { 1.0 } else { -1.0 };
        out[12 + leg] = Shape {
            link: Link::Joint(3 * leg),
            from: [0.0, side * (HIP[0] + HIP_RADIUS), 0.0],
            to: [0.0, side * (HIP[1] - HIP_RADIUS), 0.0],
            radius: HIP_RADIUS,
            owner: 12 + leg,
        };
        leg += 1;
    }
    let x = 0.5 * TRUNK[0] - TRUNK_ROUNDING;
    let y = 0.5 * TRUNK[1] - TRUNK_ROUNDING;
    let z = 0.5 * TRUNK[2] - TRUNK_ROUNDING;
    let mut i = 0;
    while i < 2 {
        let up = if i == 0 { z } else { -z };
        let at = 16 + 5 * i;
        out[at] = trunk([-x, y, up], [x, y, up]);
        out[at + 1] = trunk([-x, -y, up], [x, -y, up]);
        out[at + 2] = trunk([-x, 0.0, up], [x, 0.0, up]);
        out[at + 3] = trunk([x, -y, up], [x, y, up]);
        out[at + 4] = trunk([-x, -y, up], [-x, y, up]);
        i += 1;
    }
    out
}

/// A limb that hangs from its joint.
const fn along_z(joint: usize, [length, thickness]: [f64; 2], owner: usize) -> Shape<f64> {
    let radius = 0.5 * thickness;
    Shape {
        link: Link::Joint(joint),
        from: [0.0, 0.0, -radius],
        to: [0.0, 0.0, radius - length],
        radius,
        owner,
    }
}

const fn trunk(from: [f64; 3], to: [f64; 3]) -> Shape<f64> {
    Shape {
        link: Link::Base,
        from,
        to,
        radius: TRUNK_ROUNDING,
        owner: 16,
    }
}
