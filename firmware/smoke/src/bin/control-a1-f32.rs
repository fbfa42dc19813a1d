//! Programs, loops, estimator and simulator on A1, in f32.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::control::a1::<f32, _>);
