//! The bare-metal images of the probe.
//!
//! An image links only if no panic is reachable: the panic handler calls a function that exists nowhere, so the
//! handler must have been removed as unreachable. `cargo xtask smoke` builds the images, and builds one again with a
//! panic introduced to see the link fail. `cargo xtask qemu` runs them and compares their numbers with the host's.
//!
//! One image per robot and scalar, in `src/bin`, keeps each within the boards' memories.
#![no_std]

mod console;
mod meter;

use core::panic::PanicInfo;

use cortex_m_rt::exception;
use cortex_m_semihosting::debug;
use saltus_probe::{Label, Recorder};

use crate::console::Console;
use crate::meter::{Cost, Meter};

/// Measures every call and writes it to the host.
pub struct Target {
    console: Console,
    meter: Meter,
}

impl Target {
    /// Kept out of line, as everything around the calls: only the algorithms should fill the image.
    #[inline(never)]
    fn report(&mut self, label: Label, cost: Cost) {
        self.console.text("call ");
        self.console.text(label.subject);
        self.console.text("/");
        self.console.text(label.scalar);
        self.console.text("/");
        self.console.text(label.algorithm);
        self.console.text("\ncost ");
        self.console.hex(u64::from(cost.ticks));
        self.console.text(" ");
        self.console.hex(u64::from(cost.stack));
        self.console.text("\n");
    }
}

impl Recorder for Target {
    fn call_named<I, R>(
        &mut self,
        input: I,
        work: impl FnOnce(I) -> R,
        name: impl FnOnce(&R) -> Label,
    ) -> R {
        let (result, cost) = self.meter.measure(input, work);
        self.report(name(&result), cost);
        result
    }

    #[inline(never)]
    fn value(&mut self, bits: u64) {
        self.console.text("value ");
        self.console.hex(bits);
        self.console.text("\n");
    }
}

/// Lengths of the counted loop by which the host learns what a tick is.
const LOOPS: [(&str, u32); 2] = [("1000", 1000), ("2000", 2000)];

/// Runs `probe` and ends QEMU, with success if everything it wrote reached the host.
pub fn run(probe: fn(&mut Target)) -> ! {
    let (Some(core), Some(console)) = (cortex_m::Peripherals::take(), Console::open()) else {
        finish(debug::EXIT_FAILURE)
    };
    let mut target = Target {
        console,
        meter: Meter::new(core.SYST),
    };
    for (algorithm, turns) in LOOPS {
        let label = Label {
            subject: "clock",
            scalar: "loop",
            algorithm,
        };
        target.call(label, turns, meter::counted_loop);
    }
    probe(&mut target);
    let status = if target.console.close() {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    };
    finish(status)
}

fn finish(status: debug::ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}

#[exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    finish(debug::EXIT_FAILURE)
}

#[exception]
unsafe fn DefaultHandler(_: i16) {
    finish(debug::EXIT_FAILURE)
}

#[cfg(not(feature = "find_panics"))]
unsafe extern "C" {
    /// Defined nowhere: a reference that survives optimisation is a link error with this name.
    safe fn saltus_panic_is_reachable() -> !;
}

#[cfg(feature = "find_panics")]
fn saltus_panic_is_reachable() -> ! {
    finish(debug::EXIT_FAILURE)
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    saltus_panic_is_reachable()
}

/// The entry point of an image that runs one function of the probe.
#[macro_export]
macro_rules! image {
    ($probe:expr) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::run($probe)
        }
    };
}
