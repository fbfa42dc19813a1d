//! A1's control loops as firmware runs them: joint PD at 10 kHz and jump machine at 1 kHz, each in its interrupt, and a flight
//! recorder whose bytes replay on a host.
//!
//! | module | what it is |
//! |---|---|
//! | [`robot`] | the hardware behind one small trait: encoders, sensors, motors |
//! | [`joints`] | what happens at 10 kHz |
//! | [`control`] | what happens at 1 kHz |
//! | [`recorder`] | a ring of bytes with everything heard |
//! | [`replay`] | the same loops on a host, from those bytes |
//! | `boards` | one file per family of boards: clock, timer, and the robot that hangs on it |
#![cfg_attr(target_os = "none", no_std)]

pub mod control;
pub mod joints;
pub mod recorder;
pub mod robot;

#[cfg(target_os = "none")]
pub mod boards;
#[cfg(target_os = "none")]
pub mod firmware;
#[cfg(not(target_os = "none"))]
pub mod replay;
