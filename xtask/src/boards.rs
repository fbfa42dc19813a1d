//! The images for boards with hardware: they link without a reachable panic, and fit. Nothing here runs them.

use anyhow::{Context, Result, ensure};

use crate::bare::{Bare, Choice};
use crate::image;
use crate::run;

/// A board in `firmware/boards`: feature, image and memory map have its name.
pub(crate) struct Hardware {
    pub(crate) name: &'static str,
    pub(crate) target: &'static str,
    rustflags: &'static [&'static str],
}

pub(crate) const HARDWARE: [Hardware; 2] = [
    Hardware {
        name: "nucleo-h743zi2",
        target: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m7"],
    },
    Hardware {
        name: "pico2",
        target: "thumbv8m.main-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m33"],
    },
];

/// What a control image may take of memory, and what of it is kept for the stack.
const MEMORY: u64 = 256 * 1024;
const STACK: u64 = 32 * 1024;

/// Builds every image; prints what it takes of flash and memory.
pub(crate) fn run(core: Choice) -> Result<()> {
    for board in &HARDWARE {
        let bare = Bare::find(board.target, core)?;
        let mut build = bare.build_for(board.name, board.rustflags);
        build.args(["--quiet", "--package", "saltus-boards"]);
        build.args(["--features", board.name, "--bin", board.name]);
        run::succeed(&mut build).with_context(|| board.name)?;
        let path = image::firmware_target()?
            .join(board.target)
            .join("release")
            .join(board.name);
        let size = image::Size::of(&path)?;
        ensure!(
            size.data + STACK <= MEMORY,
            "{}: {} B of static data and {STACK} B of stack are more than {MEMORY} B",
            board.name,
            size.data
        );
        println!(
            "{}: links, no panic is reachable; flash {} B, static data {} B; not run",
            board.name, size.flash, size.data
        );
    }
    Ok(())
}
