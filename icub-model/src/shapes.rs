//! Collision shapes of every link of iCub.

use rbd_core::{Link, Shape};

use crate::gazebo::{BODIES, frame, joint};

/// What forces count for beside the soles: limbs in the order of their shapes, then head and trunk.
pub static OWNERS: [&str; 14] = [
    "l_foot",
    "r_foot",
    "l_forearm",
    "r_forearm",
    "l_upper_arm",
    "r_upper_arm",
    "l_thigh",
    "r_thigh",
    "l_shank",
    "r_shank",
    "l_hip",
    "r_hip",
    "head",
    "trunk",
];

/// Half the thickness of a foot above its sole, m.
const FOOT: f64 = 0.025;
/// Height of a foot's middle over the sole, m: the sole touches first.
const INSTEP: f64 = 0.030;
/// Half the thickness of a forearm, m: 0.028 by 0.039.
const FOREARM: f64 = 0.034;
/// Half the thickness of an upper arm, m: 0.034 by 0.045.
const UPPER_ARM: f64 = 0.040;
/// Half the thickness of a thigh, m.
const THIGH: f64 = 0.040;
/// Half the thickness of a shank, m: 0.040 by 0.050.
const SHANK: f64 = 0.045;
/// Half the thickness of a hip, m: 0.030 by 0.049.
const HIP: f64 = 0.040;
/// Radius of the head, m: √(5 s/m) of a ball.
const HEAD: f64 = 0.085;
/// Centre of mass of the head, from the chest's joint, m.
const HEAD_CENTRE: [f64; 3] = [0.003, 0.0, 0.274];
/// Half the thickness of chest, waist and pelvis, m.
const TRUNK: [f64; 3] = [0.072, 0.050, 0.060];

/// Shapes of all links; the corners of the soles are in [`SOLES`](crate::SOLES).
///
/// The URDF's collision elements are meshes, which are not part of it. Limbs are capsules from joint to joint instead (the forearm to the
/// middle of the hand), as thick as a cylinder with the link's mass and moments: a half axis is 2 √(s/m) with the second
/// moment of mass s of the URDF's `<inertial>`, and of two that differ the root of the mean square. The chest is as long and thick
/// as a box of its moments, (√3 instead of 2), with the computer on its back (x points backwards).
pub static SHAPES: [Shape<f64>; 16] = shapes(0);

/// The same, whose forces count for a number of owners later.
#[must_use]
pub const fn shapes(first: usize) -> [Shape<f64>; 16] {
    let knee = [joint::L_KNEE, joint::R_KNEE];
    let elbow = [joint::L_ELBOW, joint::R_ELBOW];
    let hands = [frame::L_HAND_DH_FRAME.offset, frame::R_HAND_DH_FRAME.offset];
    let soles = [frame::L_SOLE.offset, frame::R_SOLE.offset];
    let mut out = [Shape::ball(Link::Base, [0.0; 3], 0.0, 0); 16];
    let mut side = 0;
    while side < 2 {
        let (knee, elbow) = (knee[side], elbow[side]);
        // The sole's rectangle: toes ahead, outer side 10 mm wider than the inner.
        let y = if side == 0 { -0.005 } else { 0.005 };
        let z = soles[side][2] + INSTEP;
        out[side] = Shape {
            link: Link::Joint(knee + 2),
            from: [0.0535 - FOOT, y, z],
            to: [FOOT - 0.1065, y, z],
            radius: FOOT,
            owner: first + side,
        };
        out[2 + side] = limb(elbow, hands[side], FOREARM, first + 2 + side);
        out[4 + side] = limb(elbow - 1, BODIES[elbow].offset, UPPER_ARM, first + 4 + side);
        out[6 + side] = limb(knee - 1, BODIES[knee].offset, THIGH, first + 6 + side);
        out[8 + side] = limb(knee, BODIES[knee + 1].offset, SHANK, first + 8 + side);
        out[10 + side] = limb(knee - 2, BODIES[knee - 1].offset, HIP, first + 10 + side);
        side += 1;
    }
    let chest = Link::Joint(joint::TORSO_YAW);
    out[12] = Shape::ball(chest, HEAD_CENTRE, HEAD, first + 12);
    let trunk = [
        (chest, [0.008, 0.0, 0.073], [0.086, 0.0, 0.073]),
        (
            Link::Joint(joint::TORSO_ROLL),
            [-0.0628, 0.0, 0.0],
            [-0.0628, 0.0, 0.05],
        ),
        (Link::Base, [0.0065, -0.05, -0.09], [0.0065, 0.05, -0.09]),
    ];
    let mut i = 0;
    while i < 3 {
        let (link, from, to) = trunk[i];
        out[13 + i] = Shape {
            link,
            from,
            to,
            radius: TRUNK[i],
            owner: first + 13,
        };
        i += 1;
    }
    out
}

/// A capsule from a joint to a place in its link.
const fn limb(joint: usize, to: [f64; 3], radius: f64, owner: usize) -> Shape<f64> {
    Shape {
        link: Link::Joint(joint),
        from: [0.0; 3],
        to,
        radius,
        owner,
    }
}
