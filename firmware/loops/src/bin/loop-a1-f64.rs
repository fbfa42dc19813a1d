//! A1's loops under interrupts, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
saltus_loops::image!(
    f64,
    12,
    saltus_loops::control::Jumper<f64>,
    saltus_loops::boards::Mps
);

#[cfg(not(target_os = "none"))]
fn main() {}
