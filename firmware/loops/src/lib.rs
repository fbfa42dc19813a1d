//! Control loops as firmware runs them: joint PD at 10 kHz and A1's or iCub's jump machine at 1 kHz, each in its
//! interrupt, and a flight recorder whose bytes replay on a host.
//!
//! | module | what it is |
//! |---|---|
//! | [`robot`] | the hardware behind one small trait: encoders, sensors, motors |
//! | [`joints`] | what happens at 10 kHz |
//! | [`control`] | what happens at 1 kHz |
//! | [`shared`] | robot, command in force and flight recorder: what both loops touch |
//! | [`recorder`] | a ring of bytes with everything heard |
//! | [`replay`] | the same loops on a host, from those bytes |
//! | [`link`], [`frame`] | a robot at the other end of a bus, and what goes over it |
//! | `firmware`, `semihosting` | the interrupts of an image, and the host of an emulated one |
//! | `boards` | one file per family of boards: clock, timer, and the robot that hangs on it |
#![cfg_attr(target_os = "none", no_std)]

pub mod control;
pub mod frame;
pub mod joints;
pub mod link;
pub mod recorder;
pub mod robot;
pub mod shared;

#[cfg(target_os = "none")]
pub mod boards;
#[cfg(target_os = "none")]
pub mod firmware;
#[cfg(not(target_os = "none"))]
pub mod replay;
#[cfg(target_os = "none")]
pub mod semihosting;
