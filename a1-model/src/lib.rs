#![doc = include_str!("../README.md")]
#![no_std]

#[rustfmt::skip]
pub mod a1;
#[rustfmt::skip]
pub mod a1_reference;
pub mod budgets;
pub mod build;
pub mod geared;
pub mod hardware;
pub mod shapes;
pub mod table1;

pub use a1::A1;
pub use a1_reference::A1Reference;
pub use budgets::BUDGETS;
pub use build::{BUILD, BUILD_F32};
pub use geared::A1Geared;
pub use hardware::{FEET, FEET_F32, FOOT_RADIUS, MOTORS, MOTORS_F32};
pub use shapes::{OWNERS, SHAPES};
