//! A1's loops under interrupts, in f32.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
saltus_loops::image!(
    f32,
    12,
    saltus_loops::control::Jumper<f32>,
    saltus_loops::boards::Mps
);

#[cfg(not(target_os = "none"))]
fn main() {}
