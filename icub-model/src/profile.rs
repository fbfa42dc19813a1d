//! How iCub jumps: postures, gains, weights and limits of its controllers, each with its unit and why it is what it is.
//!
//! "Found" means by hand on the native simulator's nominal jumps, checked by `saltus verdicts icub/velocity icub/torque` in both simulators
//! and by the seeds of `saltus envelope`; nobody has tuned them on a robot.

use jump_control::{ComProfile, Curve, JointGains, takeoff_speed};
use jump_machine::humanoid::{self, Landing, PushOff};
use rbd_core::{ContactShape, GRAVITY, JointLimits};
use wbc_qp::jump::{LandingSettings, TorqueJumpSettings, VelocityJumpSettings};
use wbc_qp::{Contact, Gains, Horizon, Patch};

use crate::gazebo::joint::{
    L_ANKLE_PITCH, L_HIP_PITCH, L_KNEE, L_SHOULDER_PITCH, R_ANKLE_PITCH, R_HIP_PITCH, R_KNEE,
    R_SHOULDER_PITCH, TORSO_PITCH,
};
use crate::{LIMITS, MOTORS, SOLES};

/// Joints.
pub const JOINTS: usize = 23;
/// Feet.
pub const FEET: usize = 2;
/// Force coordinates of both soles, six each.
pub const FORCES: usize = 12;
/// Variables of the programs of torques and of velocities.
pub const TORQUE_VARIABLES: usize = JOINTS + FORCES;
/// Variables of the program of velocities.
pub const VELOCITY_VARIABLES: usize = JOINTS + 6;
/// Rows of the programs of torques: both soles' cones, ten each and one row per force, and the joints' torques.
pub const TORQUE_ROWS: usize = 2 * 10 + FORCES + JOINTS;

/// The machine of iCub's jump with a model `M`.
pub type Machine<'a, M> = humanoid::Machine<
    'a,
    f64,
    M,
    JOINTS,
    FEET,
    FORCES,
    TORQUE_VARIABLES,
    VELOCITY_VARIABLES,
    TORQUE_ROWS,
>;

/// Its memory.
pub type Workspace =
    humanoid::Workspace<f64, JOINTS, FORCES, TORQUE_VARIABLES, VELOCITY_VARIABLES, TORQUE_ROWS>;

/// Its settings.
pub type Settings = humanoid::Settings<f64, JOINTS, FEET>;

/// Its jump.
pub type Jump = humanoid::Jump<f64, JOINTS>;

/// The squat that the jump starts from, rad: soles level, the centre of mass 0.38 m high over them, so that the push-off of paper B, 11 cm, ends
/// before the legs are straight.
pub const SQUAT: [f64; JOINTS] = posture(1.496, -2.013, -0.817, 0.2);

/// The posture in which the robot lands and then stands, rad: legs drawn up a little from the take-off, soles level.
pub const LANDING_POSTURE: [f64; JOINTS] = posture(1.08, -1.35, -0.5, 0.2);

/// Way of the centre of mass in the push-off, m: paper B, III-A.
pub const DISPLACEMENT: f64 = 0.11;

/// Height that the nominal jump gains, m: paper B, IV.
pub const HEIGHT: f64 = 0.04;

/// Posture of both legs alike, and of the arms half bent at the sides, where they are out of the way of the legs: hip, knee and ankle
/// pitch, torso pitch.
const fn posture(hip: f64, knee: f64, ankle: f64, torso: f64) -> [f64; JOINTS] {
    let mut q = [0.0; JOINTS];
    q[L_HIP_PITCH] = hip;
    q[L_KNEE] = knee;
    q[L_ANKLE_PITCH] = ankle;
    q[R_HIP_PITCH] = hip;
    q[R_KNEE] = knee;
    q[R_ANKLE_PITCH] = ankle;
    q[TORSO_PITCH] = torso;
    let shoulders = [L_SHOULDER_PITCH, R_SHOULDER_PITCH];
    let mut i = 0;
    while i < shoulders.len() {
        q[shoulders[i]] = -0.5;
        q[shoulders[i] + 1] = 0.4;
        q[shoulders[i] + 3] = 0.8;
        i += 1;
    }
    q
}

/// Weights of the posture in a push-off, without unit, 1 for the others. Found: knees most, which are the fastest joints; arms least, which give what
/// angular momentum asks for.
const POSTURE_WEIGHT: [f64; JOINTS] = {
    let mut weight = [1.0; JOINTS];
    weight[L_KNEE] = 3.0;
    weight[R_KNEE] = 3.0;
    weight[L_HIP_PITCH] = 0.7;
    weight[R_HIP_PITCH] = 0.7;
    let mut i = L_SHOULDER_PITCH;
    while i < JOINTS {
        weight[i] = 0.3;
        i += 1;
    }
    weight
};

/// How limits act in programs of torques, s, s and rad/s². Found.
const TORQUE_HORIZON: Horizon<f64> = Horizon {
    position: 0.04,
    velocity: 0.01,
    acceleration: 1000.0,
};

/// Push-off by velocities, paper B, III-D.
pub const VELOCITY: VelocityJumpSettings<f64, JOINTS> = VelocityJumpSettings {
    // 1/s: errors decay in a quarter of the push-off's 0.43 s.
    com_gain: 10.0,
    // 1/s: the same.
    momentum_gain: 10.0,
    // 1/s: slower than the push-off, so that it hardly pulls back.
    posture_gain: 1.0,
    posture_weight: POSTURE_WEIGHT,
    // Without unit: a tenth of the posture's.
    continuity_weight: [0.1; JOINTS],
    // Per (m/s)² and (kg m²/s)²: what the paper writes as equalities weighs a million times as much as the posture.
    com_weight: 1e6,
    momentum_weight: 1e6,
    // s, s and rad/s², half of those of torques. Found.
    horizon: Horizon {
        position: 0.02,
        velocity: 0.005,
        acceleration: 500.0,
    },
};

/// Push-off by torques, paper B, III-E.
pub const TORQUE: TorqueJumpSettings<f64, JOINTS> = TorqueJumpSettings {
    // 1/s² and 1/s: critically damped, as fast as the gain of velocities.
    com: Gains {
        stiffness: 100.0,
        damping: 20.0,
    },
    // 1/s: as of velocities.
    momentum_gain: 10.0,
    // 1/s: twice as fast as the errors that it would leave decay, a tenth of what delays of 5 ms allow.
    surplus_gain: 20.0,
    // 1/s² and 1/s: critically damped, slower than the centre of mass.
    posture: Gains {
        stiffness: 50.0,
        damping: 14.0,
    },
    posture_weight: POSTURE_WEIGHT,
    // Per (N m)²: a change of 32 N m weighs as much as 1 rad/s² of a joint.
    continuity_weight: 1e-3,
    // Weighed, not held: on 10 to 27 % of plausible states the equalities contradict contacts and limits (`wbc-qp/src/jump/mod.rs`).
    strict: false,
    // Per (m/s²)² and (N m)²: a hundred thousand times the posture's.
    com_weight: 1e5,
    momentum_weight: 1e5,
    // Per N² and (N m)²: only decides what both soles share.
    force_weight: 1e-3,
    horizon: TORQUE_HORIZON,
    // W: no limit per joint is published.
    max_power: f64::INFINITY,
    // Hosts have time; a microcontroller sets what its tick has room for.
    max_steps: u32::MAX,
    // Damping is in the model's limits; the paper's program did not know it.
    knows_friction: true,
};

/// Flight and landing by one program of torques.
pub const LANDING: LandingSettings<f64, JOINTS> = LandingSettings {
    // 1/s² and 1/s: nearly critically damped, softer than in the push-off. Found.
    com: Gains {
        stiffness: 60.0,
        damping: 15.0,
    },
    // Per (m/s²)²: a tenth of the push-off's. Found.
    com_weight: 1e4,
    // 1/s: as in the push-off.
    momentum_gain: 10.0,
    // Per (N m)². Found.
    momentum_weight: 1e3,
    // 1/s² and 1/s, and per (rad/s²)²: the trunk as fast as the centre of mass, a hundredth of its weight.
    trunk: Gains {
        stiffness: 60.0,
        damping: 15.0,
    },
    trunk_weight: 1e2,
    // 1/s² and 1/s: critically damped, level again within 0.1 s, half of the flight.
    sole: Gains {
        stiffness: 900.0,
        damping: 60.0,
    },
    sole_weight: 1e2,
    // 1/s² and 1/s, in the air, where the posture is all there is, and on the ground, where it has what is left.
    posture: [
        Gains {
            stiffness: 900.0,
            damping: 60.0,
        },
        Gains {
            stiffness: 40.0,
            damping: 12.0,
        },
    ],
    posture_weight: [1.0; JOINTS],
    // As in the push-off.
    continuity_weight: 1e-3,
    force_weight: 1e-3,
    horizon: TORQUE_HORIZON,
    max_power: f64::INFINITY,
    max_steps: u32::MAX,
};

/// Gains of the joints' servos, N m/rad and N m s/rad, in the place of paper B's position-controlled joints. Found: hips and knees carry the body,
/// arms are light.
pub const SERVOS: [JointGains<f64>; JOINTS] = {
    let arm = JointGains {
        stiffness: 600.0,
        damping: 8.0,
    };
    let torso = JointGains {
        stiffness: 4000.0,
        damping: 50.0,
    };
    let ankle = JointGains {
        stiffness: 4000.0,
        damping: 20.0,
    };
    let leg = JointGains {
        stiffness: 6000.0,
        damping: 60.0,
    };
    let mut servos = [arm; JOINTS];
    let mut i = 0;
    while i < L_SHOULDER_PITCH {
        servos[i] = match i {
            TORSO_PITCH.. => torso,
            _ if i % 6 >= L_ANKLE_PITCH => ankle,
            _ => leg,
        };
        i += 1;
    }
    servos
};

/// The servos' gains once the ground is there: the hold of paper B, but legs and torso a tenth as stiff, since the stiff hold throws the robot
/// back into the air, and damped by 1.4 times as much. Found.
pub const COMPLIANT_SERVOS: [JointGains<f64>; JOINTS] = {
    let mut servos = SERVOS;
    let mut i = 0;
    while i < L_SHOULDER_PITCH {
        servos[i].stiffness *= 0.1;
        servos[i].damping *= 1.4;
        i += 1;
    }
    servos
};

/// The joints' limits as the programs keep them: with a margin on speed, since servos overshoot their commands a little, the light arms
/// more.
pub const GUARDED_LIMITS: [JointLimits<f64>; JOINTS] = {
    let mut limits = LIMITS;
    let mut i = 0;
    while i < JOINTS {
        limits[i].speed *= if i < L_SHOULDER_PITCH { 0.95 } else { 0.9 };
        i += 1;
    }
    limits
};

/// Ground friction that the programs count on: half, where plants have 0.6 to 1.
const FRICTION: f64 = 0.5;
/// Largest normal force on a sole, N: three weights of the robot, half of what the soles' sensors measure.
const SOLE_FORCE: f64 = 1000.0;

/// A sole as [`Contact::new`] makes it, in a `const`.
const fn foot(i: usize) -> Contact<f64> {
    let (x, y) = match SOLES[i].shape {
        ContactShape::Rectangle { x, y } => (x, y),
        ContactShape::Sphere { .. } => ([0.0; 2], [0.0; 2]),
    };
    let sides = x[1] - x[0] + y[1] - y[0];
    Contact {
        frame: SOLES[i].frame,
        shape: Patch::Rectangle { x, y },
        friction: FRICTION,
        yaw: FRICTION * sides * 0.25,
        min_force: 0.0,
        max_force: SOLE_FORCE,
        load: 1.0,
    }
}

/// Both soles as the programs see them.
pub const SOLE_CONTACTS: [Contact<f64>; FEET] = [foot(0), foot(1)];

/// Settings of the machine with a push-off by torques and a landing by its program.
pub const SETTINGS: Settings = Settings {
    // Of the computers and links, as of every machine: 1 kHz, 10 ms, 5 ms.
    period: 1e-3,
    max_age: 0.010,
    max_silence: 0.005,
    // rad: as of A1's machine.
    start_tolerance: 0.15,
    // m: soles reach at least 5 cm back from their frames, so the centre of mass stays over them.
    start_distance: 0.03,
    // s: five flights.
    patience: 1.0,
    // m/s and rad/s: as of A1's machine on its legs of 0.4 m.
    rest: (0.05, 0.2),
    // rad: the squat itself leans by 17°.
    most_tilt: 0.5,
    // s: as of A1's machine.
    settling: 0.2,
    // N m s/rad. Found.
    safe_damping: 5.0,
    // N m/s: no rate of the drives is published, and the programs smooth their torques themselves.
    slew: f64::INFINITY,
    standing: LANDING_POSTURE,
    push_off: PushOff::Torque(TORQUE),
    landing: Landing::Program(LANDING),
    // Joints that leave the ground at 7 rad/s with their rotors need all of the flight, less what ground that comes early takes away.
    aerial_share: 0.9,
    // N: a sixteenth of the weight, and a quarter of it for one sole.
    touchdown_force: 20.0,
    contact_force: 5.0,
    // s: ten ticks, in which no torque jumps.
    loading_time: 0.01,
    // m: from the landing posture two thirds of the way down to the squat. Found.
    absorption: 0.08,
    // s: for a fall that is hardly one. Found.
    absorption_time: 0.4,
    // s. Found.
    rise_time: 0.8,
    servos: SERVOS,
    limits: GUARDED_LIMITS,
    motors: MOTORS,
    feet: SOLE_CONTACTS,
};

/// The rise of the centre of mass in a jump that gains `height`, m; `None` unless it is positive.
#[must_use]
pub fn rise(height: f64) -> Option<ComProfile<f64>> {
    let gravity = -GRAVITY[2];
    let speed = takeoff_speed(height, gravity);
    ComProfile::by_displacement(Curve::rising(), speed, DISPLACEMENT, gravity)
}
