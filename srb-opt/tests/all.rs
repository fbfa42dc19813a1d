//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;
mod derivatives;
mod equations;
mod memory;
mod reference;
mod single_precision;
mod sqp_oracle;
mod threads;
mod thrust_vector;
mod unseen_jumps;
mod variants;
