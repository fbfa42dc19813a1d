//! Finds the places from which a panic is reachable, when the link proof fails.
//!
//! The image is built once more with a panic handler that exists and with its relocations kept: every call of one of
//! `core`'s panicking functions is then a relocation, and the line tables say where it comes from.

use addr2line::Loader;
use anyhow::{Context, Result, anyhow};
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget};

use crate::image::Image;
use crate::run;

/// Arguments of cargo for the image that is searched: whoever started this program may do without line tables.
const FINDING: [&str; 4] = [
    "--features",
    "find_panics",
    "--config",
    "profile.release.debug=\"line-tables-only\"",
];

/// Every place, as the chain of inlined calls around it, innermost first.
pub(crate) fn find(image: &Image<'_>) -> Result<Vec<String>> {
    let flags = [image.board.rustflags, &["-Clink-arg=--emit-relocs"]].concat();
    let path = image.build_with(&flags, &FINDING)?;
    let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
    let elf = object::File::parse(&*bytes)?;
    let lines = Loader::new(&path).map_err(|e| anyhow!("{}: {e}", path.display()))?;
    let mut found = Vec::new();
    for (address, relocation) in elf.sections().flat_map(|section| section.relocations()) {
        let RelocationTarget::Symbol(index) = relocation.target() else {
            continue;
        };
        let called = elf.symbol_by_index(index)?;
        let called = readable(called.name()?);
        let caller = readable(lines.find_symbol(address).unwrap_or_default());
        if is_panicking(&called) && !is_panicking(&caller) {
            found.push(format!("{} calls {}", chain(&lines, address)?, called));
        }
    }
    found.sort();
    found.dedup();
    Ok(found)
}

fn is_panicking(symbol: &str) -> bool {
    symbol.starts_with("core::")
        && ["panic", "_fail", "unwrap_failed", "expect_failed"]
            .iter()
            .any(|x| symbol.contains(x))
}

/// A symbol as Rust writes it, without hashes.
fn readable(symbol: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(symbol))
}

/// Where the code at `address` was written: the lines of this project, or all if none is.
fn chain(lines: &Loader, address: u64) -> Result<String> {
    let mut frames = lines.find_frames(address).map_err(|e| anyhow!("{e}"))?;
    let root = format!("{}/", run::root().display());
    let (mut ours, mut all) = (Vec::new(), Vec::new());
    while let Some(frame) = frames.next().map_err(|e| anyhow!("{e}"))? {
        let Some(location) = frame.location else {
            continue;
        };
        let file = location.file.unwrap_or("?");
        let line = location.line.unwrap_or_default();
        if let Some(file) = file.strip_prefix(&root) {
            ours.push(format!("{file}:{line}"));
        }
        all.push(format!("{file}:{line}"));
    }
    Ok(if ours.is_empty() { all } else { ours }.join(" < "))
}
