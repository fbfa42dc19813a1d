#![doc = include_str!("../README.md")]

pub mod closed_loop;
pub mod humanoid;
pub mod lab;
pub mod log;
pub mod noise;
pub mod papers;
pub mod quadruped;
mod sim;
pub mod verdict;

pub use sim::Sim;
