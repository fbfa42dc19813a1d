//! What all machines have in common for whoever drives them: firmware, a simulation, a test.

use core::fmt::Debug;

use jump_control::{Fault, JointCommand, Phase};
use so3::Scalar;

use crate::{Observation, Refusal};

/// What came of a tick of a machine whose ticks do `W`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tick<W = crate::Work> {
    /// Where the jump is.
    pub phase: Phase,
    /// What was computed.
    pub work: W,
    /// Why the machine has aborted: the first fault.
    pub fault: Option<Fault>,
    /// Why the last jump was not begun.
    pub refusal: Option<Refusal>,
}

/// A whole jump of a robot with `N` joints and `F` feet: an observation in at 1 kHz, motor torques out at 10 kHz.
///
/// Whatever comes in, what comes out is finite and inside the motors' limits. After a fault it is damping alone.
pub trait JumpMachine<T: Scalar, const N: usize, const F: usize> {
    /// What a tick computes.
    type Work: Copy + Debug + PartialEq;

    /// One tick of 1 kHz at the time `now`, s, on a clock of the caller that only goes forward; `observed` is what has arrived since
    /// the last tick, `None` if nothing has.
    fn tick(&mut self, now: T, observed: Option<&Observation<T, N, F>>) -> Tick<Self::Work>;

    /// One tick of 10 kHz, `dt` seconds after the last: torques for the motors, N m, from joint positions, rad, and velocities, rad/s,
    /// of now.
    fn joint_tick(&mut self, q: &[T; N], qd: &[T; N], dt: T) -> [T; N];

    /// What [`JumpMachine::joint_tick`] does, for a joint loop of the caller's own.
    fn command(&self) -> &JointCommand<T, N>;

    /// Where the jump is.
    fn phase(&self) -> Phase;

    /// The first fault, if the machine has aborted.
    fn fault(&self) -> Option<Fault>;
}
