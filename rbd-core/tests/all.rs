//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod abreast;
mod common;
mod contact;
mod convert;
mod derivatives;
mod fixed_base;
mod friction;
mod identities;
mod manifold;
mod names;
mod oracle;
mod reduction;
mod second_order;
