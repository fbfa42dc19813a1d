//! Every test that plans, in one program: the planner is linked and not compiled a second time.
#![allow(clippy::unwrap_used, reason = "tests")]

mod bounds;
mod plan;
mod planned;
mod reference;
mod robots;
