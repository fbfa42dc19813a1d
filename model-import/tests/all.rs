//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod arm;
mod axes;
mod bad_files;
mod builds;
mod couplings;
mod mjcf;
mod sizes;
