//! iCub's jump in closed loop, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::flight::icub::<_>);
