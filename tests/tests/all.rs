//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod conventions;
mod equations;
mod fuzz_control;
mod golden_files;
mod golden_fixed;
mod mjcf;
mod models;
mod plan_in_flash;
mod probe_covers;
mod shapes;
mod state_est;
mod test_files;
