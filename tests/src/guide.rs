//! The Rust of the documents (`docs`), compiled and run as documentation tests.

/// A few lines for each crate.
#[doc = include_str!("../../docs/CRATES.md")]
pub mod crates {}

/// Landing in firmware.
#[doc = include_str!("../../docs/guide/4-firmware.md")]
pub mod firmware {}

/// Whole-body control for another robot.
#[doc = include_str!("../../docs/guide/5-whole-body-control.md")]
pub mod whole_body_control {}
