#![doc = include_str!("../README.md")]
#![no_std]

pub mod budgets;
#[rustfmt::skip]
pub mod cad;
#[rustfmt::skip]
pub mod gazebo;
pub mod hardware;
pub mod limits;
pub mod profile;
pub mod robots;
pub mod shapes;

pub use budgets::BUDGETS;
pub use hardware::{MOTORS, SOLES};
pub use limits::{ANKLE_SHIFT, LIMITS};
pub use robots::{Icub23, Icub23Cad, Icub23GazeboGeared, Icub23Geared};
