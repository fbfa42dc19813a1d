//! Every integration test of the crate in one program: linked once.

mod centring;
mod flight;
mod humanoid;
mod humanoid_ground;
mod machine;
mod pre_landing;
mod similarity;
