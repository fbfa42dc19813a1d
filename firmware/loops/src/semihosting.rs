//! An emulated board's host: it takes the flight recorder, and is told how the run ended.

use cortex_m_semihosting::debug;
use cortex_m_semihosting::hio::hstdout;

/// An idle loop: what `drain` gives goes to the host; ends QEMU when nothing more comes.
pub fn write_out(mut drain: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
    if let Ok(mut stream) = hstdout() {
        let mut buffer = [0; 4096];
        loop {
            let (count, more) = drain(&mut buffer);
            let bytes = buffer.get(..count).unwrap_or_default();
            if count > 0 && stream.write_all(bytes).is_err() {
                break;
            }
            if !more {
                end(debug::EXIT_SUCCESS);
            }
        }
    }
    fail()
}

/// Ends QEMU with a failure.
pub fn fail() -> ! {
    end(debug::EXIT_FAILURE)
}

fn end(status: debug::ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}
