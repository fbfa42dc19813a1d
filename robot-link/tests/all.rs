//! All tests in one program, which links once.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, reason = "tests")]

mod adapters;
mod board;
mod packets;
mod peer;
#[cfg(feature = "std")]
mod udp;
