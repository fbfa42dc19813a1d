//! Arm's MPS boards, as QEMU emulates them: AN386 (Cortex-M4F), AN500 (Cortex-M7), AN547 (Cortex-M55). The robot is simulated in
//! the joint interrupt, in the place of its bus.

use a1_model::A1Geared;
use rbd_core::Model;
use saltus_probe::flight::{Flight, IcubFlight, Planned};

use super::Board;
use crate::semihosting;

/// The board.
#[derive(Clone, Copy, Debug)]
pub struct Mps;

impl<T: Planned> Board<T, 12> for Mps
where
    A1Geared: Model<T, 12>,
{
    // MPS2 counts at 25 MHz. MPS3 counts at 32 MHz: there the loops are slower by a fifth in virtual time, and no less equal.
    const TIMER_HZ: u32 = 25_000_000;

    type Robot = Flight<T>;

    fn robot(_: &mut cortex_m::Peripherals) -> Flight<T> {
        Flight::new()
    }

    fn idle(drain: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
        semihosting::write_out(drain)
    }

    fn fault() -> ! {
        semihosting::fail()
    }
}

impl Board<f64, 23> for Mps {
    // Four times slower: simulating iCub takes longer than a joint tick's period.
    const TIMER_HZ: u32 = 4 * 25_000_000;

    type Robot = IcubFlight;

    fn robot(_: &mut cortex_m::Peripherals) -> IcubFlight {
        IcubFlight::new()
    }

    fn idle(drain: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
        semihosting::write_out(drain)
    }

    fn fault() -> ! {
        semihosting::fail()
    }
}
