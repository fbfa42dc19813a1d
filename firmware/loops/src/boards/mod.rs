//! Boards: what differs between them, in one file each, beside their memory map in `firmware/memory/maps`. Those with hardware are in
//! `firmware/boards`, since each needs its chip's registers.

mod mps;

pub use mps::Mps;

use saltus_probe::Real;

use crate::robot::Robot;

/// A board with a robot of `N` joints.
pub trait Board<T: Real, const N: usize> {
    /// Frequency of SysTick's clock, Hz; a multiple of 10 kHz.
    const TIMER_HZ: u32;

    /// What hangs on it.
    type Robot: Robot<T, N>;

    /// Clocks, memories and pins as they must be, and the robot at rest. A board that does not come up does not return.
    fn robot(core: &mut cortex_m::Peripherals) -> Self::Robot;

    /// What is done when nothing else is to do. `drain` gives bytes of the flight recorder, and says whether more will come.
    fn idle(drain: impl FnMut(&mut [u8]) -> (usize, bool)) -> !;

    /// Where a processor's fault ends.
    fn fault() -> !;
}
