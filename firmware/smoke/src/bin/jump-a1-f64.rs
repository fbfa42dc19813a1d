//! A1's double backflip in closed loop, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::flight::a1::<f64, _>);
