//! Every integration test of the crate in one program: linked once.

mod adversarial;
mod cases;
mod collections;
mod common;
mod oracle;
mod properties;
mod published;
mod round_off;
mod seeds;
mod starts;
