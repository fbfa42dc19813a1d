//! The loops under interrupts, bare and under each framework: images fly under QEMU, and their flight recorders' bytes replay
//! on the host.

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

/// Package and image: the loops alone, then under RTIC and Embassy.
const IMAGES: [(&str, &str); 3] = [
    ("saltus-loops", "loop-a1-f64"),
    ("saltus-starters", "rtic-a1"),
    ("saltus-starters", "embassy-a1"),
];

/// Builds and flies the images in double precision on the Cortex-M7, replays them, and prints what memory they take.
pub(crate) fn run(bare: &Bare) -> Result<()> {
    let board = &BOARDS[0];
    let firmware = run::root().join("firmware");
    let mut metadata = run::cargo();
    metadata.current_dir(&firmware);
    metadata.args(["metadata", "--format-version=1", "--no-deps", "--locked"]);
    let metadata: serde_json::Value = serde_json::from_str(&run::stdout(&mut metadata)?)?;
    let target = PathBuf::from(metadata["target_directory"].as_str().unwrap_or_default());
    for (package, name) in IMAGES {
        let mut build = bare.build_with(board.rustflags);
        build.current_dir(&firmware).env("SALTUS_BOARD", board.name);
        build.args(["--quiet", "--locked", "--package", package, "--bin", name]);
        run::succeed(&mut build)?;
        let image = target.join(board.target).join("release").join(name);
        let bytes = std::fs::read(&image).with_context(|| image.display().to_string())?;
        let elf = object::File::parse(&*bytes)?;
        let data = elf.segments().filter(|segment| segment.address() >= DATA);
        let data: u64 = data.map(|segment| segment.size()).sum();
        let recording = target.join(name).with_extension("recording");
        let mut qemu = board.emulator(&image);
        // One instruction per nanosecond: control tick, simulated robot and recorder fit their periods.
        qemu.args(["-icount", "shift=0,align=off,sleep=off"])
            .stdin(Stdio::null())
            .stdout(File::create(&recording)?);
        run::succeed(&mut qemu).with_context(|| name)?;
        let mut replay = run::cargo();
        replay
            .current_dir(&firmware)
            .args(["run", "--quiet", "--profile=host", "--locked"]);
        replay.args(["--package", "saltus-loops", "--bin", "replay", "f64"]);
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
