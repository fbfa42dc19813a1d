//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod apex;
mod common;
mod derivatives;
mod gains;
mod release;
mod split;
mod swing;
mod timing;
