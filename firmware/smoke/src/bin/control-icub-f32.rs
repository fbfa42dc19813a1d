//! The whole-body programs on iCub, in f32.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::control::icub::<f32, _>);
