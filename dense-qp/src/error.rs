//! Bad data, named.

use core::fmt;

/// A number in the problem or the settings that no solver could use, named with its place.
///
/// Outcomes of a solve (infeasible, limit, …) are never errors: see [`crate::Status`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// `hessian` holds a NaN or an infinity in this row: check the weights it was built from.
    HessianNotFinite(usize),
    /// `hessian` differs from its transpose in this row: fill both triangles.
    HessianNotSymmetric(usize),
    /// `hessian` has negative curvature along a direction that the equality rows allow; found at this
    /// pivot of the factorisation. A convex cost has none: check the signs of the weights.
    HessianNotConvex(usize),
    /// `gradient` holds a NaN or an infinity at this index.
    GradientNotFinite(usize),
    /// `rows` holds a NaN or an infinity in this row.
    RowNotFinite(usize),
    /// `row_lower` and `row_upper` at this index are NaN, inverted, or an infinity of the wrong sign:
    /// lower ≤ upper, lower < +∞, upper > −∞ is needed.
    RowLimits(usize),
    /// `lower` and `upper` at this index are NaN, inverted, or an infinity of the wrong sign.
    Bounds(usize),
    /// A tolerance in the settings is negative or not a number.
    SettingsTolerance,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::HessianNotFinite(i) => write!(f, "hessian row {i} is not finite"),
            Self::HessianNotSymmetric(i) => write!(f, "hessian row {i} differs from its column"),
            Self::HessianNotConvex(i) => write!(f, "hessian is not convex at pivot {i}"),
            Self::GradientNotFinite(i) => write!(f, "gradient[{i}] is not finite"),
            Self::RowNotFinite(i) => write!(f, "constraint row {i} is not finite"),
            Self::RowLimits(i) => write!(f, "row_lower[{i}], row_upper[{i}] are NaN or inverted"),
            Self::Bounds(i) => write!(f, "lower[{i}], upper[{i}] are NaN or inverted"),
            Self::SettingsTolerance => write!(f, "a tolerance in the settings is not usable"),
        }
    }
}

impl core::error::Error for Error {}
