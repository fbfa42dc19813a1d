#![doc = include_str!("../README.md")]
#![no_std]

#[rustfmt::skip]
pub mod cad;
#[rustfmt::skip]
pub mod gazebo;

pub use cad::Icub23Cad;
pub use gazebo::Icub23;
