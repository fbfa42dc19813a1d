//! What a humanoid's tick computed.

use wbc_qp::jump::Residuals;
use wbc_qp::{Error, Yielded};

/// What a program's answer was like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved<T> {
    /// Iterations of the solver.
    pub iterations: u32,
    /// By how much the rows missed that the paper writes as equalities.
    pub residuals: Residuals<T>,
    /// Which rows had to yield.
    pub yielded: Yielded,
    /// Whether the cap on steps ended the search: a command, but not the optimum.
    pub capped: bool,
}

/// What a tick computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work<T> {
    /// The push-off's program: its answer, or why there was none and the last command stays.
    PushOff(Result<Solved<T>, Error>),
    /// The landing's program, likewise.
    Landing(Result<Solved<T>, Error>),
    /// Positions for servos.
    Servos,
    /// Joints damped, nothing else.
    Damping,
}
