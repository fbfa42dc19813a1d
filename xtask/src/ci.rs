//! Every check of the project, the tests where they are asked for, in the order in which a failure is cheapest.
//!
//! Linking takes one core for long, and so do some tests: steps run in three lanes side by side. Lanes share no folder that cargo
//! locks for long: one builds the workspace for debugging, one for release, one the firmware's workspace.

use core::sync::atomic::{AtomicBool, Ordering};
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
    /// Go on after a failure, to see all that fail in one pass.
    #[arg(long)]
    keep_going: bool,
    /// A command of cargo to run besides, as one word: the test command, which takes longest
    #[arg(long)]
    tests: Option<String>,
}

/// A name, and the arguments of cargo.
type Step<'a> = (&'a str, &'a [&'a str]);

/// With MuJoCo; of the whole workspace, so that what does not use it is not compiled again.
const JUDGE: &str = "contact-sim/mujoco,saltus/mujoco";

/// Lines of a failed step's output that stand in the error.
const LAST_LINES: usize = 40;

/// Before the lanes: what is wrong soonest.
const FIRST: &[Step<'_>] = &[("format", &["fmt", "--all", "--check"])];

/// The lane of the workspace, after the tests.
const HOST: &[Step<'_>] = &[
    (
        "lints",
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--features",
            "dense-qp/bench,wbc-qp/bench,srb-opt/bench,saltus-tests/bench,saltus-tests/fused,saltus-tests/long",
            "--",
            "-D",
            "warnings",
        ],
    ),
    ("documentation", &["doc", "--workspace", "--no-deps"]),
    ("generated tables", &["xtask", "gen-model", "--check"]),
    ("links of all pages", &["xtask", "book", "--links"]),
    ("examples", &["xtask", "examples"]),
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
        "long suites of the algorithms",
        &["xtask", "suites", "algorithms"],
    ),
    ("imports agree with Pinocchio", &["xtask", "import-check"]),
    // In a folder of its own: it is here because this lane would end first.
    ("publishable crates", &["xtask", "package"]),
];

/// The lane of release builds, and of those that have a folder of their own.
const RELEASE: &[Step<'_>] = &[
    ("verdicts as expected", &["xtask", "verdicts"]),
    ("both papers", &["xtask", "reproduce"]),
    (
        "long suites of the program",
        &["xtask", "suites", "program"],
    ),
    (
        "pages in a browser",
        // Of the runs whose verdicts were looked at before.
        &["xtask", "report", "--gallery", "target/verdicts-check"],
    ),
    ("instruction counts", &["xtask", "icount"]),
    ("the Python package", &["xtask", "python"]),
    // It builds where the checks with MuJoCo did, which are through by then.
    ("the first hour", &["xtask", "first-hour"]),
];

/// The lane of bare targets and of the firmware's workspace.
const FIRMWARE: &[Step<'_>] = &[
    ("bare-metal builds", &["xtask", "cross"]),
    ("lints of the firmware", &["xtask", "firmware-lints"]),
    ("no reachable panic", &["xtask", "smoke"]),
    ("host equals target", &["xtask", "qemu"]),
    ("control ticks within budgets", &["xtask", "firmware"]),
    ("C interface", &["xtask", "c-abi"]),
];

/// Runs every step; stops soon after the first that fails, and names it.
pub(crate) fn run(args: &Args) -> Result<()> {
    let words: Vec<&str> = args
        .tests
        .iter()
        .flat_map(|x| x.split_whitespace())
        .collect();
    let tests: Vec<Step<'_>> = match words.as_slice() {
        [] => Vec::new(),
        ["cargo", arguments @ ..] => vec![("tests", arguments)],
        _ => bail!("--tests takes a command of cargo"),
    };
    let host = [&tests, HOST].concat();
    if args.list {
        for (name, arguments) in [FIRST, &host, RELEASE, FIRMWARE].concat() {
            println!("{name}: cargo {}", arguments.join(" "));
        }
        return Ok(());
    }
    let failed = AtomicBool::new(false);
    let lane = |steps: &[Step<'_>]| lane(steps, &failed, args.keep_going);
    lane(FIRST)?;
    thread::scope(|scope| {
        let beside = [RELEASE, FIRMWARE].map(|steps| scope.spawn(move || lane(steps)));
        let here = lane(&host);
        beside.into_iter().fold(here, |before, lane| {
            before.and(
                lane.join()
                    .unwrap_or_else(|_| Err(anyhow!("a lane panicked"))),
            )
        })
    })
}

/// Runs steps one after the other, until one fails in this lane or another; or all of them, and names the first that failed.
fn lane(steps: &[Step<'_>], failed: &AtomicBool, keep_going: bool) -> Result<()> {
    let mut ended = Ok(());
    for (name, arguments) in steps {
        if failed.load(Ordering::Relaxed) && !keep_going {
            break;
        }
        let step = step(name, arguments).with_context(|| format!("step `{name}`"));
        if let Err(error) = &step {
            failed.store(true, Ordering::Relaxed);
            println!("== {error:#}");
        }
        ended = ended.and(step);
    }
    ended
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
        // What other lanes print in the meantime would bury the reason: it is said again at the very end.
        let text = String::from_utf8_lossy(&said);
        let lines: Vec<&str> = text.lines().collect();
        let end = lines[lines.len().saturating_sub(LAST_LINES)..].join("\n");
        bail!("ended with {status}, after it had said\n{end}");
    }
    writeln!(out, "== {name}: passed in {} s", start.elapsed().as_secs())?;
    Ok(())
}

/// `cargo` with these arguments, warnings of rustdoc being errors; `cargo xtask` is this program, so that no lane waits for
/// another's builds. The program and not its file, which the tests build anew.
fn command(arguments: &[&str]) -> Result<Command> {
    Ok(match arguments {
        ["xtask", rest @ ..] => {
            let mut own = Command::new("/proc/self/exe");
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
