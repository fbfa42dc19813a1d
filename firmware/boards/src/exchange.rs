//! The two buffers of an exchange, which DMA reads and writes behind the compiler's back.

use core::cell::UnsafeCell;
use core::sync::atomic::{Ordering, compiler_fence};

use saltus_loops::frame::FRAME;

/// Buffers of a DMA: only the bus that was given them touches them, and only while no exchange is under way.
#[repr(C, align(4))]
pub(crate) struct Buffers {
    out: UnsafeCell<[u8; FRAME]>,
    back: UnsafeCell<[u8; FRAME]>,
}

// SAFETY: see `Buffers`: the one bus of an image is the only user.
unsafe impl Sync for Buffers {}

impl Buffers {
    pub(crate) const fn new() -> Self {
        Self {
            out: UnsafeCell::new([0; FRAME]),
            back: UnsafeCell::new([0; FRAME]),
        }
    }

    /// Addresses for the DMA: what it reads, and what it writes.
    pub(crate) fn addresses(&self) -> [u32; 2] {
        [self.out.get() as u32, self.back.get() as u32]
    }

    /// What goes out next. No exchange may be under way.
    pub(crate) fn fill(&self, bytes: &[u8; FRAME]) {
        // SAFETY: the memory is ours and no DMA reads it now; volatile, so that it is there before the DMA is told to begin.
        unsafe { self.out.get().write_volatile(*bytes) };
        compiler_fence(Ordering::SeqCst);
    }

    /// What came back. The exchange must have ended.
    pub(crate) fn back(&self) -> [u8; FRAME] {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: the memory is ours and no DMA writes it now; volatile, so that what the DMA wrote is read.
        unsafe { self.back.get().read_volatile() }
    }
}
