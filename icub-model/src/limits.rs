//! Joint limits of iCub-23: the URDF's where it has them, and chosen ones where it has placeholders.

use rbd_core::model::{JointLimits, limits_f32};

use crate::{cad, gazebo};

/// How far paper B shifted the ankles' pitch range to let the robot crouch deeper: 15° (section IV).
pub const ANKLE_SHIFT: f64 = 15.0 * core::f64::consts::PI / 180.0;

/// Limits with the inertias and damping of the Gazebo model.
///
/// | joints | position | speed, rad/s | torque, N m |
/// |---|---|---|---|
/// | legs | URDF; ankle pitch shifted by −15° | URDF: hip pitch 5.1, others 7.64 | URDF: hip pitch 55.5, others 37 |
/// | torso pitch, roll, yaw | URDF | 7.64, chosen | 36, 80, 80, chosen |
/// | shoulder pitch, roll, yaw, elbow | URDF | 7.64, chosen | 84, 84, 34, 20, chosen |
///
/// In the URDF every torso and arm joint has 50000 for speed and torque: a placeholder. The torques chosen are
/// those of the older published iCub model (`icub_description` of example-robot-data, 28.35 kg), the only
/// public set per joint. Its speeds (100 rad/s) are placeholders too: the leg joints' 7.64 rad/s is chosen,
/// because torso and arms have motors of the same family behind the same 1:100 gears.
///
/// The shift makes the ankle range −50°..20° instead of ±35°, on both legs: a crouch has negative ankle pitch
/// (its start squat −46.8°).
pub static LIMITS: [JointLimits<f64>; 23] = chosen(&gazebo::LIMITS);

/// [`LIMITS`] in single precision.
pub static LIMITS_F32: [JointLimits<f32>; 23] = limits_f32(&LIMITS);

/// As [`LIMITS`], with the damping of the CAD model.
pub static CAD_LIMITS: [JointLimits<f64>; 23] = chosen(&cad::LIMITS);

/// [`CAD_LIMITS`] in single precision.
pub static CAD_LIMITS_F32: [JointLimits<f32>; 23] = limits_f32(&CAD_LIMITS);

/// Torques chosen for torso, left arm, right arm, N m, in joint order.
const CHOSEN_TORQUES: [f64; 11] = [
    36.0, 80.0, 80.0, //
    84.0, 84.0, 34.0, 20.0, //
    84.0, 84.0, 34.0, 20.0,
];

/// Speed chosen for torso and arms, rad/s.
const CHOSEN_SPEED: f64 = 7.64;

const fn chosen(urdf: &[JointLimits<f64>; 23]) -> [JointLimits<f64>; 23] {
    use gazebo::joint::{L_ANKLE_PITCH, R_ANKLE_PITCH, TORSO_PITCH};
    let mut limits = *urdf;
    let mut i = 0;
    while i < CHOSEN_TORQUES.len() {
        limits[TORSO_PITCH + i].effort = CHOSEN_TORQUES[i];
        limits[TORSO_PITCH + i].speed = CHOSEN_SPEED;
        i += 1;
    }
    let ankles = [L_ANKLE_PITCH, R_ANKLE_PITCH];
    let mut k = 0;
    while k < ankles.len() {
        limits[ankles[k]].lower -= ANKLE_SHIFT;
        limits[ankles[k]].upper -= ANKLE_SHIFT;
        k += 1;
    }
    limits
}
