//! Tables of the robot `a1_reference` in canonical frames; generated, do not edit.
//!
//! - source: `a1_reference.urdf`, sha256 9146e7d4cc20325be75173ba6b356710258839795bb670f620235e1d507663db
//! - licence of the source: BSD-3-Clause
//! - joints locked: none
//! - tool: model-import 0.1.0

#![allow(clippy::approx_constant, clippy::excessive_precision, reason = "numbers of the source file")]

use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Frame, JointLimits, Link, bodies_f32, frames_f32, limits_f32};

/// a1_reference on a floating base, 12 joints, 12.453 kg.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct A1Reference;

rbd_core::tree! {
    impl Tree<f64, 12> for A1Reference { floating, BASE, BODIES, 4 * [RevoluteX, RevoluteY, RevoluteY] }
}

rbd_core::tree! {
    impl Tree<f32, 12> for A1Reference { floating, BASE_F32, BODIES_F32, 4 * [RevoluteX, RevoluteY, RevoluteY] }
}

rbd_core::model! {
    impl Model<f64, 12> for A1Reference { NAME, JOINT_NAMES, LIMITS, FRAME_NAMES, FRAMES }
}

rbd_core::model! {
    impl Model<f32, 12> for A1Reference { NAME, JOINT_NAMES, LIMITS_F32, FRAME_NAMES, FRAMES_F32 }
}

/// Name of the robot in the source file.
pub const NAME: &str = "a1_reference";

/// Number of joints.
pub const JOINTS: usize = 12;

/// Names of the joints, in the order of the joint coordinates.
pub static JOINT_NAMES: [&str; 12] = [
    "FL_hip_joint",
    "FL_thigh_joint",
    "FL_calf_joint",
    "FR_hip_joint",
    "FR_thigh_joint",
    "FR_calf_joint",
    "RL_hip_joint",
    "RL_thigh_joint",
    "RL_calf_joint",
    "RR_hip_joint",
    "RR_thigh_joint",
    "RR_calf_joint",
];

/// Index of each joint.
pub mod joint {
    /// `FL_hip_joint`, which moves the link `FL_hip`.
    pub const FL_HIP_JOINT: usize = 0;
    /// `FL_thigh_joint`, which moves the link `FL_thigh`.
    pub const FL_THIGH_JOINT: usize = 1;
    /// `FL_calf_joint`, which moves the link `FL_calf`.
    pub const FL_CALF_JOINT: usize = 2;
    /// `FR_hip_joint`, which moves the link `FR_hip`.
    pub const FR_HIP_JOINT: usize = 3;
    /// `FR_thigh_joint`, which moves the link `FR_thigh`.
    pub const FR_THIGH_JOINT: usize = 4;
    /// `FR_calf_joint`, which moves the link `FR_calf`.
    pub const FR_CALF_JOINT: usize = 5;
    /// `RL_hip_joint`, which moves the link `RL_hip`.
    pub const RL_HIP_JOINT: usize = 6;
    /// `RL_thigh_joint`, which moves the link `RL_thigh`.
    pub const RL_THIGH_JOINT: usize = 7;
    /// `RL_calf_joint`, which moves the link `RL_calf`.
    pub const RL_CALF_JOINT: usize = 8;
    /// `RR_hip_joint`, which moves the link `RR_hip`.
    pub const RR_HIP_JOINT: usize = 9;
    /// `RR_thigh_joint`, which moves the link `RR_thigh`.
    pub const RR_THIGH_JOINT: usize = 10;
    /// `RR_calf_joint`, which moves the link `RR_calf`.
    pub const RR_CALF_JOINT: usize = 11;
}

/// The base: mass, first and second moments of mass.
pub static BASE: BaseBody<f64> = BaseBody {
    mass: 4.713,
    first: [0.0, 0.0193233, -0.0023565],
    second: [0.052000000000000005, 0.013079225530000004, 0.0040011782500000035, 0.0, 0.0, -9.661650000000001e-6],
};

/// [`BASE`] in single precision.
pub static BASE_F32: BaseBody<f32> = BASE.to_f32();

/// The bodies, depth first.
pub static BODIES: [Body<f64>; 12] = [
    // 0: FL_hip_joint
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Base,
        subtree_end: 3,
        sign: 1.0,
        offset: [0.1805, 0.047, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.696,
        first: [-0.002304456, 0.00044196, 2.1575999999999998e-5],
        second: [0.00045321655381600005, 0.00010762314460000002, 0.00036190416885600006, 7.94567044e-6, 2.7056186400000005e-7, 4.7970076e-7],
        rotor_inertia: 0.0,
    },
    // 1: FL_thigh_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(0),
        subtree_end: 3,
        sign: 1.0,
        offset: [0.0, 0.0838, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.013,
        first: [-0.0032790809999999997, -0.022617250999999998, -0.027681237999999997],
        second: [0.000499645385197, 0.0013837323630769998, 0.005406725509588, 6.8387041487e-5, -0.000254264832594, 0.0005955910008259999],
        rotor_inertia: 0.0,
    },
    // 2: FL_calf_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(1),
        subtree_end: 3,
        sign: 1.0,
        offset: [0.0, 0.0, -0.2],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.226,
        first: [0.00106821, 0.0, -0.029826408],
        second: [3.59119313499999e-5, 1.2987999999999802e-5, 0.007308926302304, 0.0, 2.6450064520000012e-5, 0.0],
        rotor_inertia: 0.0,
    },
    // 3: FR_hip_joint
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Base,
        subtree_end: 6,
        sign: 1.0,
        offset: [0.1805, -0.047, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.696,
        first: [-0.002304456, -0.00044196, 2.1575999999999998e-5],
        second: [0.00045321655381600005, 0.00010762314460000002, 0.00036190416885600006, -7.94567044e-6, 2.7056186400000005e-7, -4.7970076e-7],
        rotor_inertia: 0.0,
    },
    // 4: FR_thigh_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(3),
        subtree_end: 6,
        sign: 1.0,
        offset: [0.0, -0.0838, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.013,
        first: [-0.0032790809999999997, 0.022617250999999998, -0.027681237999999997],
        second: [0.000499645385197, 0.0013837323630769998, 0.005406725509588, -6.8387041487e-5, -0.000254264832594, -0.0005955910008259999],
        rotor_inertia: 0.0,
    },
    // 5: FR_calf_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(4),
        subtree_end: 6,
        sign: 1.0,
        offset: [0.0, 0.0, -0.2],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.226,
        first: [0.00106821, 0.0, -0.029826408],
        second: [3.59119313499999e-5, 1.2987999999999802e-5, 0.007308926302304, 0.0, 2.6450064520000012e-5, 0.0],
        rotor_inertia: 0.0,
    },
    // 6: RL_hip_joint
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Base,
        subtree_end: 9,
        sign: 1.0,
        offset: [-0.1805, 0.047, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.696,
        first: [0.002304456, 0.00044196, 2.1575999999999998e-5],
        second: [0.00045321655381600005, 0.00010762314460000002, 0.00036190416885600006, -7.94567044e-6, -2.7056186400000005e-7, 4.7970076e-7],
        rotor_inertia: 0.0,
    },
    // 7: RL_thigh_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(6),
        subtree_end: 9,
        sign: 1.0,
        offset: [0.0, 0.0838, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.013,
        first: [-0.0032790809999999997, -0.022617250999999998, -0.027681237999999997],
        second: [0.000499645385197, 0.0013837323630769998, 0.005406725509588, 6.8387041487e-5, -0.000254264832594, 0.0005955910008259999],
        rotor_inertia: 0.0,
    },
    // 8: RL_calf_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(7),
        subtree_end: 9,
        sign: 1.0,
        offset: [0.0, 0.0, -0.2],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.226,
        first: [0.00106821, 0.0, -0.029826408],
        second: [3.59119313499999e-5, 1.2987999999999802e-5, 0.007308926302304, 0.0, 2.6450064520000012e-5, 0.0],
        rotor_inertia: 0.0,
    },
    // 9: RR_hip_joint
    Body {
        kind: Kind::RevoluteX,
        parent: Link::Base,
        subtree_end: 12,
        sign: 1.0,
        offset: [-0.1805, -0.047, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.696,
        first: [0.002304456, -0.00044196, 2.1575999999999998e-5],
        second: [0.00045321655381600005, 0.00010762314460000002, 0.00036190416885600006, 7.94567044e-6, -2.7056186400000005e-7, -4.7970076e-7],
        rotor_inertia: 0.0,
    },
    // 10: RR_thigh_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(9),
        subtree_end: 12,
        sign: 1.0,
        offset: [0.0, -0.0838, 0.0],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 1.013,
        first: [-0.0032790809999999997, 0.022617250999999998, -0.027681237999999997],
        second: [0.000499645385197, 0.0013837323630769998, 0.005406725509588, -6.8387041487e-5, -0.000254264832594, -0.0005955910008259999],
        rotor_inertia: 0.0,
    },
    // 11: RR_calf_joint
    Body {
        kind: Kind::RevoluteY,
        parent: Link::Joint(10),
        subtree_end: 12,
        sign: 1.0,
        offset: [0.0, 0.0, -0.2],
        tilt: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mass: 0.226,
        first: [0.00106821, 0.0, -0.029826408],
        second: [3.59119313499999e-5, 1.2987999999999802e-5, 0.007308926302304, 0.0, 2.6450064520000012e-5, 0.0],
        rotor_inertia: 0.0,
    },
];

/// [`BODIES`] in single precision.
pub static BODIES_F32: [Body<f32>; 12] = bodies_f32(&BODIES);

/// Limits and losses of the joints, as the source file has them.
pub static LIMITS: [JointLimits<f64>; 12] = [
    // FL_hip_joint
    JointLimits {
        lower: -0.8028514559173915,
        upper: 0.8028514559173915,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // FL_thigh_joint
    JointLimits {
        lower: -1.0471975511965976,
        upper: 4.1887902047863905,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // FL_calf_joint
    JointLimits {
        lower: -2.6965336943312392,
        upper: -0.9162978572970231,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // FR_hip_joint
    JointLimits {
        lower: -0.8028514559173915,
        upper: 0.8028514559173915,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // FR_thigh_joint
    JointLimits {
        lower: -1.0471975511965976,
        upper: 4.1887902047863905,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // FR_calf_joint
    JointLimits {
        lower: -2.6965336943312392,
        upper: -0.9162978572970231,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RL_hip_joint
    JointLimits {
        lower: -0.8028514559173915,
        upper: 0.8028514559173915,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RL_thigh_joint
    JointLimits {
        lower: -1.0471975511965976,
        upper: 4.1887902047863905,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RL_calf_joint
    JointLimits {
        lower: -2.6965336943312392,
        upper: -0.9162978572970231,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RR_hip_joint
    JointLimits {
        lower: -0.8028514559173915,
        upper: 0.8028514559173915,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RR_thigh_joint
    JointLimits {
        lower: -1.0471975511965976,
        upper: 4.1887902047863905,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
    // RR_calf_joint
    JointLimits {
        lower: -2.6965336943312392,
        upper: -0.9162978572970231,
        speed: 21.0,
        effort: 33.5,
        damping: 0.0,
        friction: 0.0,
    },
];

/// [`LIMITS`] in single precision.
pub static LIMITS_F32: [JointLimits<f32>; 12] = limits_f32(&LIMITS);

/// The frame of each link, which is also that of the joint above it.
pub mod frame {
    use super::{Frame, Link};

    /// Link `trunk`, the root.
    pub const TRUNK: Frame<f64> = Frame {
        link: Link::Base,
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FL_hip`, joint `FL_hip_joint`.
    pub const FL_HIP: Frame<f64> = Frame {
        link: Link::Joint(0),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FL_thigh`, joint `FL_thigh_joint`.
    pub const FL_THIGH: Frame<f64> = Frame {
        link: Link::Joint(1),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FL_calf`, joint `FL_calf_joint`.
    pub const FL_CALF: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FL_foot`, joint `FL_foot_fixed`.
    pub const FL_FOOT: Frame<f64> = Frame {
        link: Link::Joint(2),
        offset: [0.0, 0.0, -0.2],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FR_hip`, joint `FR_hip_joint`.
    pub const FR_HIP: Frame<f64> = Frame {
        link: Link::Joint(3),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FR_thigh`, joint `FR_thigh_joint`.
    pub const FR_THIGH: Frame<f64> = Frame {
        link: Link::Joint(4),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FR_calf`, joint `FR_calf_joint`.
    pub const FR_CALF: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `FR_foot`, joint `FR_foot_fixed`.
    pub const FR_FOOT: Frame<f64> = Frame {
        link: Link::Joint(5),
        offset: [0.0, 0.0, -0.2],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RL_hip`, joint `RL_hip_joint`.
    pub const RL_HIP: Frame<f64> = Frame {
        link: Link::Joint(6),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RL_thigh`, joint `RL_thigh_joint`.
    pub const RL_THIGH: Frame<f64> = Frame {
        link: Link::Joint(7),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RL_calf`, joint `RL_calf_joint`.
    pub const RL_CALF: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RL_foot`, joint `RL_foot_fixed`.
    pub const RL_FOOT: Frame<f64> = Frame {
        link: Link::Joint(8),
        offset: [0.0, 0.0, -0.2],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RR_hip`, joint `RR_hip_joint`.
    pub const RR_HIP: Frame<f64> = Frame {
        link: Link::Joint(9),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RR_thigh`, joint `RR_thigh_joint`.
    pub const RR_THIGH: Frame<f64> = Frame {
        link: Link::Joint(10),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RR_calf`, joint `RR_calf_joint`.
    pub const RR_CALF: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0, 0.0, 0.0],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    /// Link `RR_foot`, joint `RR_foot_fixed`.
    pub const RR_FOOT: Frame<f64> = Frame {
        link: Link::Joint(11),
        offset: [0.0, 0.0, -0.2],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
}

/// Names of the links, depth first.
pub static FRAME_NAMES: [&str; 17] = [
    "trunk",
    "FL_hip",
    "FL_thigh",
    "FL_calf",
    "FL_foot",
    "FR_hip",
    "FR_thigh",
    "FR_calf",
    "FR_foot",
    "RL_hip",
    "RL_thigh",
    "RL_calf",
    "RL_foot",
    "RR_hip",
    "RR_thigh",
    "RR_calf",
    "RR_foot",
];

/// The frame of each link, in the order of [`FRAME_NAMES`].
pub static FRAMES: [Frame<f64>; 17] = [
    frame::TRUNK,
    frame::FL_HIP,
    frame::FL_THIGH,
    frame::FL_CALF,
    frame::FL_FOOT,
    frame::FR_HIP,
    frame::FR_THIGH,
    frame::FR_CALF,
    frame::FR_FOOT,
    frame::RL_HIP,
    frame::RL_THIGH,
    frame::RL_CALF,
    frame::RL_FOOT,
    frame::RR_HIP,
    frame::RR_THIGH,
    frame::RR_CALF,
    frame::RR_FOOT,
];

/// [`FRAMES`] in single precision.
pub static FRAMES_F32: [Frame<f32>; 17] = frames_f32(&FRAMES);
