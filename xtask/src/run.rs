//! Starting other programs.

use core::time::Duration;
use std::env;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::Value;
use wait_timeout::ChildExt;

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// The cargo that started this program.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    // What cargo tells a program it runs is about that program, not about the builds it starts.
    for (key, _) in env::vars_os() {
        let name = key.to_string_lossy();
        if name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_") {
            command.env_remove(&key);
        }
    }
    command
}

/// Whether release builds are optimised as a whole, of whoever started this program: `.ci/run` saves itself the time.
///
/// Images and programs that are timed or counted are built as their profile says; their builds do without this variable.
pub(crate) const LTO: &str = "CARGO_PROFILE_RELEASE_LTO";

/// The same cargo, in the firmware's workspace.
pub(crate) fn firmware_cargo() -> Command {
    let mut command = cargo();
    command.current_dir(firmware()).env_remove(LTO);
    command
}

/// The folder of the firmware's workspace.
pub(crate) fn firmware() -> PathBuf {
    root().join("firmware")
}

/// The programs that cargo built, from its messages in JSON.
pub(crate) fn executables(messages: &str) -> impl Iterator<Item = PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
}

/// Removes a folder, if it is there.
pub(crate) fn remove_folder(folder: &Path) -> Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", folder.display()))
        }
        _ => Ok(()),
    }
}

/// Runs `command` to its end; an error if it fails.
pub(crate) fn succeed(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot start {}", show(command)))?;
    if !status.success() {
        bail!("{} ended with {status}", show(command));
    }
    Ok(())
}

/// Runs `command` and returns its output, whether it succeeds or not.
pub(crate) fn output(command: &mut Command) -> Result<Output> {
    command
        .output()
        .with_context(|| format!("cannot start {}", show(command)))
}

/// Runs `command`, which must succeed, and returns its standard output. Its standard error passes through.
pub(crate) fn stdout(command: &mut Command) -> Result<String> {
    let output = output(command.stderr(Stdio::inherit()))?;
    if !output.status.success() {
        bail!("{} ended with {}", show(command), output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("output of {}", show(command)))
}

/// As [`stdout`], but stops the program and fails after `limit`.
pub(crate) fn stdout_within(command: &mut Command, limit: Duration) -> Result<String> {
    let shown = show(command);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {shown}"))?;
    let mut pipe = child.stdout.take().context("no pipe to the program")?;
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        pipe.read_to_string(&mut text).map(|_| text)
    });
    let Some(status) = child.wait_timeout(limit)? else {
        child.kill()?;
        child.wait()?;
        bail!("{shown} did not end within {} s", limit.as_secs());
    };
    let text = match reader.join() {
        Ok(text) => text.with_context(|| format!("output of {shown}"))?,
        Err(_) => bail!("the reader of {shown} panicked"),
    };
    if !status.success() {
        let tail: Vec<&str> = text.lines().rev().take(3).collect();
        bail!("{shown} ended with {status}; its last lines, latest first: {tail:?}");
    }
    Ok(text)
}

/// Whether a program of this name can be started.
pub(crate) fn exists(program: &str) -> bool {
    Command::new(program)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Installs Debian packages, or says what to do.
pub(crate) fn install_debian(packages: &[&str]) -> Result<()> {
    let wanted = packages.join(" ");
    let root = output(Command::new("id").arg("-u")).is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    if !root || !exists("apt-get") {
        bail!("{wanted} missing: install (Debian: `sudo apt-get install {wanted}`)");
    }
    // One at a time: apt-get does not wait for another.
    let lock = File::create(env::temp_dir().join("saltus-apt-get.lock"))?;
    lock.lock()?;
    println!("installing {wanted} with apt-get");
    let install = || {
        succeed(
            Command::new("apt-get")
                .args(["install", "-y", "-q", "--no-install-recommends"])
                .args(packages)
                .env("DEBIAN_FRONTEND", "noninteractive")
                .stdout(Stdio::null()),
        )
    };
    install().or_else(|_| {
        succeed(
            Command::new("apt-get")
                .args(["update", "-q"])
                .stdout(Stdio::null()),
        )?;
        install()
    })
}

/// A command line for messages.
fn show(command: &Command) -> String {
    let name = Path::new(command.get_program())
        .file_name()
        .unwrap_or(command.get_program());
    let words = core::iter::once(name).chain(command.get_args());
    words
        .map(OsStr::to_string_lossy)
        .collect::<Vec<_>>()
        .join(" ")
}
