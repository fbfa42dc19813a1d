//! `cargo xtask first-hour`: what the guide tells a newcomer to type, typed.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::bare::{Bare, Choice};
use crate::{mujoco, run};

/// The first hour, which stands alone.
const HOUR: &str = "docs/guide/0-first-hour.md";
/// The folder into which its lines write.
const FOLDER: &str = "out/first-hour";
/// What must be there in the end.
const RESULTS: [&str; 5] = [
    "jump/report.html",
    "shorter-jump/report.html",
    "anymal-model/Cargo.toml",
    "anymal-jump/plan.bin",
    "lander/Cargo.toml",
];

/// Chapters of the guide with commands, in their order; they share a folder, as they do for a reader.
const CHAPTERS: [&str; 3] = ["1-first-jump", "2-my-quadruped", "3-my-task"];
const GUIDE_FOLDER: &str = "out/guide";
const GUIDE_RESULTS: [&str; 6] = [
    "plan/plan.bin",
    "jump/report.html",
    "disturbed/report.html",
    "anymal-model/Cargo.toml",
    "anymal-jump/plan.bin",
    "my-jump/report.html",
];

/// Arguments of `cargo xtask first-hour`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let root = run::root();
    Bare::find("thumbv7em-none-eabihf", Choice::Auto)?;
    let hour = fs::read_to_string(root.join(HOUR)).context(HOUR)?;
    follow(&script(&hour)?, FOLDER, &RESULTS).context(HOUR)?;
    let mut commands = String::new();
    for chapter in CHAPTERS {
        let text = fs::read_to_string(root.join(format!("docs/guide/{chapter}.md")))?;
        commands += &script(&text).with_context(|| format!("docs/guide/{chapter}.md"))?;
    }
    follow(&commands, GUIDE_FOLDER, &GUIDE_RESULTS).context("docs/guide")?;
    println!("first hour: every line of the guide works");
    Ok(())
}

/// Types the lines as a newcomer would, in a folder that is not there yet, and looks for what they promise.
fn follow(script: &str, folder: &str, results: &[&str]) -> Result<()> {
    let root = run::root();
    let path = root.join(folder);
    run::remove_folder(&path)?;
    let mut newcomer = Command::new("bash");
    newcomer
        .args(["-euxo", "pipefail", "-c", script])
        .current_dir(&root);
    // Other checks have compiled there what does not depend on MuJoCo.
    run::succeed(newcomer.env("CARGO_TARGET_DIR", mujoco::build_folder()))?;
    for result in results {
        ensure!(path.join(result).exists(), "{folder}/{result} is missing");
    }
    Ok(())
}

/// The shell lines of a text.
fn script(text: &str) -> Result<String> {
    let blocks: Vec<&str> = text
        .split("```sh\n")
        .skip(1)
        .filter_map(|rest| Some(rest.split_once("```")?.0))
        .collect();
    ensure!(!blocks.is_empty(), "there are no commands");
    Ok(blocks.concat())
}

#[cfg(test)]
mod tests {
    use super::script;

    #[test]
    fn only_the_commands_are_typed() {
        let text = "text\n```sh\none\n```\n```rust\nno\n```\n```sh\ntwo\n```\n";
        assert_eq!(script(text).ok().as_deref(), Some("one\ntwo\n"));
        assert!(script("nothing").is_err());
    }
}
