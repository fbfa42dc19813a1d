//! Ctrl-C in commands whose partial result is worth keeping: they stop after what runs now and write what they have.
//!
//! All other commands are stopped at once, since they write whole results only.

use super::failure::Failure;
use core::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a command that was stopped, as shells tell it.
pub(crate) const CODE: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Listens to Ctrl-C; the second one stops at once.
pub(crate) fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(CODE));
        }
        tell!("saltus: stopping after what runs now; Ctrl-C again stops at once");
    })
    .map_err(|error| Failure::Outside(format!("Ctrl-C cannot be listened to: {error}")))
}

/// Whether to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
