//! Every integration test of the crate in one program: linked once.

mod centring;
mod flight;
mod humanoid;
mod machine;
mod similarity;
