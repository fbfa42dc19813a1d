//! What can be wrong with a controller's inputs.

use core::fmt;

/// A program that could not be written or solved, named with its cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// More rows than the program's const generic M has room for: raise M.
    NoRoomForRows,
    /// More rows with slack than the const generic V has room for: raise V.
    NoRoomForSlack,
    /// A contact's least normal force is above its largest, or one of them is NaN.
    NormalForces {
        /// Which contact.
        contact: usize,
    },
    /// The vertices are not those of a convex polygon in counter-clockwise order.
    NotConvex,
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
            Self::NoRoomForSlack => {
                f.write_str("the program has more rows with slack than V has room for: raise V")
            }
            Self::NormalForces { contact } => write!(
                f,
                "the least normal force of contact {contact} is above its largest: set min_force below max_force"
            ),
            Self::NotConvex => {
                f.write_str("the vertices are no convex polygon in counter-clockwise order")
            }
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
