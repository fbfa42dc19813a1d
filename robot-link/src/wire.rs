//! Bytes that are put or taken one after the other, little-endian. Beyond the end nothing is put, and zeros come: whoever writes a layout
//! checks its length once, before or after.

use jump_control::Crc32;

/// Puts bytes into memory of the caller's.
#[derive(Debug)]
pub struct Writer<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Writer<'a> {
    /// At the beginning of `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Bytes as they are.
    pub fn put(&mut self, bytes: &[u8]) {
        let end = self.at.saturating_add(bytes.len());
        if let Some(room) = self.bytes.get_mut(self.at..end) {
            for (to, from) in room.iter_mut().zip(bytes) {
                *to = *from;
            }
        }
        self.at = end;
    }

    /// Single-precision numbers.
    pub fn numbers(&mut self, numbers: &[f32]) {
        for x in numbers {
            self.put(&x.to_le_bytes());
        }
    }

    /// So many bytes of zero.
    pub fn zeros(&mut self, count: usize) {
        for _ in 0..count {
            self.put(&[0]);
        }
    }

    /// What has been put so far.
    #[must_use]
    pub fn written(&self) -> &[u8] {
        self.bytes.get(..self.at).unwrap_or_default()
    }

    /// Puts the CRC-32 of Ethernet of everything before.
    pub fn seal(&mut self) {
        let sum = Crc32::START.with(self.written()).value();
        self.put(&sum.to_le_bytes());
    }

    /// How many bytes have been put; `None` if they had no room.
    #[must_use]
    pub const fn length(&self) -> Option<usize> {
        if self.at <= self.bytes.len() {
            Some(self.at)
        } else {
            None
        }
    }
}

/// Takes bytes from memory.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// At the beginning of `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next `K` bytes.
    pub fn take<const K: usize>(&mut self) -> [u8; K] {
        match self.rest.split_first_chunk::<K>() {
            Some((taken, rest)) => {
                self.rest = rest;
                *taken
            }
            None => {
                self.rest = &[];
                [0; K]
            }
        }
    }

    /// The next single-precision number.
    pub fn number(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    /// The next `K` of them.
    pub fn numbers<const K: usize>(&mut self) -> [f32; K] {
        core::array::from_fn(|_| self.number())
    }
}

/// Whether the last four bytes are the CRC-32 of Ethernet of those before, as [`Writer::seal`] puts it.
#[must_use]
pub fn is_sealed(bytes: &[u8]) -> bool {
    bytes
        .split_last_chunk::<4>()
        .is_some_and(|(body, sum)| Crc32::START.with(body).value() == u32::from_le_bytes(*sum))
}
