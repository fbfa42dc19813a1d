//! Every integration test of the crate in one program: linked once.

mod forces;
mod optimal;
