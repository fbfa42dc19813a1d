//! The robots that this crate offers: the generated tables with the limits, soles and motors of this crate.

use rbd_core::hardware::with_rotors;
use rbd_core::model::{Body, bodies_f32};

use crate::hardware::{MOTORS, MOTORS_F32, SOLES, SOLES_F32};
use crate::limits::{CAD_LIMITS, CAD_LIMITS_F32, LIMITS, LIMITS_F32};
use crate::{cad, gazebo};

/// iCub-23 with the inertias of iCubGazeboV2_5 and the limits of [`LIMITS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Icub23;

/// iCub-23 with the CAD inertias of iCubGenova04 and the limits of [`CAD_LIMITS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Icub23Cad;

/// [`Icub23Cad`] whose joints also feel the rotors of [`MOTORS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Icub23Geared;

/// [`Icub23`] whose joints also feel the rotors of [`MOTORS`]: the robot of paper B's simulations with its gears.
///
/// Some of the Gazebo moments are inflated to 0.01 kg m² for a simulator's sake; the rotors are 0.08 to 0.31 kg m², so that little is
/// counted twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Icub23GazeboGeared;

/// The CAD bodies with rotors.
pub static GEARED: [Body<f64>; 23] = with_rotors(&cad::BODIES, &MOTORS);

/// [`GEARED`] in single precision.
pub static GEARED_F32: [Body<f32>; 23] = bodies_f32(&GEARED);

/// The Gazebo bodies with rotors.
pub static GAZEBO_GEARED: [Body<f64>; 23] = with_rotors(&gazebo::BODIES, &MOTORS);

/// [`GAZEBO_GEARED`] in single precision.
pub static GAZEBO_GEARED_F32: [Body<f32>; 23] = bodies_f32(&GAZEBO_GEARED);

macro_rules! icub {
    ($($Robot:ident $T:ident: $base:path, $bodies:path, $limits:path, $frames:path, $soles:path, $motors:path;)*) => { $(
        rbd_core::tree! {
            impl Tree<$T, 23> for $Robot {
                floating, $base, $bodies,
                2 * [RevoluteY, RevoluteX, RevoluteZ, RevoluteY, RevoluteY, RevoluteX],
                1 * [RevoluteY, RevoluteX, RevoluteZ, {
                    2 * [RevoluteTilted, RevoluteX, RevoluteY, RevoluteTilted]
                }]
            }
        }
        rbd_core::model! {
            impl Model<$T, 23> for $Robot {
                gazebo::NAME, gazebo::JOINT_NAMES, $limits, gazebo::FRAME_NAMES, $frames, $soles, $motors
            }
        }
    )* };
}

icub! {
    Icub23 f64: gazebo::BASE, gazebo::BODIES, LIMITS, gazebo::FRAMES, SOLES, MOTORS;
    Icub23 f32: gazebo::BASE_F32, gazebo::BODIES_F32, LIMITS_F32, gazebo::FRAMES_F32, SOLES_F32, MOTORS_F32;
    Icub23GazeboGeared f64: gazebo::BASE, GAZEBO_GEARED, LIMITS, gazebo::FRAMES, SOLES, MOTORS;
    Icub23GazeboGeared f32: gazebo::BASE_F32, GAZEBO_GEARED_F32, LIMITS_F32, gazebo::FRAMES_F32, SOLES_F32, MOTORS_F32;
    Icub23Cad f64: cad::BASE, cad::BODIES, CAD_LIMITS, cad::FRAMES, SOLES, MOTORS;
    Icub23Cad f32: cad::BASE_F32, cad::BODIES_F32, CAD_LIMITS_F32, cad::FRAMES_F32, SOLES_F32, MOTORS_F32;
    Icub23Geared f64: cad::BASE, GEARED, CAD_LIMITS, cad::FRAMES, SOLES, MOTORS;
    Icub23Geared f32: cad::BASE_F32, GEARED_F32, CAD_LIMITS_F32, cad::FRAMES_F32, SOLES_F32, MOTORS_F32;
}
