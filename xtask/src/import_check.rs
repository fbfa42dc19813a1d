//! `cargo xtask import-check`: `saltus import` on many robots; what it writes compiles and agrees with Pinocchio.
//!
//! Robots: those of `models/`, and those that `tests/peers/golden.py --others` picks from pip `example-robot-data`.
//! All crates stand in one workspace in `target/import-check`, with one program that compares them, so that the
//! dynamics are compiled once. Before that, one robot is imported into an empty folder and built there as `saltus import` says.
//! With `--all`, every URDF of that package at run time instead, and every quantity, on both bases;
//! a robot is refused only if Pinocchio refuses it as well or has no forward dynamics of it.

use core::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::run;

/// Arguments of `cargo xtask import-check`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Python with Pinocchio and example-robot-data; by default that of `tests/peers/setup.sh venv`.
    #[arg(long, env = "SALTUS_PYTHON")]
    python: Option<PathBuf>,
    /// Only robots whose name contains this.
    #[arg(long)]
    only: Option<String>,
    /// Every URDF of pip example-robot-data, at run time, and every quantity: instead of the crates.
    #[arg(long)]
    all: bool,
    /// MJCF files of pip gymnasium and dm_control (`pip install --no-deps`) beside MuJoCo: instead of the crates.
    #[arg(long, conflicts_with = "all")]
    mjcf: bool,
}

/// One robot to import.
struct Robot {
    name: String,
    base: String,
    urdf: PathBuf,
    locks: Vec<String>,
    golden: PathBuf,
}

/// A robot that was imported.
struct Imported {
    name: String,
    robot_type: String,
    joints: usize,
    golden: PathBuf,
    note: &'static str,
}

/// Largest relative error against Pinocchio.
const BOUND: f64 = 1e-10;

pub(crate) fn run(args: &Args) -> Result<()> {
    let root = run::root();
    let folder = root.join("target/import-check");
    let python = python(args, &root)?;
    if args.all || args.mjcf {
        return at_run_time(&python, &root, &folder, args.mjcf);
    }
    let robots = robots(&python, &root, &folder, args.only.as_deref())?;
    let crates = folder.join("crates");
    run::remove_folder(&crates)?;
    // Of the whole workspace and with its examples, so that crates have the features that they have in its tests and are not compiled
    // again.
    let mut build = run::cargo();
    build.args(["build", "--quiet", "--workspace", "--examples"]);
    run::succeed(build.args(["--bin", "saltus"]))?;
    let saltus = target(&root).join("debug/saltus");
    stands_alone(&saltus, &root)?;
    let imported = robots
        .iter()
        .map(|robot| import(&saltus, &root, &crates, robot))
        .collect::<Result<Vec<_>>>()?;
    write_workspace(&root, &folder, &imported)?;
    let mut check = run::cargo();
    check.args(["run", "--quiet", "--package", "check"]);
    check.current_dir(&folder);
    // One target folder for all runs, whatever the caller's is.
    check.env("CARGO_TARGET_DIR", folder.join("target"));
    run::succeed(&mut check)
}

/// `saltus import FILE --out FOLDER`, and then what it says to type, letter by letter, in an empty folder with nothing around it.
fn stands_alone(saltus: &Path, root: &Path) -> Result<()> {
    let empty = std::env::temp_dir().join(format!("saltus import {}", std::process::id()));
    run::remove_folder(&empty)?;
    fs::create_dir_all(&empty)?;
    let mut import = Command::new(saltus);
    import.arg("import").arg(root.join("models/a1.urdf"));
    let said = run::output(import.args(["--out", "a1-model"]).current_dir(&empty))?;
    if !said.status.success() {
        bail!("{}", String::from_utf8_lossy(&said.stderr));
    }
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    let (_, commands) = said
        .split_once("to build it:\n")
        .context("`saltus import` names no commands")?;
    let mut shell = Command::new("sh");
    shell.args(["-ec", commands]).current_dir(&empty);
    // A newcomer's shell knows nothing of our target folder and flags.
    shell.env_remove("CARGO_TARGET_DIR").env_remove("RUSTFLAGS");
    let built = run::output(&mut shell)?;
    let errors = String::from_utf8_lossy(&built.stderr);
    if !built.status.success() || errors.contains("warning") {
        bail!("what `saltus import` says to type:\n{commands}\n{errors}");
    }
    run::remove_folder(&empty)
}

/// Every URDF or MJCF that the packages have, without crates of their own.
fn at_run_time(python: &Path, root: &Path, folder: &Path, mjcf: bool) -> Result<()> {
    let golden = folder.join(if mjcf { "mjcf" } else { "all" });
    fs::create_dir_all(&golden)?;
    let mut make = Command::new(python);
    if mjcf {
        make.arg(root.join("tests/peers/golden_mjcf.py"));
    } else {
        make.arg(root.join("tests/peers/golden.py")).arg("--all");
    }
    let result = run::output(make.arg(&golden))?;
    if !result.status.success() {
        bail!("{}", String::from_utf8_lossy(&result.stderr));
    }
    let mut check = run::cargo();
    check.args([
        "run",
        "--quiet",
        "--package",
        "saltus-tests",
        "--bin",
        "every-urdf",
        "--features",
        "saltus-tests/bench",
        "--",
    ]);
    run::succeed(check.arg(golden))
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

fn python(args: &Args, root: &Path) -> Result<PathBuf> {
    let default = || {
        let venv = std::env::var_os("SALTUS_VENV");
        let venv = venv.map_or_else(|| root.join(".venv"), PathBuf::from);
        venv.join("bin/python")
    };
    let python = args.python.clone().unwrap_or_else(default);
    if args.python.is_none() {
        // Makes the environment where it is missing or out of date.
        run::succeed(
            Command::new("bash")
                .arg(root.join("tests/peers/setup.sh"))
                .arg(if args.mjcf { "mjcf" } else { "venv" }),
        )?;
    }
    if !python.exists() {
        bail!(
            "{} is not there: give an existing --python",
            python.display()
        );
    }
    Ok(python)
}

/// The robots and their golden values, which are made where they are not kept in the repository.
fn robots(python: &Path, root: &Path, folder: &Path, only: Option<&str>) -> Result<Vec<Robot>> {
    let golden = folder.join("golden");
    fs::create_dir_all(&golden)?;
    let generator = root.join("tests/peers/golden.py");
    if !golden.join("index.txt").exists() {
        run::succeed(
            Command::new(python)
                .arg(&generator)
                .arg("--others")
                .arg(&golden),
        )?;
    }
    let index = fs::read_to_string(golden.join("index.txt"))?;
    let locks: Vec<String> = (crate::gen_model::ICUB_LOCKS.iter())
        .map(|joint| format!("{joint}=0"))
        .collect();
    let mut robots = Vec::new();
    for (name, urdf, locks, kept) in [
        ("a1", "a1.urdf", &[][..], true),
        ("a1_reference", "a1_reference.urdf", &[], false),
        ("icub23", "icub_gazebo_v2_5.urdf", &locks, true),
        ("icub23_cad", "icub_genova04.urdf", &locks, false),
    ] {
        let urdf = root.join("models").join(urdf);
        let file = if kept {
            root.join(format!("tests/data/golden/{name}.txt"))
        } else {
            golden.join(format!("{name}.txt"))
        };
        if !file.exists() {
            let mut make = Command::new(python);
            make.arg(&generator).arg("--urdf").arg(&urdf);
            make.args(["--states", "4", "--heavy", "1", "--out"])
                .arg(&file);
            if !locks.is_empty() {
                make.arg("--lock").args(locks);
            }
            run::succeed(&mut make)?;
        }
        robots.push(Robot {
            name: name.to_owned(),
            base: "floating".to_owned(),
            urdf,
            locks: locks.to_vec(),
            golden: file,
        });
    }
    for line in index.lines().filter(|line| !line.starts_with('#')) {
        let mut words = line.split(' ').map(str::to_owned);
        let (Some(name), Some(base), Some(urdf)) = (words.next(), words.next(), words.next())
        else {
            bail!("malformed line in the index of golden values: {line}");
        };
        let file = golden.join(format!("{name}.txt"));
        robots.push(Robot {
            name,
            base,
            urdf: urdf.into(),
            locks: words.collect(),
            golden: file,
        });
    }
    robots.retain(|robot| only.is_none_or(|part| robot.name.contains(part)));
    Ok(robots)
}

/// Runs `saltus import`. A robot that it refuses for its inertias is imported with the option that its message offers, and
/// the table says so.
fn import(saltus: &Path, root: &Path, crates: &Path, robot: &Robot) -> Result<Imported> {
    let package = format!("{}-model", robot.name.replace('_', "-"));
    let mut note = "";
    let mut output = None;
    for (extra, said) in [
        (&[][..], ""),
        (&["--inertia", "as-written"], "unphysical inertias kept"),
    ] {
        let mut command = Command::new(saltus);
        command.arg("import").arg(&robot.urdf);
        command.args([
            "--json",
            "--base",
            &robot.base,
            "--package",
            &package,
            "--member",
        ]);
        command.arg("--out").arg(crates.join(&robot.name));
        command.arg("--rbd-core").arg(root.join("rbd-core"));
        if !robot.locks.is_empty() {
            command.arg("--lock").args(&robot.locks);
        }
        let result = run::output(command.args(extra))?;
        let done = result.status.success();
        output = Some(result);
        if done {
            note = said;
            break;
        }
    }
    let output = output.with_context(|| robot.name.clone())?;
    if !output.status.success() {
        bail!(
            "{}: {}",
            robot.name,
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let said: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let joints = said["joints"].as_array().context("joints")?.len();
    Ok(Imported {
        name: robot.name.clone(),
        robot_type: said["type"].as_str().context("type")?.to_owned(),
        joints,
        golden: robot.golden.clone(),
        note,
    })
}

fn write_workspace(root: &Path, folder: &Path, imported: &[Imported]) -> Result<()> {
    let check = folder.join("check/src");
    fs::create_dir_all(&check)?;
    let rbd_core = root.join("rbd-core").display().to_string();
    fs::write(
        folder.join("Cargo.toml"),
        "[workspace]\nresolver = \"3\"\nmembers = [\"check\", \"crates/*\"]\n\n\
         [profile.dev]\ndebug = false\n",
    )?;
    fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock"))?;
    let mut manifest = format!(
        "[package]\nname = \"check\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         rbd-core = {{ path = {rbd_core:?} }}\n\
         nalgebra = {{ version = \"0.35\", default-features = false, features = [\"libm-force\"] }}\n",
    );
    let mut main = format!(
        "#![allow(dead_code, reason = \"shared files\")]\n\n#[path = {:?}]\nmod agree;\n#[path = {:?}]\nmod golden;\n\n{CHECK}\nfn main() {{\n    heading();\n    let mut good = true;\n",
        root.join("tests/src/agree.rs"),
        root.join("tests/src/golden.rs"),
    );
    for robot in imported {
        let package = format!("{}-model", robot.name.replace('_', "-"));
        writeln!(
            manifest,
            "{package} = {{ path = \"../crates/{}\" }}",
            robot.name
        )?;
        writeln!(
            main,
            "    good &= compare::<{}::{}, {}>({:?}, {:?}, {:?});",
            package.replace('-', "_"),
            robot.robot_type,
            robot.joints,
            robot.name,
            robot.golden,
            robot.note,
        )?;
    }
    main.push_str("    if !good {\n        std::process::exit(1);\n    }\n}\n");
    fs::write(folder.join("check/Cargo.toml"), manifest)?;
    fs::write(
        check.join("main.rs"),
        main.replace("BOUND", &format!("{BOUND:e}")),
    )?;
    Ok(())
}

/// The comparing part of the program.
const CHECK: &str = r#"
use rbd_core::{Model, TableModel};

fn heading() {
    println!("| robot | base | joints | RNEA | ABA | CRBA | frames | at run time | |");
    println!("|---|---|---|---|---|---|---|---|---|");
}

/// One row of the table: relative errors of the const model, and the worst of the model built at run time.
fn compare<M: Model<f64, N> + Default, const N: usize>(name: &str, file: &str, note: &str) -> bool {
    let model = M::default();
    let golden = golden::Golden::read(std::path::Path::new(file));
    assert_eq!(golden.joints, model.joint_names(), "{name}: order of the joints");
    let e = agree::errors::<M, N>(&model, &golden, |link| model.frame(link));
    let table = TableModel::<f64, N>::with_any_inertia(model.base_kind(), *model.base(), model.bodies())
        .expect("the tables make a model");
    let at_run_time = agree::errors::<_, N>(&table, &golden, |link| model.frame(link)).worst();
    println!(
        "| {name} | {:?} | {N} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {note} |",
        model.base_kind(), e.rnea, e.aba, e.crba, e.frames, at_run_time
    );
    e.worst() < BOUND && at_run_time < BOUND
}
"#;
