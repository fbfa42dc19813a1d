//! The dynamics of A1, in f64.
#![no_std]
#![no_main]

saltus_smoke::image!(saltus_probe::a1::<f64, _>);
