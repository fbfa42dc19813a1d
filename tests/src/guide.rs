//! The Rust of the guide (`docs/guide`), compiled and run as documentation tests.

/// Landing in firmware.
#[doc = include_str!("../../docs/guide/4-firmware.md")]
pub mod firmware {}

/// Whole-body control for another robot.
#[doc = include_str!("../../docs/guide/5-whole-body-control.md")]
pub mod whole_body_control {}
