//! Every check of the project but the tests themselves, in the order in which a failure is cheapest.

use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};

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

const STEPS: &[Step] = &[
    ("format", &["fmt", "--all", "--check"]),
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
    ("lints of the firmware", &["xtask", "firmware-lints"]),
    ("documentation", &["doc", "--workspace", "--no-deps"]),
    ("generated tables", &["xtask", "gen-model", "--check"]),
    ("bare-metal builds", &["xtask", "cross"]),
    ("no reachable panic", &["xtask", "smoke"]),
    ("host equals target", &["xtask", "qemu"]),
    ("control ticks within budgets", &["xtask", "firmware"]),
    ("C interface", &["xtask", "c-abi"]),
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

/// Runs every step; stops at the first that fails, and names it.
pub(crate) fn run(args: &Args) -> Result<()> {
    for (name, arguments) in STEPS {
        println!("== {name}: cargo {}", arguments.join(" "));
        if args.list {
            continue;
        }
        let start = Instant::now();
        let mut cargo = run::cargo();
        run::succeed(strict(&mut cargo).args(*arguments))
            .with_context(|| format!("step `{name}`"))?;
        println!("== {name}: passed in {} s", start.elapsed().as_secs());
    }
    Ok(())
}

/// Warnings of rustdoc are errors here.
fn strict(cargo: &mut Command) -> &mut Command {
    cargo.env("RUSTDOCFLAGS", "-D warnings")
}
