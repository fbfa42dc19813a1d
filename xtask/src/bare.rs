//! Where `core` for a bare-metal target comes from.
//!
//! Not every machine can add a target to its toolchain, and a check that is skipped proves nothing. So the first of
//! three ways that is there is taken and named, and if none works the check fails.

use core::fmt;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::ValueEnum;

use crate::run;

/// The bare-metal targets of the project.
pub(crate) const TARGETS: [&str; 3] = [
    "thumbv7em-none-eabihf",
    "thumbv8m.main-none-eabihf",
    "aarch64-unknown-none",
];

/// How `core` is found.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The first that works of the others, in their order.
    Auto,
    /// The target is installed in the toolchain.
    Installed,
    /// `rustup target add`.
    Rustup,
    /// Debian's `rustc-web` builds `core` from `rust-web-src`.
    Debian,
}

/// A toolchain that can build for one target.
pub(crate) struct Bare {
    target: &'static str,
    source: Source,
}

enum Source {
    Installed,
    Added,
    Debian { rustc: OsString },
}

impl Bare {
    /// Finds a toolchain for `target`, installing what is needed.
    pub(crate) fn find(target: &'static str, choice: Choice) -> Result<Self> {
        let source = match choice {
            Choice::Installed => installed(target),
            Choice::Rustup => added(target),
            Choice::Debian => debian(),
            Choice::Auto => installed(target).or_else(|first| {
                added(target).or_else(|second| {
                    debian().map_err(|third| {
                        anyhow::anyhow!(
                            "nothing can build for {target}: {first:#}; {second:#}; {third:#}"
                        )
                    })
                })
            }),
        };
        let source = source.with_context(|| format!("no core for {target}"))?;
        Ok(Self { target, source })
    }

    /// A `cargo build --release` for the target.
    pub(crate) fn build(&self) -> Command {
        let mut cargo = run::cargo();
        cargo.env_remove(run::LTO);
        cargo.args(["build", "--release", "--target", self.target]);
        if let Source::Debian { rustc } = &self.source {
            cargo
                .arg("-Zbuild-std=core")
                .env("RUSTC_BOOTSTRAP", "1")
                .env("RUSTC", rustc);
            // Debian's compiler does not carry the linker of the rustup toolchains.
            let key = self.target.replace(['-', '.'], "_").to_uppercase();
            cargo.env(format!("CARGO_TARGET_{key}_LINKER"), "ld.lld");
        }
        cargo
    }

    /// As [`Bare::build`], with compiler flags for the target only.
    pub(crate) fn build_with(&self, rustflags: &[&str]) -> Command {
        let mut cargo = self.build();
        if !rustflags.is_empty() {
            let quoted: Vec<String> = rustflags.iter().map(|flag| format!("{flag:?}")).collect();
            let setting = format!("target.'{}'.rustflags=[{}]", self.target, quoted.join(","));
            cargo.args(["--config", &setting]);
        }
        cargo
    }

    /// As [`Bare::build_with`], of the firmware's workspace for a board with its memory map.
    pub(crate) fn build_for(&self, board: &str, rustflags: &[&str]) -> Command {
        let mut cargo = self.build_with(rustflags);
        cargo
            .current_dir(run::firmware())
            .arg("--locked")
            .env("SALTUS_BOARD", board);
        cargo
    }
}

impl fmt::Display for Bare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source = match &self.source {
            Source::Installed => "core installed in the toolchain",
            Source::Added => "core added by rustup",
            Source::Debian { .. } => "core built by Debian's rustc-web",
        };
        write!(f, "{} ({source})", self.target)
    }
}

fn installed(target: &str) -> Result<Source> {
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    let printed = rustc
        .args(["--print", "target-libdir", "--target", target])
        .current_dir(run::root())
        .stderr(Stdio::null());
    let libdir = run::stdout(printed)?;
    let has_core = std::fs::read_dir(Path::new(libdir.trim_end())).is_ok_and(|entries| {
        entries
            .flatten()
            .any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
    });
    if !has_core {
        bail!("not installed in the toolchain");
    }
    Ok(Source::Installed)
}

fn added(target: &str) -> Result<Source> {
    let mut rustup = Command::new("rustup");
    run::succeed(
        rustup
            .args(["target", "add", target])
            .current_dir(run::root()),
    )?;
    installed(target).context("rustup added the target, but rustc does not see it")?;
    Ok(Source::Added)
}

fn debian() -> Result<Source> {
    let find = || -> Result<OsString> {
        let files = run::stdout(
            Command::new("dpkg")
                .args(["-L", "rustc-web"])
                .stderr(Stdio::null()),
        )?;
        let rustc = files.lines().find(|path| path.ends_with("/bin/rustc"));
        let rustc = rustc.context("rustc-web contains no rustc")?;
        let sysroot = run::stdout(Command::new(rustc).args(["--print", "sysroot"]))?;
        let source = Path::new(sysroot.trim_end()).join("lib/rustlib/src/rust/library/core");
        if !source.exists() {
            bail!("rust-web-src is not installed");
        }
        Ok(rustc.into())
    };
    let rustc = match find() {
        Ok(rustc) if run::exists("ld.lld") => rustc,
        _ => {
            run::install_debian(&["rustc-web", "rust-web-src", "lld"])?;
            find()?
        }
    };
    Ok(Source::Debian { rustc })
}
