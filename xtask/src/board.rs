//! The boards that the image runs on, as QEMU knows them.

/// A board and how to build for it.
pub(crate) struct Board {
    /// QEMU's name of the machine, and of the memory map in `firmware/smoke/memory`.
    pub(crate) name: &'static str,
    /// The processor, for people.
    pub(crate) processor: &'static str,
    pub(crate) target: &'static str,
    pub(crate) rustflags: &'static [&'static str],
}

pub(crate) const BOARDS: [Board; 3] = [
    Board {
        name: "mps2-an500",
        processor: "Cortex-M7, f32 and f64 in hardware",
        target: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m7"],
    },
    Board {
        name: "mps2-an386",
        processor: "Cortex-M4F, f64 in software",
        target: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m4"],
    },
    Board {
        // `-Ctarget-cpu=cortex-m55` crashes LLVM (2026-11) while it builds `core`: the plain target, without Helium.
        name: "mps3-an547",
        processor: "Cortex-M55, f64 in software",
        target: "thumbv8m.main-none-eabihf",
        rustflags: &[],
    },
];

/// The names, for the command line.
pub(crate) const NAMES: [&str; 3] = [BOARDS[0].name, BOARDS[1].name, BOARDS[2].name];

/// The boards called for: the one named, or all.
pub(crate) fn chosen(name: Option<&str>) -> impl Iterator<Item = &'static Board> {
    BOARDS
        .iter()
        .filter(move |board| name.is_none_or(|only| only == board.name))
}
