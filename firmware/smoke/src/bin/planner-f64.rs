//! The planner of a rigid body on few nodes, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::control::planner::<f64, _>);
