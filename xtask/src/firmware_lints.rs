//! `cargo xtask firmware-lints`: formatting, clippy and documentation of the firmware's workspace, for the host and for bare targets.
//!
//! Code of boards is only seen by a compiler for their processors, so clippy runs for each of these as well.

use std::process::Command;

use anyhow::{Context, Result};

use crate::bare::{Bare, Choice};
use crate::boards::HARDWARE;
use crate::run;

/// Packages that build on a host.
const HOST: [&str; 5] = [
    "saltus-c",
    "saltus-header",
    "saltus-loops",
    "saltus-memory",
    "saltus-probe",
];
/// Packages that run on emulated boards.
const BARE: [&str; 3] = ["saltus-c", "saltus-smoke", "saltus-starters"];
const TARGET: &str = "thumbv7em-none-eabihf";

#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    run::succeed(in_firmware("fmt").args(["--all", "--check"]))?;
    clippy("the host", &HOST, &["--profile=host", "--all-targets"])?;
    clippy(TARGET, &BARE, &target(TARGET)?)?;
    // Without the program that replays on a host.
    let mut images = target(TARGET)?;
    images.extend(["--lib", "--bin", "loop-a1-f32", "--bin", "loop-a1-f64"]);
    images.extend(["--bin", "loop-icub-f64"]);
    clippy(TARGET, &["saltus-loops"], &images)?;
    for board in &HARDWARE {
        let mut options = target(board.target)?;
        options.extend(["--features", board.name]);
        clippy(board.name, &["saltus-boards"], &options)?;
    }
    println!("firmware-lints: formatted, and nothing to complain of");
    Ok(())
}

/// Options of a bare target, whose `core` must be in the toolchain: clippy belongs to it.
fn target(name: &'static str) -> Result<Vec<&'static str>> {
    Bare::find(name, Choice::Installed)
        .or_else(|_| Bare::find(name, Choice::Rustup))
        .context("clippy needs the target in the toolchain")?;
    Ok(vec!["--release", "--target", name])
}

fn in_firmware(command: &str) -> Command {
    let mut cargo = run::firmware_cargo();
    cargo.arg(command);
    cargo
}

fn clippy(name: &str, packages: &[&str], options: &[&str]) -> Result<()> {
    let mut cargo = in_firmware("clippy");
    cargo.args(["--quiet", "--locked"]).args(options);
    for package in packages {
        cargo.args(["--package", package]);
    }
    run::succeed(cargo.args(["--", "-D", "warnings"])).with_context(|| format!("lints for {name}"))
}
