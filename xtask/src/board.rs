//! The boards that the images run on, as QEMU knows them.

use std::path::Path;
use std::process::Command;

use crate::replay::Loops;

/// A board and how to build for it.
pub(crate) struct Board {
    /// QEMU's name of the machine, and of the memory map in `firmware/memory/maps`.
    pub(crate) name: &'static str,
    /// The processor, for people.
    pub(crate) processor: &'static str,
    pub(crate) target: &'static str,
    pub(crate) rustflags: &'static [&'static str],
    /// The images of `firmware/smoke/src/bin` that run on it.
    pub(crate) images: &'static [&'static str],
    /// The images that fly whole jumps.
    pub(crate) jumps: &'static [&'static str],
    /// The images that fly under interrupts.
    pub(crate) loops: &'static [Loops],
}

impl Board {
    /// QEMU with an image on this board, whose output is its standard output.
    pub(crate) fn emulator(&self, image: &Path) -> Command {
        let mut qemu = Command::new("qemu-system-arm");
        qemu.args(["-machine", self.name, "-nographic"])
            .args(["-monitor", "none", "-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .arg("-kernel")
            .arg(image);
        qemu
    }
}

/// Loops without a framework.
const fn bare(image: &'static str, replay: &'static str) -> Loops {
    Loops {
        package: "saltus-loops",
        image,
        replay,
    }
}

/// A1's loops under a framework, in double precision.
const fn starter(image: &'static str) -> Loops {
    Loops {
        package: "saltus-starters",
        image,
        replay: "a1-f64",
    }
}

/// The image that is built quickest, and on every board: the proof that the proof can fail needs only one.
pub(crate) const QUICKEST: &str = "control-a1-f32";

pub(crate) const BOARDS: [Board; 3] = [
    Board {
        name: "mps2-an500",
        processor: "Cortex-M7, f32 and f64 in hardware",
        target: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m7"],
        images: &[
            "basics-f64",
            "basics-f32",
            "a1-f64",
            "a1-f32",
            "icub-f64",
            "icub-f32",
            "control-a1-f64",
            QUICKEST,
            "control-icub-f64",
            "control-icub-f32",
            "planner-f64",
            "planner-f32",
        ],
        jumps: &["jump-a1-f64", "jump-icub-f64"],
        loops: &[
            bare("loop-a1-f64", "a1-f64"),
            bare("loop-icub-f64", "icub-f64"),
            starter("rtic-a1"),
            starter("embassy-a1"),
        ],
    },
    Board {
        name: "mps2-an386",
        processor: "Cortex-M4F, f64 in software",
        target: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m4"],
        images: &[
            "basics-f64",
            "basics-f32",
            "a1-f32",
            QUICKEST,
            "control-icub-f32",
        ],
        jumps: &["jump-a1-f32"],
        loops: &[bare("loop-a1-f32", "a1-f32")],
    },
    Board {
        // `-Ctarget-cpu=cortex-m55` crashes LLVM (2026-11) while it builds `core`: the plain target, without Helium.
        name: "mps3-an547",
        processor: "Cortex-M55, f64 in software",
        target: "thumbv8m.main-none-eabihf",
        rustflags: &[],
        // The instruction memory holds 512 KiB: the basics are larger, and run on the other two.
        images: &["a1-f32", QUICKEST],
        jumps: &["jump-a1-f32"],
        loops: &[],
    },
];

/// Which boards and images a command works on, and how it builds for them.
#[derive(clap::Args)]
pub(crate) struct Selection {
    /// Where `core` comes from.
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) core: crate::bare::Choice,
    /// Only this board.
    #[arg(long, value_parser = BOARDS.map(|board| board.name))]
    board: Option<String>,
    /// Only this image.
    #[arg(long, value_parser = names())]
    image: Option<String>,
}

/// The names of all images.
fn names() -> Vec<&'static str> {
    let boards = BOARDS.iter();
    let mut names: Vec<_> = boards
        .flat_map(|board| board.images.iter().chain(board.jumps))
        .copied()
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}

impl Selection {
    /// The boards called for: the one named, or all.
    pub(crate) fn boards(&self) -> impl Iterator<Item = &'static Board> {
        BOARDS
            .iter()
            .filter(|board| self.board.as_deref().is_none_or(|only| only == board.name))
    }

    /// A board's jumps called for: the one named, or all.
    pub(crate) fn jumps(&self, board: &Board) -> impl Iterator<Item = &'static str> {
        let jumps = board.jumps.iter().copied();
        jumps.filter(|jump| self.image.as_deref().is_none_or(|only| only == *jump))
    }

    /// Whether all images of all boards are called for.
    pub(crate) fn names_nothing(&self) -> bool {
        self.image.is_none() && self.board.is_none()
    }

    /// Whether all images of a board are called for.
    pub(crate) fn names_no_image(&self) -> bool {
        self.image.is_none()
    }

    /// A board's images called for: the one named, or all.
    pub(crate) fn images(&self, board: &Board) -> impl Iterator<Item = &'static str> {
        let images = board.images.iter().copied();
        images.filter(|image| self.image.as_deref().is_none_or(|only| only == *image))
    }
}
