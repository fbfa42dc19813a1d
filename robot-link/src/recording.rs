//! Everything that an end heard and said, and the same again: an end has no clock and draws no numbers, so what it heard at which times is
//! all that it needs to say the same bits once more.
//!
//! | record | bytes |
//! |---|---|
//! | a datagram came | `h`, time (8), length (2), its bytes |
//! | a turn | `t`, time (8), length (2), the bytes that were sent |
//! | end | `e` |

use core::fmt;
use std::vec::Vec;

use crate::end::End;
use crate::wire::Reader;

/// Most bytes of a datagram that an end sends.
pub const LONGEST: usize = 1024;

/// An end that writes down what it hears and says.
pub struct Recorded<'e, E> {
    end: &'e mut E,
    bytes: Vec<u8>,
}

impl<'e, E: End> Recorded<'e, E> {
    /// From now on, with memory for so many bytes: what is put aside before the flight does not have to be found in it.
    pub fn new(end: &'e mut E, capacity: usize) -> Self {
        Self {
            end,
            bytes: Vec::with_capacity(capacity),
        }
    }

    /// The end itself.
    pub const fn end(&mut self) -> &mut E {
        self.end
    }

    /// The whole recording.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.bytes.push(b'e');
        self.bytes
    }

    fn record(&mut self, kind: u8, now: u64, datagram: &[u8]) {
        // No datagram is longer than 64 kB.
        let length = datagram.len().min(usize::from(u16::MAX));
        self.bytes.push(kind);
        self.bytes.extend(now.to_le_bytes());
        self.bytes.extend((length as u16).to_le_bytes());
        self.bytes.extend(datagram.iter().take(length));
    }
}

impl<E: End> End for Recorded<'_, E> {
    fn hear(&mut self, bytes: &[u8], now: u64) {
        self.record(b'h', now, bytes);
        self.end.hear(bytes, now);
    }

    fn turn(&mut self, now: u64, out: &mut [u8]) -> Option<usize> {
        let length = self.end.turn(now, out);
        let said = length.and_then(|length| out.get(..length));
        self.record(b't', now, said.unwrap_or_default());
        length
    }
}

/// Why a recording does not replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The bytes end inside a record, or without the last one.
    CutOff(usize),
    /// No record begins at this byte.
    Unknown(usize),
    /// In this turn other bits were said than the recorded ones.
    Different(u32),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CutOff(at) => write!(f, "the recording is cut off at byte {at}"),
            Self::Unknown(at) => write!(f, "no record begins at byte {at}"),
            Self::Different(turn) => write!(f, "turn {turn} differs from the recording"),
        }
    }
}

impl core::error::Error for Error {}

/// Lets an end that is as the recorded one was hear the same, and compares what it says; returns how many turns it said the recorded bits in.
///
/// # Errors
/// [`Error`] names the first byte or turn that is not as recorded.
pub fn replay(recording: &[u8], end: &mut impl End) -> Result<u32, Error> {
    let (mut at, mut turns) = (0, 0);
    loop {
        let rest = recording.get(at..).unwrap_or_default();
        let kind = *rest.first().ok_or(Error::CutOff(at))?;
        if kind == b'e' {
            return Ok(turns);
        }
        if kind != b'h' && kind != b't' {
            return Err(Error::Unknown(at));
        }
        let mut from = Reader::new(rest.get(1..).unwrap_or_default());
        let now = u64::from_le_bytes(from.take());
        let length = usize::from(u16::from_le_bytes(from.take()));
        let datagram = rest.get(11..11 + length).ok_or(Error::CutOff(at))?;
        if kind == b'h' {
            end.hear(datagram, now);
        } else {
            let mut out = [0; LONGEST];
            let said = end.turn(now, &mut out).and_then(|said| out.get(..said));
            if said.unwrap_or_default() != datagram {
                return Err(Error::Different(turns));
            }
            turns += 1;
        }
        at += 11 + length;
    }
}
