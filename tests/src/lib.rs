#![doc = include_str!("../README.md")]
//!
//! This library holds the shared parts: golden files and states for benches.

pub mod agree;
pub mod bench;
pub mod drops;
pub mod everything;
pub mod golden;
#[cfg(doctest)]
pub mod guide;
pub mod random_tasks;
