//! `cargo xtask c-abi`: the C header is what the source gives, and the C example does on a Cortex-M7 what it does here.
//!
//! The example also misuses the library: null, unaligned and moved blocks, wrong sizes, versions, numbers. It ends with an error if
//! a status is not the promised one.

use core::time::Duration;
use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail, ensure};

use crate::bare::{Bare, Choice};
use crate::board::BOARDS;
use crate::{image, run};

const LIMIT: Duration = Duration::from_secs(120);
const STRICT: [&str; 5] = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror"];
const CORTEX_M7: [&str; 6] = [
    "-mcpu=cortex-m7",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv5-d16",
    "--specs=rdimon.specs",
    "-nostartfiles",
];

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where `core` comes from.
    #[arg(long, value_enum, default_value = "auto")]
    core: Choice,
    /// Write the header instead of comparing with it.
    #[arg(long)]
    overwrite: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let mut header = run::firmware_cargo();
    header.args([
        "run",
        "--quiet",
        "--profile=host",
        "--locked",
        "--package",
        "saltus-header",
    ]);
    if !args.overwrite {
        header.args(["--", "--check"]);
    }
    run::succeed(&mut header)?;
    println!("c-abi: the header is what the source gives");
    let folder = run::root().join("firmware/c-abi");
    let here = on_host(&folder)?;
    let there = on_board(&folder, args.core)?;
    let numbers = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| !line.starts_with("blocks "));
        lines.map(str::to_owned).collect()
    };
    let (here_numbers, there_numbers) = (numbers(&here), numbers(&there));
    if let Some((a, b)) = here_numbers
        .iter()
        .zip(&there_numbers)
        .find(|(a, b)| a != b)
    {
        bail!("the example writes {a:?} on the host and {b:?} on the board");
    }
    ensure!(
        here_numbers.len() == there_numbers.len() && here_numbers.len() > 90,
        "the example writes {} lines on the host and {} on the board",
        here_numbers.len(),
        there_numbers.len()
    );
    for line in there.lines().filter(|line| line.starts_with("blocks ")) {
        println!("c-abi: bytes of the {line}");
    }
    println!(
        "c-abi: {} lines of the C example are the same on gcc's host and on a Cortex-M7; misuse gives the promised status",
        here_numbers.len()
    );
    Ok(())
}

/// Builds the example with the host's compiler, and runs it.
fn on_host(folder: &Path) -> Result<String> {
    let mut build = run::firmware_cargo();
    build.args([
        "build",
        "--quiet",
        "--profile=host",
        "--locked",
        "--package",
        "saltus-c",
    ]);
    run::succeed(&mut build)?;
    let built = image::firmware_target()?.join("host");
    let program = built.join("c-example");
    let mut compile = Command::new("gcc");
    compile.args(STRICT).arg("-I").arg(folder.join("include"));
    compile
        .arg(folder.join("example/landing.c"))
        .arg(built.join("libsaltus.a"));
    compile
        .args(["-lm", "-lpthread", "-ldl", "-o"])
        .arg(&program);
    run::succeed(&mut compile)?;
    run::stdout_within(&mut Command::new(&program), LIMIT)
}

/// Builds the example for a Cortex-M7, and runs it under QEMU. That it links shows that no panic is reachable.
fn on_board(folder: &Path, core: Choice) -> Result<String> {
    let board = &BOARDS[0];
    for (program, package) in [
        ("arm-none-eabi-gcc", "gcc-arm-none-eabi"),
        ("qemu-system-arm", "qemu-system-arm"),
    ] {
        if !run::exists(program) {
            run::install_debian(&[package, "libnewlib-arm-none-eabi"])?;
        }
    }
    let mut build = Bare::find(board.target, core)?.build_for(board.name, board.rustflags);
    build.args(["--quiet", "--package", "saltus-c"]);
    run::succeed(&mut build)?;
    let built = image::firmware_target()?.join(board.target).join("release");
    let image = built.join("c-example");
    let mut compile = Command::new("arm-none-eabi-gcc");
    compile
        .args(CORTEX_M7)
        .args(STRICT)
        .arg("-I")
        .arg(folder.join("include"));
    for source in ["landing.c", "start.c"] {
        compile.arg(folder.join("example").join(source));
    }
    compile.arg(built.join("libsaltus.a"));
    compile.arg("-T").arg(folder.join("example/mps2-an500.ld"));
    compile
        .args(["-Wl,--gc-sections,--no-warn-execstack", "-o"])
        .arg(&image);
    run::succeed(&mut compile)?;
    run::stdout_within(&mut board.emulator(&image), LIMIT)
}
