//! `cargo xtask cross`: every control crate builds alone for every bare-metal target.
//!
//! Alone matters: a build of several crates unifies their features, and so hides a `std` that one of them needs.

use anyhow::{Context, Result};

use crate::bare::{Bare, Choice, TARGETS};
use crate::run;

/// The crates that promise `no_std` without `alloc`.
const CRATES: [&str; 15] = [
    "so3",
    "rbd-core",
    "a1-model",
    "icub-model",
    "dense-qp",
    "ocp-solver",
    "srb-opt",
    "wb-opt",
    "landing",
    "wbc-qp",
    "jump-control",
    "jump-machine",
    "state-est",
    "robot-link",
    "contact-sim",
];

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where `core` comes from.
    #[arg(long, value_enum, default_value = "auto")]
    core: Choice,
    /// Only this target.
    #[arg(long, value_parser = TARGETS)]
    target: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let wanted = |target: &&str| args.target.as_deref().is_none_or(|only| only == *target);
    let mut built = 0;
    for target in TARGETS.into_iter().filter(wanted) {
        let bare = Bare::find(target, args.core)?;
        println!("{bare}");
        for name in CRATES {
            let mut build = bare.build();
            build.args([
                "--quiet",
                "--no-default-features",
                "--lib",
                "--package",
                name,
            ]);
            // Not the folder of release builds, which they would wait for.
            build.args(["--target-dir", "target/bare"]);
            run::succeed(&mut build).with_context(|| format!("{name} for {target}"))?;
            println!("  {name}");
            built += 1;
        }
    }
    println!("cross: {built} builds passed");
    Ok(())
}
