//! `cargo xtask first-hour`: what the README tells a newcomer to type, typed.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::bare::{Bare, Choice};
use crate::run;

/// The section of the README.
const HEADING: &str = "## Your first hour\n";
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

/// Arguments of `cargo xtask first-hour`.
#[derive(clap::Args)]
pub(crate) struct Args {}

pub(crate) fn run(_: &Args) -> Result<()> {
    let root = run::root();
    let readme = fs::read_to_string(root.join("README.md"))?;
    let script = script(&readme)?;
    let folder = root.join(FOLDER);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    Bare::find("thumbv7em-none-eabihf", Choice::Auto)?;
    run::succeed(
        Command::new("bash")
            .args(["-euxo", "pipefail", "-c", &script])
            .current_dir(&root),
    )?;
    for result in RESULTS {
        ensure!(folder.join(result).exists(), "{FOLDER}/{result} is missing");
    }
    println!("first hour: every line of the README works");
    Ok(())
}

/// The shell lines of the section.
fn script(readme: &str) -> Result<String> {
    let (_, section) = readme
        .split_once(HEADING)
        .context("the README has no first hour")?;
    let section = section.split("\n## ").next().unwrap_or_default();
    let blocks: Vec<&str> = section
        .split("```sh\n")
        .skip(1)
        .filter_map(|rest| Some(rest.split_once("```")?.0))
        .collect();
    ensure!(!blocks.is_empty(), "the first hour has no commands");
    Ok(blocks.concat())
}

#[cfg(test)]
mod tests {
    use super::script;

    #[test]
    fn only_the_commands_of_the_section_are_typed() {
        let readme = "```sh\nno\n```\n## Your first hour\ntext\n```sh\none\n```\n```rust\nno\n```\n```sh\ntwo\n```\n\n## Next\n```sh\nno\n```\n";
        assert_eq!(script(readme).ok().as_deref(), Some("one\ntwo\n"));
        assert!(script("nothing").is_err());
    }
}
