//! Every integration test of the crate in one program: linked once.

mod common;
mod forces;
mod laws;
mod optimal;
mod shaping;
mod touch;
