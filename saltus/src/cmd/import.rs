//! `saltus import`: turn a URDF or an MJCF into a `no_std` model crate.
//!
//! Exit code 0 if the robot is good (warnings go to standard error), 2 if the file, an option or the target
//! folder is not, 1 if the crate cannot be written.

use super::failure::{Failure, brief};
use super::folder::{check_new, describe};
use super::output::{Output, number};
use jump_planner::range::Range;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use model_import::emit::{
    Crate, Dependency, Provenance, commands, is_keyword, type_name, write_crate,
};
use model_import::limbs::{expression, structure};
use model_import::options::AXIS_EXACT;
use model_import::{ImportError, InertiaPolicy, MimicPolicy, Options, Robot, mjcf, parse_lock};
use rbd_core::BaseKind;
use serde_json::{Value, json};

/// Options of `saltus import`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The URDF, or the MJCF (`.xml` with a `<mujoco>` in it).
    urdf: PathBuf,
    /// Lock joints at a position, rad or m.
    #[arg(long, num_args = 1.., value_name = "JOINT=VALUE")]
    lock: Vec<String>,
    /// Whether the base moves; of an MJCF, whether its free joint is kept.
    #[arg(long, default_value = "floating", value_parser = ["floating", "fixed"])]
    base: String,
    /// What becomes of joints that follow another: joints of their own with the coupling beside them (`REDUCTION`), locked, or an
    /// error.
    #[arg(long, default_value = "free", value_parser = ["free", "lock", "refuse"])]
    mimic: String,
    /// Largest deviation of a joint axis from a coordinate axis that is taken for rounding; aligned joints compute faster.
    #[arg(long, default_value_t = AXIS_EXACT, allow_negative_numbers = true, value_parser = number(Range::From(0.0, 0.1)))]
    axis_rounding: f64,
    /// Whether moments of inertia that no body has are an error or kept.
    #[arg(long, default_value = "physical", value_parser = ["physical", "as-written"])]
    inertia: String,
    /// Folder to write the crate to; it must not exist or be empty. Without it the robot is only checked.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Package name of the crate; the robot's name with `-model` by default.
    #[arg(long, requires = "out")]
    package: Option<String>,
    /// Where the crate finds rbd-core: a folder, or a version. By default the one this program was built with.
    #[arg(long, value_name = "FOLDER|VERSION", requires = "out")]
    rbd_core: Option<String>,
    /// The crate is a member of the workspace around the folder, and none of its own.
    #[arg(long, requires = "out")]
    member: bool,
    /// Licence of the URDF (SPDX), which becomes the crate's.
    #[arg(long, default_value = "LicenseRef-unknown", requires = "out")]
    licence: String,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let read = |path: &Path| match path.extension().is_some_and(|e| e == "xml") {
        true => mjcf::read(path),
        false => jump_planner::file::read_text(path),
    };
    let text = read(&args.urdf).map_err(|error| describe(&args.urdf, &error))?;
    let robot = options(args)
        .and_then(
            |options| match text.contains("<mujoco") && !text.contains("<robot") {
                true => Robot::from_mjcf(&text, &options),
                false => Robot::from_urdf(&text, &options),
            },
        )
        .map_err(|error| format!("{}: {error}", args.urdf.display()))?;
    let file = args.urdf.file_name().unwrap_or_default().to_string_lossy();
    let provenance = Provenance::new(&file, &text, &args.licence);
    if let Some(folder) = &args.out {
        if !folder.is_dir() {
            check_new(Some(folder))?;
        }
        write_crate(folder, &robot, &about(args, &robot)?, &provenance).map_err(
            |error| match error.kind() {
                ErrorKind::AlreadyExists => Failure::Refused(error.to_string()),
                _ => Failure::Outside(describe(folder, &error)),
            },
        )?;
    }
    report(args, &robot, &provenance);
    Ok(ExitCode::SUCCESS)
}

fn options(args: &Args) -> Result<Options, ImportError> {
    let locks = args.lock.iter().map(|text| parse_lock(text));
    Ok(Options {
        base: match args.base.as_str() {
            "fixed" => BaseKind::Fixed,
            _ => BaseKind::Floating,
        },
        locks: locks.collect::<Result<_, _>>()?,
        mimic: match args.mimic.as_str() {
            "lock" => MimicPolicy::Lock,
            "refuse" => MimicPolicy::Refuse,
            _ => MimicPolicy::Free,
        },
        inertia: match args.inertia.as_str() {
            "as-written" => InertiaPolicy::AsWritten,
            _ => InertiaPolicy::Physical,
        },
        axis_rounding: args.axis_rounding,
    })
}

/// Letters of a version, such as 0.1.0-rc.1.
fn of_version(c: char) -> bool {
    c.is_ascii_alphanumeric() || ".-+*".contains(c)
}

/// Names that a crate cannot have beside the compiler's own.
const TAKEN: [&str; 6] = ["core", "std", "alloc", "test", "proc_macro", "rbd-core"];

fn about(args: &Args, robot: &Robot) -> Result<Crate, String> {
    let rbd_core = match &args.rbd_core {
        None => Dependency::default(),
        Some(text) => {
            let folder = Path::new(text);
            if folder.is_dir() {
                let path = folder.canonicalize().map_err(|error| error.to_string())?;
                Dependency::Path(path)
            } else if text.starts_with(|c: char| c.is_ascii_digit()) && text.chars().all(of_version)
            {
                Dependency::Version(text.clone())
            } else {
                return Err(format!("--rbd-core {text}: neither a folder nor a version"));
            }
        }
    };
    let package = match &args.package {
        Some(package) => package.clone(),
        None => default_package(&robot.name),
    };
    let word = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !package.starts_with(|c: char| c.is_ascii_alphabetic()) || !package.chars().all(word) {
        return Err(format!(
            "--package {package}: not a package name: letters, digits, - and _, a letter first"
        ));
    }
    if is_keyword(&package) {
        return Err(format!(
            "--package {package}: a keyword of Rust, so that no program can use the crate: choose one such as {package}-model"
        ));
    }
    if TAKEN.contains(&package.as_str()) {
        return Err(format!(
            "--package {package}: that is another crate's name: choose one such as {package}-model"
        ));
    }
    Ok(Crate {
        package,
        rbd_core,
        member: args.member,
    })
}

/// `My Robot_v2` to `my-robot-v2-model`.
fn default_package(robot: &str) -> String {
    let words = robot.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<String> = (words.filter(|w| !w.is_empty()))
        .map(str::to_ascii_lowercase)
        .collect();
    let name = words.join("-");
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        format!("{name}-model")
    } else {
        format!("robot-{name}-model")
    }
}

fn report(args: &Args, robot: &Robot, provenance: &Provenance) {
    if args.output.quiet {
        return;
    }
    for warning in &robot.warnings {
        tell!("warning: {}", brief(&warning.to_string()));
    }
    let limbs = expression(&structure(&robot.bodies));
    let base = match robot.base_kind {
        BaseKind::Floating => "floating",
        BaseKind::Fixed => "fixed",
    };
    if args.output.json {
        let locked: Value = (robot.locked.iter())
            .map(|(joint, value)| (joint.clone(), json!(value)))
            .collect::<serde_json::Map<_, _>>()
            .into();
        let warnings: Vec<String> = robot.warnings.iter().map(ToString::to_string).collect();
        let object = json!({
            "robot": robot.name,
            "type": type_name(&robot.name),
            "base": base,
            "joints": robot.joints.iter().map(|j| &j.name).collect::<Vec<_>>(),
            "frames": robot.frames.len(),
            "mass_kg": robot.mass(),
            "limbs": limbs,
            "locked": locked,
            "warnings": warnings,
            "source": provenance.source,
            "sha256": provenance.sha256,
            "independent": robot.independent().iter().map(|&i| &robot.joints[i].name).collect::<Vec<_>>(),
            "out": args.out,
        });
        say!("{object}");
        return;
    }
    let (joints, frames) = (robot.joints.len(), robot.frames.len());
    say!(
        "{}: {joints} joints on a {} base, {frames} frames, {:.6} kg",
        robot.name,
        base,
        robot.mass()
    );
    say!("limbs: {limbs}");
    if let Some(folder) = &args.out {
        say!("wrote {}; to build it:", folder.display());
        for command in commands(folder).lines() {
            say!("  {command}");
        }
    }
}
