//! Standard output and standard error. What cannot be written is told by the exit code, not by a panic; the work goes on, since its
//! files are worth having even where nobody reads the text.

use core::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// Exit code where the reader of the output has gone, as shells tell it of programs that the broken pipe stops (128 + SIGPIPE).
const NO_READER: u8 = 141;

/// Why a stream takes no more; later writes to it are dropped.
type Lost = Mutex<Option<io::Error>>;

static OUT: Lost = Mutex::new(None);
static ERR: Lost = Mutex::new(None);

/// Prints a line on standard output.
macro_rules! say {
    ($($part:tt)*) => { $crate::stream::out(format_args!("{}\n", format_args!($($part)*))) };
}

/// Prints on standard output, without ending the line.
macro_rules! put {
    ($($part:tt)*) => { $crate::stream::out(format_args!($($part)*)) };
}

/// Prints a line on standard error.
macro_rules! tell {
    ($($part:tt)*) => { $crate::stream::err(format_args!("{}\n", format_args!($($part)*))) };
}

/// Writes to standard output.
pub(crate) fn out(text: Arguments<'_>) {
    attempt(&OUT, || io::stdout().lock().write_fmt(text));
}

/// Writes to standard error.
pub(crate) fn err(text: Arguments<'_>) {
    attempt(&ERR, || io::stderr().lock().write_fmt(text));
}

/// Writes through clap, which chooses stream and colours.
pub(crate) fn clap(message: &clap::Error) {
    let lost = if message.use_stderr() { &ERR } else { &OUT };
    attempt(lost, || message.print());
}

fn attempt(lost: &Lost, write: impl FnOnce() -> io::Result<()>) {
    let mut lost = lost.lock().unwrap_or_else(PoisonError::into_inner);
    if lost.is_none() {
        *lost = write().err();
    }
}

fn take(lost: &Lost) -> Option<io::Error> {
    lost.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// The exit code of the program: `code` if everything was said, 141 in silence where the reader has gone, else 1 with the reason.
pub(crate) fn finish(code: ExitCode) -> ExitCode {
    attempt(&OUT, || io::stdout().flush());
    let streams = [
        ("standard output", take(&OUT)),
        ("standard error", take(&ERR)),
    ];
    let lost = streams
        .into_iter()
        .find_map(|(name, error)| Some((name, error?)));
    match lost {
        None => code,
        Some((_, error)) if error.kind() == ErrorKind::BrokenPipe => ExitCode::from(NO_READER),
        Some((name, error)) => {
            tell!("saltus: {name} cannot be written: {error}");
            ExitCode::from(1)
        }
    }
}
