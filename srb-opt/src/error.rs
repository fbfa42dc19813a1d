//! Bad data.

/// Data that cannot be planned with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// A parameter of the problem is not usable: its name and what it must be.
    Parameter(&'static str),
    /// The solver refused its input.
    Solver(ocp_solver::Error),
    /// The const sizes are too small for the problem: `NX ≥ 12 + phases`, `NU ≥ 3 × feet`,
    /// `NI ≥` [`crate::row_capacity`].
    Capacity,
    /// More intervals than [`crate::onboard::INTERVALS`].
    Intervals,
    /// Clarabel could not solve a quadratic program.
    #[cfg(feature = "clarabel")]
    Program,
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Parameter(what) => f.write_str(what),
            Self::Solver(error) => error.fmt(f),
            Self::Capacity => f.write_str(
                "const sizes too small: NX >= 12 + phases, NU >= 3 feet, NI >= row_capacity(feet, phases)",
            ),
            Self::Intervals => {
                f.write_str("more than 30 intervals: shorten the phases, or own a longer slice of stages")
            }
            #[cfg(feature = "clarabel")]
            Self::Program => f.write_str("Clarabel could not solve a quadratic program: start from a better guess"),
        }
    }
}

impl core::error::Error for Error {}

impl From<ocp_solver::Error> for Error {
    fn from(error: ocp_solver::Error) -> Self {
        Self::Solver(error)
    }
}
