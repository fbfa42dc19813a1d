//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;
mod individual_steps;
mod known_optima;
mod linear_quadratic;
mod published_optima;
