//! Soles and motors of iCub, each figure with its source.

use rbd_core::hardware::{Contact, ContactShape, Motor, motors_f32};

use crate::gazebo::frame;
use crate::limits::LIMITS;

/// The soles, left and right: rectangles in the planes of the frames `l_sole` and `r_sole`.
///
/// Outline of the collision boxes of the Gazebo URDF's feet, 0.160 × 0.072 m. The boxes themselves are 1 mm
/// thick and lie 10 mm below the frames; the rectangles are put into the frames' planes, where the robot's
/// controllers place the contact. (robotology/whole-body-controllers uses −0.06..0.11 × −0.035..0.04 m.)
pub static SOLES: [Contact<f64>; 2] = [
    Contact {
        name: "l_sole",
        frame: frame::L_SOLE,
        shape: ContactShape::Rectangle {
            x: [-0.0535, 0.1065],
            y: [-0.031, 0.041],
        },
    },
    Contact {
        name: "r_sole",
        frame: frame::R_SOLE,
        shape: ContactShape::Rectangle {
            x: [-0.0535, 0.1065],
            y: [-0.041, 0.031],
        },
    },
];

/// [`SOLES`] in single precision.
pub static SOLES_F32: [Contact<f32>; 2] = [SOLES[0].to_f32(), SOLES[1].to_f32()];

/// The motors of the joints.
///
/// Torque and speed are those of [`LIMITS`]. No torque-speed curve is public: the line falls to zero at the
/// speed limit at once, so that only the box of the limits remains.
///
/// | figure | legs | torso pitch, roll | torso yaw, arms |
/// |---|---|---|---|
/// | gear | 100, hip pitch 150 | 100 | 100 |
/// | motor inertia, kg m² | 8.27e-6 | 8.27e-6 | 5.85e-6 |
/// | harmonic drive, kg m² | 5.4e-6 | 5.4e-6 | 2.1e-6 |
///
/// Source: robotology/whole-body-controllers, `floating-base-balancing-torque-control-with-simulator`,
/// `iCubGenova04/configRobotSim.m`. The motors of shoulders and torso move two or three joints each; here every
/// joint has the reflected inertia of a motor of its own. Friction stands with the limits: the URDF's damping.
pub static MOTORS: [Motor<f64>; 23] = motors();

/// [`MOTORS`] in single precision.
pub static MOTORS_F32: [Motor<f32>; 23] = motors_f32(&MOTORS);

/// Motor and harmonic drive of legs, and of torso pitch and roll, kg m².
const LARGE_ROTOR: f64 = 8.27e-6 + 5.4e-6;
/// Motor and harmonic drive of arms and torso yaw, kg m².
const SMALL_ROTOR: f64 = 5.85e-6 + 2.1e-6;

const fn motors() -> [Motor<f64>; 23] {
    use crate::gazebo::joint::{L_HIP_PITCH, R_HIP_PITCH, TORSO_YAW};
    let mut motors = [Motor {
        gear: 100.0,
        torque: 0.0,
        corner_speed: 0.0,
        no_load_speed: 0.0,
        rotor_inertia: 0.0,
    }; 23];
    let mut i = 0;
    while i < motors.len() {
        if i == L_HIP_PITCH || i == R_HIP_PITCH {
            motors[i].gear = 150.0;
        }
        let rotor = if i < TORSO_YAW {
            LARGE_ROTOR
        } else {
            SMALL_ROTOR
        };
        motors[i].rotor_inertia = motors[i].gear * motors[i].gear * rotor;
        motors[i].torque = LIMITS[i].effort;
        motors[i].corner_speed = LIMITS[i].speed;
        motors[i].no_load_speed = LIMITS[i].speed;
        i += 1;
    }
    motors
}
