//! Text to the host's standard output, by semihosting. `core::fmt` stays out: its padding code can panic.

use cortex_m_semihosting::hio::{HostStream, hstdout};

const CAPACITY: usize = 4096;

/// A buffered stream: every semihosting call halts the processor, so they are few.
pub(crate) struct Console {
    stream: HostStream,
    buffer: [u8; CAPACITY],
    used: usize,
    failed: bool,
}

impl Console {
    pub(crate) fn open() -> Option<Self> {
        let stream = hstdout().ok()?;
        Some(Self {
            stream,
            buffer: [0; CAPACITY],
            used: 0,
            failed: false,
        })
    }

    #[inline(never)]
    pub(crate) fn text(&mut self, text: &str) {
        text.bytes().for_each(|byte| self.byte(byte));
    }

    /// Sixteen hexadecimal digits.
    #[inline(never)]
    pub(crate) fn hex(&mut self, bits: u64) {
        for nibble in (0..16).rev().map(|place| (bits >> (4 * place)) as u8 & 0xf) {
            self.byte(if nibble < 10 {
                b'0' + nibble
            } else {
                b'a' + (nibble - 10)
            });
        }
    }

    /// Writes what is left; true if everything reached the host.
    pub(crate) fn close(&mut self) -> bool {
        self.flush();
        !self.failed
    }

    fn byte(&mut self, byte: u8) {
        if self.used >= CAPACITY {
            self.flush();
        }
        if let Some(slot) = self.buffer.get_mut(self.used) {
            *slot = byte;
            self.used += 1;
        }
    }

    fn flush(&mut self) {
        let filled = self.buffer.get(..self.used).unwrap_or_default();
        self.failed |= self.stream.write_all(filled).is_err();
        self.used = 0;
    }
}
