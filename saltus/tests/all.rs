//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod command;
mod damage;
mod envelope;
mod hostile;
mod import;
mod keys;
mod kindness;
mod one_plan;
mod options;
mod plan_task;
mod proven;
mod recording;
mod reference;
mod refusals;
mod refused;
mod run_icub;
mod run_lateral;
mod run_robot;
mod run_stored;
mod streams;
mod values;
mod watch;
