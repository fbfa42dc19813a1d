#![doc = include_str!("../README.md")]

mod answer;
mod file;
mod json;
mod legs;
mod srb;
mod values;
mod whole_body;

pub use answer::Answer;
pub use file::{FEET, File, SHIPPED};
pub use legs::{SrbMotion, shipped};
