//! Every integration test of the crate in one program: linked once.

mod a1;
mod coming;
mod common;
mod contacts;
mod fixed_base;
mod paper_b;
mod rows;
mod surplus;
mod tasks;
mod torque;
mod velocity;
