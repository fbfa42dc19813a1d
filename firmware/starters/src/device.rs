//! What a peripheral access crate would say of the board: two interrupts that no device uses, to run software tasks in.

pub use Interrupt as interrupt;
pub use cortex_m::Peripherals as CorePeripherals;
use cortex_m_rt::DefaultHandler_;

/// Bits of a priority that the interrupt controller looks at.
pub const NVIC_PRIO_BITS: u8 = 3;

/// Interrupts by their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Interrupt {
    /// Nobody's.
    SPARE0 = 30,
    /// Nobody's.
    SPARE1 = 31,
}

// SAFETY: the numbers are those of the table below, and fixed.
unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

unsafe extern "C" {
    fn SPARE0();
    fn SPARE1();
}

unsafe extern "C" fn unused() {
    // SAFETY: the handler of everything unexpected may be called from anywhere: it does not return.
    unsafe { DefaultHandler_() }
}

/// The table of interrupts that follows the exceptions'.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [unsafe extern "C" fn(); 32] = {
    let mut table = [unused as unsafe extern "C" fn(); 32];
    table[30] = SPARE0;
    table[31] = SPARE1;
    table
};
