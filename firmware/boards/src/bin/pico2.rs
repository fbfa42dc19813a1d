//! A1's loops on a Raspberry Pi Pico 2, in f32.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
saltus_loops::image!(
    f32,
    12,
    saltus_loops::control::Pilot<f32>,
    saltus_boards::pico2::Pico2
);

#[cfg(not(target_os = "none"))]
fn main() {}
