//! What can be wrong with what a simulator is given.

use core::fmt;

/// Bad input or a simulation that left the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The torque of this joint is NaN or infinite; the step was not taken. Send finite torques.
    TorqueNotFinite(usize),
    /// The state is no longer finite: the step is too long for the stiffness. Reset, and shorten the step.
    StateNotFinite,
    /// The simulator behind this one, MuJoCo, stopped with an error of its own, of which it has told more.
    EngineFailed,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TorqueNotFinite(joint) => {
                write!(
                    f,
                    "torque of joint {joint} is not finite: step not taken, send finite torques"
                )
            }
            Self::StateNotFinite => {
                f.write_str("the simulated state is not finite: reset it, and shorten the step")
            }
            Self::EngineFailed => f.write_str("MuJoCo stopped with an error of its own"),
        }
    }
}

impl core::error::Error for Error {}
