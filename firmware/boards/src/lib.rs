//! Boards with hardware. Each is a file: clocks, memories, pins, and the bus on which the robot hangs.
//!
//! | feature, image | board | control loop |
//! |---|---|---|
//! | `nucleo-h743zi2` | NUCLEO-H743ZI2, Cortex-M7 at 480 MHz | [`Pilot`](saltus_loops::control::Pilot) in f64 |
//! | `pico2` | Raspberry Pi Pico 2, Cortex-M33 at 150 MHz | the same in f32 |
//!
//! Both speak SPI with the robot's board, mode 0, most significant bit first, in [frames](saltus_loops::frame): this board is the
//! master and begins one exchange per joint tick, carried by DMA. They are built and linked in CI, not run: no such board hangs there.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(all(target_os = "none", feature = "nucleo-h743zi2"))]
pub mod nucleo_h743zi2;
#[cfg(all(target_os = "none", feature = "pico2"))]
pub mod pico2;

#[cfg(target_os = "none")]
mod exchange;

/// Turns of a loop that waits for a clock to come up: some milliseconds at any clock.
#[cfg(target_os = "none")]
const PATIENCE: u32 = 1_000_000;

/// Whether this becomes true before patience ends.
#[cfg(target_os = "none")]
fn comes(mut ready: impl FnMut() -> bool) -> bool {
    (0..PATIENCE).any(|_| ready())
}

/// Nothing but interrupts from here on.
#[cfg(target_os = "none")]
fn sleep() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

/// Not even interrupts: the robot's board damps the joints after 5 ms without a frame.
#[cfg(target_os = "none")]
fn silence() -> ! {
    cortex_m::interrupt::disable();
    sleep()
}
