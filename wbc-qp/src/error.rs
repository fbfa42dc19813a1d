//! What can be wrong with a controller's inputs.

use core::fmt;

/// A program that could not be written or solved, named with its cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// More rows than the program's const generic M has room for: raise M.
    NoRoomForRows,
    /// The contacts need another number of force coordinates than the const generic K: three per ball, six
    /// per rectangle.
    ForceCoordinates {
        /// What the contacts need.
        needed: usize,
    },
    /// The state, a target or a limit is not finite, or limits are inverted: what the solver says.
    Data(dense_qp::Error),
    /// Not even the last relaxation could be solved; this is the solver's last word.
    Unsolved(dense_qp::Status),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoomForRows => f.write_str("the program has more rows than M: raise M"),
            Self::ForceCoordinates { needed } => {
                write!(
                    f,
                    "the contacts have {needed} force coordinates: set K to it"
                )
            }
            Self::Data(error) => write!(f, "unusable data: {error}"),
            Self::Unsolved(status) => write!(f, "no relaxation could be solved: {status:?}"),
        }
    }
}

impl core::error::Error for Error {}
