//! `cargo xtask python`: the Python package as a user gets it: the wheel is built, installed and tested in a virtual environment of its own.
//!
//! Everything lies in `target/python`: the environment, cargo's folder and the wheel. What PyPI gives there is installed once.

use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::run;

/// What the checks need beside the package: a version where another would change what is measured.
const PACKAGES: [&str; 9] = [
    "maturin>=1.9,<2",
    "numpy",
    "pytest",
    "ruff",
    "mypy",
    "matplotlib",
    "mujoco==3.17.0",
    "nbclient",
    "ipykernel",
];

/// What only an example needs.
const DRAKE: &str = "drake==1.51.1";

/// Longest time of an example or a notebook.
const PATIENCE: Duration = Duration::from_secs(120);

/// Arguments of `cargo xtask python`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Python with pip.
    #[arg(long, env = "SALTUS_PYTHON", default_value = "python3")]
    python: PathBuf,
    /// Also lint its Rust half, fly in Drake and print the table of costs, which take longer.
    #[arg(long)]
    more: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let home = run::root().join("target/python");
    let bin = environment(&args.python, &home.join("venv"))?;
    let tool = |name: &str| {
        let mut command = Command::new(bin.join(name));
        command.current_dir(run::root().join("python"));
        command
    };
    run::succeed(tool("ruff").args(["check", "--quiet", "."]))?;
    run::succeed(tool("ruff").args(["format", "--check", "--quiet", "."]))?;
    if args.more {
        lints(&home)?;
    }
    let wheel = build(tool("maturin"), &home)?;
    let install = ["-m", "pip", "install", "--quiet", "--no-deps"];
    let forced = ["--force-reinstall", "--no-index"];
    run::succeed(tool("python").args(install).args(forced).arg(&wheel))?;
    // Away from the sources, which would be imported in the place of what was installed.
    run::succeed(
        tool("python")
            .args(["-m", "mypy.stubtest", "saltus"])
            .current_dir(&home),
    )?;
    run::succeed(tool("mypy").args(["-p", "saltus"]).current_dir(&home))?;
    run::succeed(tool("pytest").args(["--quiet", "--import-mode=append", "tests"]))?;
    let picture = home.join("barrel-roll.png");
    let urdf = run::root().join("models/a1.urdf");
    let jump = [Path::new("a1/barrel-roll"), &urdf, &picture];
    let example = |name: &str, arguments: &[&Path]| -> Result<()> {
        let mut python = tool("python");
        python.arg(Path::new("examples").join(name)).args(arguments);
        print!("{}", run::stdout_within(&mut python, PATIENCE)?);
        Ok(())
    };
    example("mujoco_loop.py", &jump)?;
    ensure!(picture.exists(), "mujoco_loop.py draws nothing");
    example("topics_loop.py", &[])?;
    if args.more {
        run::succeed(tool("pip").args(["install", "--quiet", DRAKE]))?;
        example("drake_loop.py", &[])?;
        example("costs.py", &[])?;
    }
    notebooks(&home, tool)?;
    Ok(())
}

/// Executes every notebook; what it drew stands in the folder of this command.
fn notebooks(home: &Path, tool: impl Fn(&str) -> Command) -> Result<()> {
    for entry in fs::read_dir(run::root().join("python/notebooks"))? {
        let path = entry?.path();
        let name = path.file_name().context("a notebook without a name")?;
        let mut execute = tool("jupyter-execute");
        execute.arg("--output").arg(home.join(name)).arg(&path);
        run::stdout_within(&mut execute, PATIENCE).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// The folder of the environment's programs; made, and filled from PyPI, where it is not there.
fn environment(python: &Path, venv: &Path) -> Result<PathBuf> {
    let bin = venv.join("bin");
    let done = venv.join("packages.txt");
    let wanted = PACKAGES.join("\n");
    if fs::read_to_string(&done).is_ok_and(|there| there == wanted) {
        return Ok(bin);
    }
    run::remove_folder(venv)?;
    run::succeed(Command::new(python).args(["-m", "venv"]).arg(venv))?;
    let mut pip = Command::new(bin.join("python"));
    run::succeed(pip.args(["-m", "pip", "install", "--quiet"]).args(PACKAGES))?;
    fs::write(done, wanted)?;
    Ok(bin)
}

/// Formatting and lints of the Rust half.
fn lints(home: &Path) -> Result<()> {
    for arguments in [
        &["fmt", "--check"][..],
        &["clippy", "--quiet", "--locked", "--", "-D", "warnings"],
    ] {
        let mut cargo = run::cargo();
        cargo.current_dir(run::root().join("python"));
        run::succeed(
            cargo
                .env("CARGO_TARGET_DIR", home.join("cargo"))
                .args(arguments),
        )?;
    }
    Ok(())
}

/// Builds the wheel; the only one in its folder.
fn build(mut maturin: Command, home: &Path) -> Result<PathBuf> {
    let folder = home.join("wheel");
    run::remove_folder(&folder)?;
    maturin.env("CARGO_TARGET_DIR", home.join("cargo"));
    maturin.args(["build", "--quiet", "--release", "--locked", "--out"]);
    run::succeed(maturin.arg(&folder))?;
    let wheel = fs::read_dir(&folder)?
        .next()
        .context("no wheel was built")??;
    println!(
        "{}: {} kB",
        wheel.file_name().to_string_lossy(),
        wheel.metadata()?.len() / 1000
    );
    Ok(wheel.path())
}
