//! A1's double backflip in closed loop, in f32.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::flight::a1::<f32, _>);
