//! Packets: a header, numbers, and the CRC-32 of Ethernet of both. Everything is little-endian, numbers are in single precision.
//!
//! | bytes | |
//! |---|---|
//! | 0..2 | mark of the kind: `0x4d43` a command, `0x5453` a state |
//! | 2, 3 | joints, feet (a command has 0 feet) |
//! | 4..8 | number of the packet |
//! | 8..16 | stamp: the sender's clock when it was sent, ns |
//! | 16..20 | echo: number of the newest packet that the sender has heard |
//! | 20..24 | how long ago it had heard that, µs |
//! | 24..32 | that packet's stamp, on the clock of the hearer; all ones if it has heard nothing |
//! | 32.. | what the kind says |
//! | last 4 | CRC-32 |
//!
//! The echo is what makes an age of a stamp. The clocks of two ends have nothing to do with each other; but what comes back of one's own
//! stamp, less the time for which the other end had it, is the time on the way there and back: a round trip, which this packet's own way
//! is part of.

use core::fmt;

use crate::wire::{Reader, Writer, is_sealed};

/// Bytes before what the kind says.
const HEADER: usize = 32;

/// A kind of packet.
pub trait Packet: Copy {
    /// First two bytes.
    const MARK: u16;
    /// Joints and feet.
    const SHAPE: [u8; 2];
    /// Bytes of what it says.
    const BODY: usize;
    /// Bytes of the whole packet.
    const LENGTH: usize = HEADER + Self::BODY + 4;

    /// Puts [`Packet::BODY`] bytes.
    fn write(&self, to: &mut Writer<'_>);

    /// Takes them.
    fn read(from: &mut Reader<'_>) -> Self;

    /// Whether somebody may act on it.
    fn is_usable(&self) -> bool;
}

/// What a sender has heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Echo {
    /// Number of the newest packet.
    pub number: u32,
    /// How long ago that came, µs; no longer than 71 minutes.
    pub held_us: u32,
    /// Its stamp, ns.
    pub stamp: u64,
}

/// What every packet begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Number of the packet: one more than that of the last.
    pub number: u32,
    /// Clock of the sender, ns.
    pub stamp: u64,
    /// What the sender has heard.
    pub echo: Option<Echo>,
}

/// The stamp of an echo of nothing.
const NOTHING: u64 = u64::MAX;

/// Why a packet is not in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// Too few bytes.
    CutOff,
    /// Too many.
    TooLong,
    /// Not of this kind.
    Mark,
    /// Not of a robot with as many joints and feet.
    Shape,
    /// A bit is not as it was sent.
    Checksum,
    /// A number that nobody may act on.
    Number,
    /// Its round trip took longer than [`LIMIT`](crate::LIMIT), so it may be as old.
    Late,
    /// It echoes something that this end has not sent.
    Foreign,
    /// Its sender has heard nothing of this end yet: nobody can say how old it is. The answer to it will be an echo.
    Unproven,
    /// The newest one once more.
    Repeated,
    /// An older one than the newest.
    Overtaken,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CutOff => "too few bytes",
            Self::TooLong => "too many bytes",
            Self::Mark => "not a packet of this kind",
            Self::Shape => "a packet of a robot with other joints or feet",
            Self::Checksum => "a bit is not as it was sent",
            Self::Number => "a number that nobody may act on",
            Self::Late => "too long on the way",
            Self::Foreign => "an echo of something that was never sent",
            Self::Unproven => "its sender has heard nothing yet",
            Self::Repeated => "the same packet again",
            Self::Overtaken => "an older packet than the newest",
        })
    }
}

impl core::error::Error for Refusal {}

/// Writes a packet to the beginning of `out`; returns its length, or `None` if there is no room for it.
pub fn encode<P: Packet>(header: &Header, packet: &P, out: &mut [u8]) -> Option<usize> {
    let mut to = Writer::new(out.get_mut(..P::LENGTH)?);
    let echo = header.echo.unwrap_or(Echo {
        number: 0,
        held_us: 0,
        stamp: NOTHING,
    });
    to.put(&P::MARK.to_le_bytes());
    to.put(&P::SHAPE);
    to.put(&header.number.to_le_bytes());
    to.put(&header.stamp.to_le_bytes());
    to.put(&echo.number.to_le_bytes());
    to.put(&echo.held_us.to_le_bytes());
    to.put(&echo.stamp.to_le_bytes());
    packet.write(&mut to);
    to.seal();
    to.length()
}

/// Reads a packet from bytes that are it and nothing else.
///
/// # Errors
/// [`Refusal`]: its length, its kind, or a bit that is not as it was sent. Any numbers are read, also those that nobody may act on.
pub fn decode<P: Packet>(bytes: &[u8]) -> Result<(Header, P), Refusal> {
    if bytes.len() != P::LENGTH {
        return Err(if bytes.len() < P::LENGTH {
            Refusal::CutOff
        } else {
            Refusal::TooLong
        });
    }
    let mut from = Reader::new(bytes);
    if u16::from_le_bytes(from.take()) != P::MARK {
        return Err(Refusal::Mark);
    }
    if !is_sealed(bytes) {
        return Err(Refusal::Checksum);
    }
    if from.take() != P::SHAPE {
        return Err(Refusal::Shape);
    }
    let (number, stamp) = (
        u32::from_le_bytes(from.take()),
        u64::from_le_bytes(from.take()),
    );
    let echo = Echo {
        number: u32::from_le_bytes(from.take()),
        held_us: u32::from_le_bytes(from.take()),
        stamp: u64::from_le_bytes(from.take()),
    };
    let header = Header {
        number,
        stamp,
        echo: (echo.stamp != NOTHING).then_some(echo),
    };
    Ok((header, P::read(&mut from)))
}
