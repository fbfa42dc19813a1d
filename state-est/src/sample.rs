//! What the estimator is told, and what may be wrong with it.

use core::fmt;

use nalgebra::Vector3;
use so3::Scalar;

/// One sample of the sensors of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T: Scalar, const N: usize, const F: usize> {
    /// Accelerometer: acceleration of the IMU's point minus gravity, IMU axes, m/s². At rest it points up.
    pub specific_force_i: Vector3<T>,
    /// Gyroscope, IMU axes, rad/s.
    pub angular_velocity_i: Vector3<T>,
    /// Joint positions, rad.
    pub joints: [T; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [T; N],
    /// How sure the contact detector is of each foot, 0 to 1.
    pub evidence: [T; F],
}

/// What is wrong with a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// No sample arrived.
    Missing,
    /// The step is not positive, not a number, or too long: nothing was done.
    Step,
    /// The accelerometer is not finite or beyond its range: the last force was used.
    Accelerometer,
    /// The gyroscope is not finite or beyond its range: the last rate was used.
    Gyroscope,
    /// Position or velocity of this joint is not finite: the feet that it moves were not used.
    Joint(usize),
    /// The evidence of this foot is not a number: the foot was not used.
    Evidence(usize),
    /// The numbers left the finite range: the last good state was restored.
    Diverged,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("no sample: coasting on the last one"),
            Self::Step => f.write_str("time step not positive or too long: nothing was done"),
            Self::Accelerometer => f.write_str("accelerometer not finite or out of range"),
            Self::Gyroscope => f.write_str("gyroscope not finite or out of range"),
            Self::Joint(i) => write!(f, "joint {i}: encoder not finite, its feet are not used"),
            Self::Evidence(i) => write!(f, "foot {i}: contact evidence is not a number"),
            Self::Diverged => f.write_str("estimate left the finite range: last good one restored"),
        }
    }
}
