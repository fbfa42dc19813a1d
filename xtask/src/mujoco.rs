//! `cargo xtask mujoco`: fetches the MuJoCo library that `mujoco-rs` is made for, and runs cargo with it.
//!
//! Programs for people (`run`, `build`, `install`) are built in `target/mujoco-build`, so that they do not take the place of those without
//! MuJoCo, and find the library where it is without an environment variable (`saltus/build.rs`). Tests share the usual folder.
//!
//! The library is the one in the wheel `mujoco` on PyPI: it needs nothing but glibc. It is linked by the names
//! `libmujoco.so` and `libmujoco.so.VERSION`, of which the second is its SONAME. The wheel's C headers stand beside it in `include`.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::run;

/// The version that the bindings were written for; they refuse any other.
const VERSION: &str = "3.17.0";

/// Arguments of `cargo xtask mujoco`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Python with pip.
    #[arg(long, env = "SALTUS_PYTHON", default_value = "python3")]
    python: PathBuf,
    /// Arguments of cargo, such as `test -p contact-sim --features mujoco`; without them the environment that a build needs is printed.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    cargo: Vec<OsString>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let (folder, search) = library(&args.python)?;
    if args.cargo.is_empty() {
        println!("export MUJOCO_DYNAMIC_LINK_DIR={}", folder.display());
        println!("export LD_LIBRARY_PATH={}", search.to_string_lossy());
        return Ok(());
    }
    let mut cargo = run::cargo();
    cargo.current_dir(env::current_dir()?).args(&args.cargo);
    cargo.env("MUJOCO_DYNAMIC_LINK_DIR", &folder);
    let first = args.cargo.first().and_then(|word| word.to_str());
    if matches!(first, Some("run" | "r" | "build" | "b" | "install")) {
        aside(&mut cargo);
    }
    run::succeed(cargo.env("LD_LIBRARY_PATH", search))
}

/// saltus with both simulators, built as [`tests`] build it, so that the suites compile nothing again; its arguments follow.
pub(crate) fn saltus() -> Result<Command> {
    let mut build = tests()?;
    build.args(["--quiet", "--no-run", "--test", "all"]);
    run::succeed(&mut build)?;
    let (_, search) = library(Path::new("python3"))?;
    let mut saltus = Command::new(build_folder().join("release/saltus"));
    saltus
        .current_dir(run::root())
        .env("LD_LIBRARY_PATH", search);
    Ok(saltus)
}

/// `cargo test` of `jump-lab` and `saltus` with both simulators, in the release build that the other checks use too.
pub(crate) fn tests() -> Result<Command> {
    let (folder, search) = library(Path::new("python3"))?;
    let mut cargo = run::cargo();
    cargo.env("MUJOCO_DYNAMIC_LINK_DIR", &folder);
    cargo.env("LD_LIBRARY_PATH", search);
    aside(&mut cargo);
    cargo.args(["test", "--release"]);
    cargo.args(["--package", "jump-lab", "--package", "saltus"]);
    cargo.args(["--features", "jump-lab/mujoco,saltus/mujoco"]);
    Ok(cargo)
}

/// Builds in a folder of its own, unless the caller has chosen one.
fn aside(cargo: &mut Command) {
    cargo.env("CARGO_TARGET_DIR", build_folder());
}

/// Where [`aside`] builds.
pub(crate) fn build_folder() -> PathBuf {
    let chosen = env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    chosen.unwrap_or_else(|| run::root().join("target/mujoco-build"))
}

/// The folder with MuJoCo's library and its `include`, and the path on which programs in C look for it.
pub(crate) fn library_for_c() -> Result<(PathBuf, OsString)> {
    library(Path::new("python3"))
}

/// The folder of the library, fetched if it is not there, and the path on which programs look for it.
fn library(python: &Path) -> Result<(PathBuf, OsString)> {
    let folder = run::root().join("target/mujoco");
    let library = folder.join(format!("libmujoco.so.{VERSION}"));
    if !library.exists() || !folder.join("include/mujoco/mujoco.h").exists() {
        fetch(python, &folder, &library)?;
    }
    let search = search_path(&folder)?;
    Ok((folder, search))
}

/// The folder before whatever the caller has.
fn search_path(folder: &Path) -> Result<OsString> {
    let old = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let paths = core::iter::once(folder.to_path_buf())
        .chain(env::split_paths(&old).filter(|path| !path.as_os_str().is_empty()));
    env::join_paths(paths).context("LD_LIBRARY_PATH")
}

fn fetch(python: &Path, folder: &Path, library: &Path) -> Result<()> {
    let wheel = folder.join("wheel");
    fs::create_dir_all(&wheel)?;
    println!("fetching MuJoCo {VERSION} from PyPI");
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "download", "--quiet", "--no-deps", "--dest"]);
    pip.arg(&wheel).arg(format!("mujoco=={VERSION}"));
    run::succeed(&mut pip).context("pip is needed to fetch MuJoCo (Debian: python3-pip)")?;
    for entry in fs::read_dir(&wheel)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "whl") {
            let mut unpack = Command::new(python);
            unpack.args(["-m", "zipfile", "-e"]);
            run::succeed(unpack.arg(&path).arg(&wheel))?;
        }
    }
    let inside = wheel.join(format!("mujoco/libmujoco.so.{VERSION}"));
    let headers = folder.join("include");
    run::remove_folder(&headers)?;
    fs::rename(wheel.join("mujoco/include"), headers).context("the wheel has no C headers")?;
    // The short name before the long one: a library in place means that all is in place.
    fs::copy(&inside, folder.join("libmujoco.so"))
        .with_context(|| format!("{} is not in the wheel", inside.display()))?;
    fs::rename(&inside, library)?;
    fs::remove_dir_all(&wheel)?;
    Ok(())
}
