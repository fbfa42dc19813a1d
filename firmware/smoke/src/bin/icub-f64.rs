//! The dynamics of iCub-23, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::icub::<f64, _>);
