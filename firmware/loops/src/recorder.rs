//! The flight recorder: a ring of bytes of fixed size that a slower writer empties.
//!
//! Everything that the controllers hear is written before it is used, with a digest of what they answer; so the flight can be
//! replayed on a host, and the replay checked tick by tick ([`crate::replay`]). Nothing waits: a record that does not fit is
//! counted as lost, and the replay says so.
//!
//! | record | bytes |
//! |---|---|
//! | control tick, at 1 kHz | `c`, number (4), every number heard, digest of the command (8) |
//! | joint tick, at 10 kHz | `j`, number of the command in force (4), positions and velocities, digest of the torques (8) |
//! | end | `e`, records lost (4) |

use saltus_probe::Numbers;
use saltus_probe::flight::digest;

/// Most numbers that a tick hears: iCub's base (12), its velocity (6), positions, velocities and torques of 23 joints, forces on two
/// soles, and their age.
const HEARD: usize = 90;
/// Longest record in bytes: `HEARD` double-precision numbers and what stands around them.
const LONGEST: usize = 1 + 4 + 8 * HEARD + 8;

/// A ring of `B` bytes.
#[derive(Debug)]
pub struct Recorder<const B: usize> {
    ring: [u8; B],
    first: usize,
    used: usize,
    most: usize,
    lost: u32,
}

impl<const B: usize> Recorder<B> {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ring: [0; B],
            first: 0,
            used: 0,
            most: 0,
            lost: 0,
        }
    }

    /// A record of what was heard and of what came of it.
    pub fn record<I: Numbers, O: Numbers>(&mut self, kind: u8, number: u32, heard: &I, answer: &O) {
        let mut record = [0; LONGEST];
        let mut length = 0;
        let mut put = |bytes: &[u8]| {
            for byte in bytes {
                if let Some(slot) = record.get_mut(length) {
                    *slot = *byte;
                    length += 1;
                }
            }
        };
        put(&[kind]);
        put(&number.to_le_bytes());
        heard.visit(&mut |x| put(&x.to_bits().to_le_bytes()));
        put(&digest(answer).to_le_bytes());
        self.push(record.get(..length).unwrap_or_default());
    }

    /// The last record.
    pub fn end(&mut self) {
        let [a, b, c, d] = self.lost.to_le_bytes();
        self.push(&[b'e', a, b, c, d]);
    }

    fn push(&mut self, record: &[u8]) {
        if self.used + record.len() > B {
            self.lost = self.lost.saturating_add(1);
            return;
        }
        for byte in record {
            let at = (self.first + self.used) % B.max(1);
            if let Some(slot) = self.ring.get_mut(at) {
                *slot = *byte;
            }
            self.used += 1;
        }
        self.most = self.most.max(self.used);
    }

    /// Takes the oldest bytes; returns how many.
    pub fn take(&mut self, out: &mut [u8]) -> usize {
        let count = self.used.min(out.len());
        for (i, slot) in out.iter_mut().enumerate().take(count) {
            let at = (self.first + i) % B.max(1);
            *slot = self.ring.get(at).copied().unwrap_or_default();
        }
        self.first = (self.first + count) % B.max(1);
        self.used -= count;
        count
    }

    /// Records lost, and the most bytes that waited.
    #[must_use]
    pub const fn losses(&self) -> (u32, usize) {
        (self.lost, self.most)
    }
}

impl<const B: usize> Default for Recorder<B> {
    fn default() -> Self {
        Self::new()
    }
}
