//! The one error type of the crate: input data that no rotation can be made of.

use core::fmt;

/// Why a function refused its input. Every variant names the parameter or the remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The parameter holds NaN or an infinity.
    NotFinite {
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// A quaternion so short that it has no direction.
    ZeroQuaternion,
    /// A matrix that is singular or a reflection (determinant zero or negative): no rotation is near it.
    NotNearRotation,
    /// The middle angle is a quarter turn: these roll-pitch-yaw rates do not exist. Use the other order.
    GimbalLock,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { parameter } => {
                f.write_str(parameter)?;
                f.write_str(" holds NaN or an infinity: check where it is computed or measured")
            }
            Self::ZeroQuaternion => f.write_str(
                "the quaternion is zero: has the sensor or the message been initialised?",
            ),
            Self::NotNearRotation => f.write_str(
                "the matrix is singular or a reflection: check its axes and their signs",
            ),
            Self::GimbalLock => f.write_str(
                "the middle angle is a quarter turn: use the other roll-pitch-yaw order",
            ),
        }
    }
}

impl core::error::Error for Error {}
