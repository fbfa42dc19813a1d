//! iCub's loops under interrupts, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
saltus_loops::image!(
    f64,
    23,
    saltus_loops::control::Humanoid,
    saltus_loops::boards::Mps
);

#[cfg(not(target_os = "none"))]
fn main() {}
