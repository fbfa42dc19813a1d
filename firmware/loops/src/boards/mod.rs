//! Boards: what differs between them, in one file each, beside their memory map in `firmware/smoke/memory`.

mod mps;

pub use mps::Mps;

use saltus_probe::Real;

use crate::robot::Robot;

/// A board.
pub trait Board<T: Real> {
    /// Frequency of SysTick's clock, Hz; a multiple of 10 kHz.
    const TIMER_HZ: u32;

    /// What hangs on it.
    type Robot: Robot<T>;

    /// The robot, at rest.
    fn robot() -> Self::Robot;
}
