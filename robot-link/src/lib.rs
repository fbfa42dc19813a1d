#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod adapters;
mod board;
mod command;
mod end;
pub mod packet;
mod peer;
pub mod pilot;
#[cfg(feature = "std")]
pub mod recording;
mod state;
#[cfg(feature = "std")]
mod udp;
pub mod wire;

pub use board::Board;
pub use command::Command;
pub use end::End;
pub use packet::{Packet, Refusal};
pub use peer::{Heard, LIMIT, Peer, Tally};
pub use pilot::Pilot;
pub use state::State;
#[cfg(feature = "std")]
pub use udp::UdpLink;
