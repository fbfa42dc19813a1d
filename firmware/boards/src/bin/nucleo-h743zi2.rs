//! A1's loops on a NUCLEO-H743ZI2, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
saltus_loops::image!(
    f64,
    12,
    saltus_loops::control::Pilot<f64>,
    saltus_boards::nucleo_h743zi2::NucleoH743
);

#[cfg(not(target_os = "none"))]
fn main() {}
