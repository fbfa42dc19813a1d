#![doc = include_str!("../README.md")]
#![no_std]

#[rustfmt::skip]
pub mod a1;
#[rustfmt::skip]
pub mod a1_reference;

pub use a1::A1;
pub use a1_reference::A1Reference;
