//! The loops under interrupts, bare and under each framework: images fly under QEMU, and their flight recorders' bytes replay
//! on the host.

use std::fs::File;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};

use crate::bare::Bare;
use crate::board::Board;
use crate::image::{self, Size};
use crate::run;

/// An image of loops under interrupts.
pub(crate) struct Loops {
    pub(crate) package: &'static str,
    pub(crate) image: &'static str,
    /// What the replay is to be told of it.
    pub(crate) replay: &'static str,
}

/// Builds and flies a board's images, replays them, and prints what memory they take.
pub(crate) fn run(board: &Board, bare: &Bare) -> Result<()> {
    let target = image::firmware_target()?;
    for loops in board.loops {
        let name = loops.image;
        let mut build = bare.build_for(board.name, board.rustflags);
        build.args(["--quiet", "--package", loops.package, "--bin", name]);
        run::succeed(&mut build)?;
        let image = target.join(board.target).join("release").join(name);
        let data = Size::of(&image)?.data;
        let recording = target.join(name).with_extension("recording");
        let mut qemu = board.emulator(&image);
        // One instruction per nanosecond: control tick, simulated robot and recorder fit their periods.
        qemu.args(["-icount", "shift=0,align=off,sleep=off"])
            .stdin(Stdio::null())
            .stdout(File::create(&recording)?);
        run::succeed(&mut qemu).with_context(|| name)?;
        let mut replay = run::firmware_cargo();
        replay.args(["run", "--quiet", "--profile=host", "--locked"]);
        replay.args(["--package", "saltus-loops", "--bin", "replay", loops.replay]);
        let said = run::stdout(replay.arg(&recording)).with_context(|| name)?;
        ensure!(
            said.contains("answer the recorded bits"),
            "the replay of {name} said {said:?}"
        );
        println!(
            "  {name} under interrupts: {data} B of static data; {}",
            said.trim_end()
        );
    }
    Ok(())
}
