//! What an image writes, on the host: without cost lines.

use core::hint::black_box;
use std::io::{BufWriter, StdoutLock, Write, stdout};

use saltus_probe::{Label, Part, Recorder};

pub(crate) struct Host {
    out: BufWriter<StdoutLock<'static>>,
    failed: Option<std::io::Error>,
}

impl Host {
    fn keep_error(&mut self, result: std::io::Result<()>) {
        if let Err(error) = result {
            self.failed.get_or_insert(error);
        }
    }
}

impl Recorder for Host {
    fn call_named<I, R>(
        &mut self,
        input: I,
        work: impl FnOnce(I) -> R,
        name: impl FnOnce(&R) -> Label,
    ) -> R {
        let result = black_box(work(black_box(input)));
        let written = writeln!(self.out, "call {}", name(&result));
        self.keep_error(written);
        result
    }

    fn value(&mut self, bits: u64) {
        let result = writeln!(self.out, "value {bits:016x}");
        self.keep_error(result);
    }
}

/// Runs the part that the first argument names.
pub(crate) fn run(parts: &[Part<Host>]) -> std::io::Result<()> {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let Some((_, part)) = parts.iter().find(|(name, _)| *name == wanted) else {
        let names: Vec<_> = parts.iter().map(|(name, _)| *name).collect();
        return Err(std::io::Error::other(format!(
            "name one of: {}",
            names.join(", ")
        )));
    };
    let mut host = Host {
        out: BufWriter::new(stdout().lock()),
        failed: None,
    };
    part(&mut host);
    let result = host.out.flush();
    host.keep_error(result);
    host.failed.map_or(Ok(()), Err)
}
