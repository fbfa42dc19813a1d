//! `cargo xtask suites`: the tests that take too long, to run or to compile, for `cargo test --workspace`.
//!
//! None is left out anywhere else: CI runs both parts.

use anyhow::Result;
use clap::ValueEnum;

use crate::{mujoco, run};

/// A part of the suites, so that CI's lanes can share them.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// iCub and noise at length in closed loop, A1 dropped on its feet, and what `saltus` does as a program, in both simulators and the
    /// release build.
    Program,
    /// Every algorithm beside Pinocchio, a counting allocator under every call of the control crates, and the bounds beside the solver, in
    /// the build of `cargo test --workspace`.
    Algorithms,
}

/// Arguments of `cargo xtask suites`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only this part.
    part: Option<Part>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let wanted = |part| args.part.is_none_or(|only| only == part);
    if wanted(Part::Algorithms) {
        algorithms()?;
    }
    if wanted(Part::Program) {
        program()?;
    }
    Ok(())
}

/// The whole workspace is named, so that nothing is compiled again with other features.
fn algorithms() -> Result<()> {
    let test = || {
        let mut cargo = run::cargo();
        cargo.args(["test", "--workspace"]);
        cargo
    };
    run::succeed(test().args(["--test", "all", "--", "--ignored", "bounds::"]))?;
    let mut long = test();
    long.args(["--features", "saltus-tests/long"]);
    long.args(["--test", "golden", "--test", "no_alloc"]);
    run::succeed(&mut long)
}

fn program() -> Result<()> {
    let mut units = mujoco::tests()?;
    units.args(["--lib", "--", "--include-ignored"]);
    units.args(["humanoid::tests", "quadruped::fuzz"]);
    run::succeed(&mut units)?;
    let mut whole = mujoco::tests()?;
    run::succeed(whole.args(["--test", "*", "--", "--ignored"]))?;
    let mut drops = mujoco::tests()?;
    drops.args(["--package", "saltus-tests"]);
    drops.args(["--features", "saltus-tests/mujoco"]);
    run::succeed(drops.args(["--test", "landing_drops", "--", "--include-ignored"]))
}
