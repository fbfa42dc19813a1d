//! Everything about a humanoid's machine that is neither its model nor the jump.

use jump_control::JointGains;
use rbd_core::{JointLimits, Motor};
use so3::Scalar;
use wbc_qp::Contact;
use wbc_qp::jump::{LandingSettings, TorqueJumpSettings, VelocityJumpSettings};

/// Which program pushes off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PushOff<T, const N: usize> {
    /// Joint velocities, followed by servos: paper B, III-D.
    Velocity(VelocityJumpSettings<T, N>),
    /// Joint torques: paper B, III-E.
    Torque(TorqueJumpSettings<T, N>),
}

/// What holds the robot after the push-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Landing<T, const N: usize> {
    /// One torque program through flight and landing.
    Program(LandingSettings<T, N>),
    /// Servos, with these gains once the ground is there: paper B, III-F.
    Servos([JointGains<T>; N]),
}

/// Periods, limits and gains of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T: Scalar, const N: usize, const F: usize> {
    /// Period of [`Machine::tick`](super::Machine::tick), s.
    pub period: T,
    /// Oldest observation to act on, s.
    pub max_age: T,
    /// Longest silence of either loop, and longest time without an answer of a program, s.
    pub max_silence: T,
    /// Farthest that a joint may be from the jump's start, rad.
    pub start_tolerance: T,
    /// Farthest that the first foot may be, in the estimator's world, from where the jump begins, m.
    pub start_distance: T,
    /// Time after the take-off at which the robot gives up waiting for the ground, s.
    pub patience: T,
    /// Base speeds below which the robot is at rest, m/s and rad/s.
    pub rest: (T, T),
    /// Largest tilt of the base of a robot that stands, rad.
    pub most_tilt: T,
    /// Time at rest after which it stands, s.
    pub settling: T,
    /// Damping of the safe command, N m s/rad.
    pub safe_damping: T,
    /// Largest rate of a joint's torque, N m/s.
    pub slew: T,
    /// Joint positions in which the robot stands while no jump is armed, rad.
    pub standing: [T; N],
    /// Push-off.
    pub push_off: PushOff<T, N>,
    /// Flight and landing.
    pub landing: Landing<T, N>,
    /// Duration of the aerial motion over that of the planned flight.
    pub aerial_share: T,
    /// Force on all feet together that counts as touchdown, N.
    pub touchdown_force: T,
    /// Force on a foot that counts as contact of this foot, N.
    pub contact_force: T,
    /// Time in which a contact is added to the landing's program or removed from it, s.
    pub loading_time: T,
    /// Way of the centre of mass in which the fall ends, m.
    pub absorption: T,
    /// Longest time for it, s.
    pub absorption_time: T,
    /// Time in which the robot then rises to the landing posture, s.
    pub rise_time: T,
    /// Gains of the joints' servos.
    pub servos: [JointGains<T>; N],
    /// The joints' limits as the programs keep them.
    pub limits: [JointLimits<T>; N],
    /// The motors.
    pub motors: [Motor<T>; N],
    /// The feet with the friction and the forces that the programs count on.
    pub feet: [Contact<T>; F],
}
