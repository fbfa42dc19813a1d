//! A1's loops as images under two frameworks for firmware in Rust. Copy the one you know.
//!
//! | image | framework | joint loop, 10 kHz | control loop, 1 kHz | idle |
//! |---|---|---|---|---|
//! | `rtic-a1` | RTIC 2 | hardware task on SysTick, priority 3 | software task, priority 1 | `#[idle]` |
//! | `embassy-a1` | Embassy | SysTick | task of an interrupt executor | task of the thread's executor |
//!
//! Both do what [`saltus_loops`] does without a framework, and their flight recordings replay by the same program.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod device;

/// What a panic does. The loops have none (the image of [`saltus_loops`] links without this function); the frameworks keep a
/// few checks of their own, so their images need an answer: here QEMU ends with a failure, a robot would brake.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn saltus_panic_is_reachable() -> ! {
    saltus_loops::semihosting::fail()
}

/// A processor's fault ends likewise.
#[cfg(target_os = "none")]
#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    saltus_loops::semihosting::fail()
}
