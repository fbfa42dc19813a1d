//! Feet and motors of A1, each figure with its source.

use rbd_core::hardware::{Contact, ContactShape, Motor, motors_f32};

use crate::a1::frame;

/// Radius of the ball of a foot, m: the URDF's collision sphere of the `*_foot` links.
pub const FOOT_RADIUS: f64 = 0.02;

const fn foot(name: &'static str, frame: rbd_core::Frame<f64>) -> Contact<f64> {
    Contact {
        name,
        frame,
        shape: ContactShape::Sphere {
            radius: FOOT_RADIUS,
        },
    }
}

/// The feet, FL FR RL RR: balls around the frames `*_foot`.
pub static FEET: [Contact<f64>; 4] = [
    foot("FL_foot", frame::FL_FOOT),
    foot("FR_foot", frame::FR_FOOT),
    foot("RL_foot", frame::RL_FOOT),
    foot("RR_foot", frame::RR_FOOT),
];

/// [`FEET`] in single precision.
pub static FEET_F32: [Contact<f32>; 4] = [
    FEET[0].to_f32(),
    FEET[1].to_f32(),
    FEET[2].to_f32(),
    FEET[3].to_f32(),
];

/// The motor of every joint.
///
/// | figure | value | source |
/// |---|---|---|
/// | gear | 9 | paper A, section II and Table I |
/// | torque | 33.5 N m | paper A, Table I; URDF `effort` |
/// | corner and no-load speed | 9.8 and 21.4 rad/s | below |
/// | rotor inertia at the joint | 0.0067 kg m² | below |
///
/// The torque-speed line is the voltage limit of the paper's authors' own motor model
/// (DRCL-USC/Learning_MPC_Jumping, `hw_exp/a1_robot_code_jumpMPC/Controllers/FSM.cpp`): torque constant
/// k = 0.118 N m/A, resistance R = 25 k² Ω, supply U = 21.5 V, gear n = 8.5 there. Torque τ at speed ω needs
/// U = R τ/(n k) + k n ω, hence no-load speed U/(k n) = 21.44 rad/s and corner speed (U − R · 33.5/(n k))/(k n)
/// = 9.85 rad/s. It passes the URDF's and Table I's 21 rad/s with 1.3 N m left. No measured curve is public.
///
/// Nobody has published the rotor's inertia. 0.0067 kg m² (8.3e-5 kg m² × 81) is the figure of this
/// project's landing experiments; MuJoCo Menagerie's A1 has an `armature` of 0.01, a round number as well.
pub const MOTOR: Motor<f64> = Motor {
    gear: crate::table1::GEAR,
    torque: crate::table1::TORQUE,
    corner_speed: (SUPPLY - RESISTANCE * crate::table1::TORQUE / (MODEL_GEAR * TORQUE_CONSTANT))
        / (TORQUE_CONSTANT * MODEL_GEAR),
    no_load_speed: SUPPLY / (TORQUE_CONSTANT * MODEL_GEAR),
    rotor_inertia: 0.0067,
};

/// Torque constant of the motor, N m/A.
pub(crate) const TORQUE_CONSTANT: f64 = 0.118;
/// Resistance of the motor, Ω.
pub(crate) const RESISTANCE: f64 = 25.0 * TORQUE_CONSTANT * TORQUE_CONSTANT;
/// Supply voltage, V.
const SUPPLY: f64 = 21.5;
/// Gear ratio that the motor model was fitted with.
const MODEL_GEAR: f64 = 8.5;

/// The motors of the joints. Viscous and Coulomb friction (0.01 N m s/rad, 0.2 N m: URDF `dynamics`) stand
/// with the limits.
pub static MOTORS: [Motor<f64>; 12] = [MOTOR; 12];

/// [`MOTORS`] in single precision.
pub static MOTORS_F32: [Motor<f32>; 12] = motors_f32(&MOTORS);
