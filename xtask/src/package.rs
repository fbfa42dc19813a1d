//! `cargo xtask package`: every crate as it would be published, built from its own archive with the oldest compiler that it promises.
//!
//! Cargo builds the archives against each other, so a file outside a crate or a path without a version fails here.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::run;

/// What the registry takes: keywords, characters of each, and categories.
const MOST_KEYWORDS: usize = 5;
const LONGEST_KEYWORD: usize = 20;
const MOST_CATEGORIES: usize = 5;
/// The registry's categories that fit this project.
const CATEGORIES: [&str; 8] = [
    "command-line-utilities",
    "embedded",
    "mathematics",
    "no-std",
    "no-std::no-alloc",
    "parser-implementations",
    "science::robotics",
    "simulation",
];
/// Texts that every manifest must have.
const TEXTS: [&str; 5] = [
    "description",
    "license",
    "readme",
    "rust_version",
    "edition",
];

/// Arguments of `cargo xtask package`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Check the manifests only.
    #[arg(long)]
    manifests: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let metadata = run::stdout(run::cargo().args(["metadata", "--no-deps", "--format-version=1"]))?;
    let metadata: Value = serde_json::from_str(&metadata)?;
    let packages = metadata["packages"].as_array().context("no packages")?;
    // `publish = false` is an empty list of registries.
    let (published, private): (Vec<_>, Vec<_>) =
        packages.iter().partition(|p| p["publish"].is_null());
    for package in &published {
        check(package).with_context(|| format!("{}/Cargo.toml", package["name"]))?;
    }
    println!("manifests of {} crates are complete", published.len());
    if args.manifests {
        return Ok(());
    }
    let versions: BTreeSet<&str> = (published.iter())
        .filter_map(|package| package["rust_version"].as_str())
        .collect();
    let [oldest] = versions.iter().copied().collect::<Vec<_>>()[..] else {
        bail!("the crates promise several compilers: {versions:?}");
    };
    let target = run::root().join("target/archives");
    forget_archives(&target, &published)?;
    let mut cargo = run::cargo();
    cargo.args(["package", "--workspace", "--allow-dirty", "--quiet"]);
    cargo.arg("--target-dir").arg(&target);
    for package in private {
        cargo.args(["--exclude", package["name"].as_str().context("no name")?]);
    }
    let with = match compiler(oldest) {
        Ok(rustc) => {
            cargo.env("RUSTC", rustc);
            format!("with Rust {oldest}, the oldest that they promise")
        }
        Err(error) => format!(
            "with this compiler only, so that nothing but clippy's `incompatible_msrv` has seen Rust {oldest}: {error:#}"
        ),
    };
    run::succeed(&mut cargo)?;
    println!("{} archives build, {with}", published.len());
    Ok(())
}

/// Removes what earlier runs unpacked and built of `packages`.
///
/// Cargo takes a version for something that never changes: it would build today's crates against the sources
/// that an earlier run left in its home under the same version.
fn forget_archives(target: &Path, packages: &[&Value]) -> Result<()> {
    run::remove_folder(target)?;
    let home = match env::var_os("CARGO_HOME") {
        Some(home) => PathBuf::from(home),
        None => env::home_dir().context("no home folder")?.join(".cargo"),
    };
    let Ok(registries) = fs::read_dir(home.join("registry/src")) else {
        return Ok(()); // nothing was ever unpacked
    };
    for registry in registries {
        let registry = registry?;
        // A registry in a folder has no host before its hash.
        if !registry.file_name().to_string_lossy().starts_with('-') {
            continue;
        }
        for package in packages {
            let text = |key: &str| package[key].as_str().context("no name or version");
            run::remove_folder(&(registry.path()).join(format!(
                "{}-{}",
                text("name")?,
                text("version")?
            )))?;
        }
    }
    Ok(())
}

/// What the registry asks of a manifest.
fn check(package: &Value) -> Result<()> {
    for key in TEXTS {
        let text = package[key].as_str().unwrap_or_default();
        ensure!(!text.is_empty(), "`{key}` is missing");
    }
    let strings = |key: &str| -> Vec<&str> {
        let list = package[key].as_array().into_iter().flatten();
        list.filter_map(Value::as_str).collect()
    };
    let keywords = strings("keywords");
    ensure!(
        (1..=MOST_KEYWORDS).contains(&keywords.len()),
        "1 to {MOST_KEYWORDS} keywords are needed"
    );
    for word in keywords {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_+".contains(c);
        ensure!(
            word.len() <= LONGEST_KEYWORD && word.chars().all(plain),
            "keyword `{word}`: at most {LONGEST_KEYWORD} letters, digits, `-`, `_` or `+`"
        );
    }
    let categories = strings("categories");
    ensure!(
        (1..=MOST_CATEGORIES).contains(&categories.len()),
        "1 to {MOST_CATEGORIES} categories are needed"
    );
    for category in categories {
        ensure!(
            CATEGORIES.contains(&category),
            "category `{category}`: take one of {CATEGORIES:?}"
        );
    }
    Ok(())
}

/// The `rustc` of a version, installed by rustup if it is not there.
fn compiler(version: &str) -> Result<OsString> {
    let toolchain = format!("{version}.0");
    let mut install = Command::new("rustup");
    install.args(["toolchain", "install", &toolchain]);
    install.args(["--profile", "minimal", "--no-self-update"]);
    run::stdout(&mut install)?;
    let mut which = Command::new("rustup");
    let path = run::stdout(which.args(["which", "--toolchain", &toolchain, "rustc"]))?;
    Ok(path.trim_end().into())
}

#[cfg(test)]
mod tests {
    use super::check;
    use serde_json::{Value, json};

    fn good() -> Value {
        json!({
            "description": "d", "license": "MIT", "readme": "README.md", "rust_version": "1.89", "edition": "2024",
            "keywords": ["robotics"], "categories": ["no-std"],
        })
    }

    #[test]
    fn what_a_registry_refuses_is_refused_here() {
        assert!(check(&good()).is_ok());
        for (key, value) in [
            ("readme", Value::Null),
            ("rust_version", Value::Null),
            ("keywords", json!([])),
            ("keywords", json!(["trajectory-optimization"])),
            ("keywords", json!(["two words"])),
            ("categories", json!(["robots"])),
            ("categories", json!([])),
        ] {
            let mut bad = good();
            bad[key] = value;
            assert!(check(&bad).is_err(), "{key}");
        }
    }
}
