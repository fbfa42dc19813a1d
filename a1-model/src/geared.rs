//! A1 with the rotors of its motors: the plant, and what a plan should assume.

use rbd_core::hardware::with_rotors;
use rbd_core::model::{Body, bodies_f32};

use crate::a1::{
    BASE, BASE_F32, BODIES as URDF_BODIES, FRAME_NAMES, FRAMES, FRAMES_F32, JOINT_NAMES, LIMITS,
    LIMITS_F32, NAME,
};
use crate::hardware::{FEET, FEET_F32, MOTORS, MOTORS_F32};

/// [`A1`](crate::A1) whose joints also feel the rotors of [`MOTORS`], with feet and motors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct A1Geared;

/// The bodies with rotors.
pub static BODIES: [Body<f64>; 12] = with_rotors(&URDF_BODIES, &MOTORS);

/// [`BODIES`] in single precision.
pub static BODIES_F32: [Body<f32>; 12] = bodies_f32(&BODIES);

rbd_core::tree! {
    impl Tree<f64, 12> for A1Geared { floating, BASE, BODIES, 4 * [RevoluteX, RevoluteY, RevoluteY] }
}

rbd_core::tree! {
    impl Tree<f32, 12> for A1Geared { floating, BASE_F32, BODIES_F32, 4 * [RevoluteX, RevoluteY, RevoluteY] }
}

rbd_core::model! {
    impl Model<f64, 12> for A1Geared { NAME, JOINT_NAMES, LIMITS, FRAME_NAMES, FRAMES, FEET, MOTORS }
}

rbd_core::model! {
    impl Model<f32, 12> for A1Geared {
        NAME, JOINT_NAMES, LIMITS_F32, FRAME_NAMES, FRAMES_F32, FEET_F32, MOTORS_F32
    }
}
