//! Every check of the project but the tests themselves, in the order in which a failure is cheapest.
//!
//! The two workspaces share no target folder, and linking an image takes one core for long: their steps run in two lanes side by side.

use core::sync::atomic::{AtomicBool, Ordering};
use std::env;
use std::io::{self, Read, Write};
use std::process::Command;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail};

use crate::run;

/// Arguments of `cargo xtask ci`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only list the steps.
    #[arg(long)]
    list: bool,
}

/// A name, and the arguments of cargo.
type Step = (&'static str, &'static [&'static str]);

/// With MuJoCo; of the whole workspace, so that what does not use it is not compiled again.
const JUDGE: &str = "contact-sim/mujoco,saltus/mujoco";

/// Before the lanes: what is wrong soonest, and what installs the targets for both.
const FIRST: &[Step] = &[
    ("format", &["fmt", "--all", "--check"]),
    ("bare-metal builds", &["xtask", "cross"]),
];

/// The lane of the workspace.
const HOST: &[Step] = &[
    (
        "lints",
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--features",
            "saltus-tests/fused",
            "--",
            "-D",
            "warnings",
        ],
    ),
    ("documentation", &["doc", "--workspace", "--no-deps"]),
    ("generated tables", &["xtask", "gen-model", "--check"]),
    ("instruction counts", &["xtask", "icount"]),
    ("imports agree with Pinocchio", &["xtask", "import-check"]),
    ("the report in a browser", &["xtask", "report"]),
    ("both papers", &["xtask", "reproduce"]),
    ("examples", &["xtask", "examples"]),
    ("publishable crates", &["xtask", "package"]),
    ("the first hour", &["xtask", "first-hour"]),
    (
        "MuJoCo agrees",
        &[
            "xtask",
            "mujoco",
            "test",
            "--workspace",
            "--features",
            JUDGE,
            "--test",
            "mujoco",
        ],
    ),
    (
        "iCub jumps in MuJoCo",
        &[
            "xtask",
            "mujoco",
            "test",
            "--workspace",
            "--features",
            JUDGE,
            "--bin",
            "saltus",
            "humanoid::tests::mujoco",
        ],
    ),
];

/// The lane of the firmware's workspace.
const FIRMWARE: &[Step] = &[
    ("lints of the firmware", &["xtask", "firmware-lints"]),
    ("no reachable panic", &["xtask", "smoke"]),
    ("host equals target", &["xtask", "qemu"]),
    ("control ticks within budgets", &["xtask", "firmware"]),
    ("C interface", &["xtask", "c-abi"]),
];

/// Runs every step; stops soon after the first that fails, and names it.
pub(crate) fn run(args: &Args) -> Result<()> {
    if args.list {
        for (name, arguments) in [FIRST, HOST, FIRMWARE].concat() {
            println!("{name}: cargo {}", arguments.join(" "));
        }
        return Ok(());
    }
    let failed = AtomicBool::new(false);
    lane(FIRST, &failed)?;
    thread::scope(|scope| {
        let beside = scope.spawn(|| lane(FIRMWARE, &failed));
        let here = lane(HOST, &failed);
        let there = beside.join().map_err(|_| anyhow!("a lane panicked"))?;
        here.and(there)
    })
}

/// Runs steps one after the other, until one fails in this lane or another.
fn lane(steps: &[Step], failed: &AtomicBool) -> Result<()> {
    for (name, arguments) in steps {
        if failed.load(Ordering::Relaxed) {
            break;
        }
        step(name, arguments)
            .inspect_err(|_| failed.store(true, Ordering::Relaxed))
            .with_context(|| format!("step `{name}`"))?;
    }
    Ok(())
}

/// Runs a step, and prints what it said once it has ended, so that lanes do not mix.
fn step(name: &str, arguments: &[&str]) -> Result<()> {
    let start = Instant::now();
    println!("== {name}: cargo {}", arguments.join(" "));
    let (mut reader, writer) = io::pipe()?;
    let mut command = command(arguments)?;
    command.stdout(writer.try_clone()?).stderr(writer);
    let mut child = command.spawn()?;
    // Its ends of the pipe close with it.
    drop(command);
    let mut said = Vec::new();
    reader.read_to_end(&mut said)?;
    let status = child.wait()?;
    let mut out = io::stdout().lock();
    out.write_all(&said)?;
    if !status.success() {
        bail!("ended with {status}");
    }
    writeln!(out, "== {name}: passed in {} s", start.elapsed().as_secs())?;
    Ok(())
}

/// `cargo` with these arguments, warnings of rustdoc being errors; `cargo xtask` is this program, so that no lane waits for
/// another's builds.
fn command(arguments: &[&str]) -> Result<Command> {
    Ok(match arguments {
        ["xtask", rest @ ..] => {
            let mut own = Command::new(env::current_exe()?);
            own.current_dir(run::root()).args(rest);
            own
        }
        _ => {
            let mut cargo = run::cargo();
            cargo.env("RUSTDOCFLAGS", "-D warnings").args(arguments);
            cargo
        }
    })
}
