//! Every integration test of the crate in one program: linked once.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

mod common;
mod confidence;
mod faults;
mod kalman;
mod legs;
mod level;
mod place;
