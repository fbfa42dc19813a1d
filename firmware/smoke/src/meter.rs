//! Instructions and stack of one call.
//!
//! Time: under QEMU's `-icount` every instruction takes the same virtual time, so SysTick counts instructions.
//! Stack: the memory below the stack pointer is painted before the call; the deepest word that lost its paint after
//! the call is the high-water mark.

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

/// SysTick counts 24 bits, and its interrupt the turns.
const RELOAD: u32 = 0x00ff_ffff;

static TURNS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    TURNS.fetch_add(1, Ordering::Relaxed);
}

/// Bytes below the stack pointer that are watched.
const WINDOW: u32 = 128 * 1024;

/// Bytes that keep their paint below the deepest word a call wrote.
const QUIET: u32 = 16 * 1024;

const PAINT: u32 = 0xa5a5_a5a5;

/// What no measurement returns: the counter or the window was too small.
pub(crate) const SATURATED: u32 = u32::MAX;

/// What a call cost.
pub(crate) struct Cost {
    /// SysTick periods, or [`SATURATED`].
    pub(crate) ticks: u32,
    /// Bytes of stack below the caller's frame, or [`SATURATED`].
    pub(crate) stack: u32,
}

pub(crate) struct Meter {
    timer: SYST,
}

impl Meter {
    pub(crate) fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();
        Self { timer }
    }

    /// Calls `work(input)` and measures it, hiding both ends from the optimiser.
    #[inline(never)]
    pub(crate) fn measure<I, R>(&mut self, input: I, work: impl FnOnce(I) -> R) -> (R, Cost) {
        let top = paint();
        self.timer.clear_current();
        let start = now();
        let result = frame(input, work);
        let ticks = u32::try_from(now().wrapping_sub(start)).unwrap_or(SATURATED);
        (
            result,
            Cost {
                ticks,
                stack: depth_below(top),
            },
        )
    }
}

/// SysTick periods since some time in the past.
#[inline(never)]
fn now() -> u64 {
    loop {
        let turns = TURNS.load(Ordering::Relaxed);
        let left = SYST::get_current();
        // A turn between the two reads: again.
        if turns == TURNS.load(Ordering::Relaxed) {
            return u64::from(turns) * (u64::from(RELOAD) + 1)
                + u64::from(RELOAD - left.min(RELOAD));
        }
    }
}

/// The measured call in a frame of its own, so that its locals lie below the mark.
#[inline(never)]
fn frame<I, R>(input: I, work: impl FnOnce(I) -> R) -> R {
    black_box(work(black_box(input)))
}

/// Paints the window below the stack pointer, and returns the stack pointer.
///
/// All in one piece of assembly, because the compiler may move a read of the stack pointer across a push.
#[inline(always)]
fn paint() -> u32 {
    let top: u32;
    // SAFETY: nothing below the stack pointer is live: an interrupt takes its frame away again before the next
    // instruction here. And every board's memory map leaves
    // far more than the window between the stack and static data. The code pushes nothing.
    unsafe {
        core::arch::asm!(
            "mov {top}, sp",
            "mov {address}, sp",
            "2: stmdb {address}!, {{r0, r1, r2, r3}}",
            "subs {turns}, {turns}, #1",
            "bne 2b",
            top = out(reg) top,
            address = out(reg) _,
            turns = inout(reg) WINDOW / 16 => _,
            in("r0") PAINT,
            in("r1") PAINT,
            in("r2") PAINT,
            in("r3") PAINT,
            options(nostack),
        );
    }
    top
}

/// Bytes between `top` and the deepest word that is not painted any more.
///
/// Looks down from `top` until a [`QUIET`] stretch has kept its paint, which saves reading the whole window after
/// every call; a call that skips so much stack and then uses more would be measured short.
#[inline(always)]
fn depth_below(top: u32) -> u32 {
    let mut deepest = top;
    let mut address = top;
    while address > top - WINDOW && deepest - address < QUIET {
        address -= 4;
        // SAFETY: the window is memory of the stack, as in `paint`; this only reads.
        if unsafe { (address as *const u32).read_volatile() } != PAINT {
            deepest = address;
        }
    }
    if top - deepest + QUIET > WINDOW {
        SATURATED
    } else {
        top - deepest
    }
}

/// Two instructions per turn, whatever the compiler does.
pub(crate) fn counted_loop(turns: u32) {
    // SAFETY: touches one register and the flags; `turns` is not zero.
    unsafe {
        core::arch::asm!(
            "2: subs {left}, {left}, #1",
            "bne 2b",
            left = inout(reg) turns => _,
            options(nomem, nostack),
        );
    }
}
