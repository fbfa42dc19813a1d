//! The loops under interrupts: an image flies under QEMU, and its flight recorder's bytes replay on the host.

use std::fs::File;
use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};
use object::{Object, ObjectSegment};

use crate::bare::Bare;
use crate::board::BOARDS;
use crate::run;

/// Where the boards' memory maps put data.
const DATA: u64 = 0x2000_0000;

/// Builds and flies the image in double precision on the Cortex-M7, replays it, and prints what memory it takes.
pub(crate) fn run(bare: &Bare) -> Result<()> {
    let board = &BOARDS[0];
    let firmware = run::root().join("firmware");
    let mut metadata = run::cargo();
    metadata.current_dir(&firmware);
    metadata.args(["metadata", "--format-version=1", "--no-deps", "--locked"]);
    let metadata: serde_json::Value = serde_json::from_str(&run::stdout(&mut metadata)?)?;
    let target = PathBuf::from(metadata["target_directory"].as_str().unwrap_or_default());
    let mut build = bare.build_with(board.rustflags);
    build.current_dir(&firmware).env("SALTUS_BOARD", board.name);
    build.args(["--quiet", "--locked", "--package", "saltus-loops"]);
    run::succeed(build.args(["--bin", "loop-a1-f64"]))?;
    let image = target.join(board.target).join("release/loop-a1-f64");
    let bytes = std::fs::read(&image).with_context(|| image.display().to_string())?;
    let elf = object::File::parse(&*bytes)?;
    let data = elf.segments().filter(|segment| segment.address() >= DATA);
    let data: u64 = data.map(|segment| segment.size()).sum();
    let recording = target.join("flight.bin");
    let mut qemu = board.emulator(&image);
    // One instruction per nanosecond: control tick, simulated robot and recorder fit their periods.
    qemu.args(["-icount", "shift=0,align=off,sleep=off"])
        .stdin(Stdio::null())
        .stdout(File::create(&recording)?);
    run::succeed(&mut qemu)?;
    let mut replay = run::cargo();
    replay.current_dir(&firmware);
    replay.args([
        "run",
        "--quiet",
        "--profile=host",
        "--locked",
        "--package",
        "saltus-loops",
    ]);
    replay.args(["--bin", "replay", "f64"]).arg(&recording);
    let said = run::stdout(&mut replay)?;
    ensure!(
        said.contains("answer the recorded bits"),
        "the replay said {said:?}"
    );
    println!(
        "  loop-a1-f64 under interrupts: {data} B of static data; {}",
        said.trim_end()
    );
    Ok(())
}
