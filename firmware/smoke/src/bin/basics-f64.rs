//! Elementary functions, rotations, spatial algebra, and a small robot with every joint kind, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::basics::<f64, _>);
