//! `cargo xtask import-check --all`: every URDF of pip example-robot-data, imported at run time on both bases, and every quantity
//! of `tests/peers/golden.py --all` beside Pinocchio's; `--mjcf`: MJCF files of pip packages and `golden_mjcf.py` likewise.
#![allow(clippy::expect_used, reason = "what is missing must fail the check")]

use std::path::Path;
use std::process::ExitCode;

use model_import::{ImportError, InertiaPolicy, Options, Robot, mjcf};
use rbd_core::BaseKind;
use saltus_tests::{everything, golden};

/// Most joints of the robots.
const CAP: usize = 104;

/// Imports one URDF or MJCF; moments of inertia that no body has are kept on the second attempt, as the peers keep them.
fn import(file: &str, base: BaseKind) -> Result<(Robot, &'static str), String> {
    let mut options = Options {
        base,
        ..Options::default()
    };
    let path = Path::new(file);
    let mjcf = path.extension().is_some_and(|e| e == "xml");
    let text = match mjcf {
        true => mjcf::read(path),
        false => std::fs::read_to_string(path),
    };
    let text = text.map_err(|e| e.to_string())?;
    let read = |options: &Options| match mjcf {
        true => Robot::from_mjcf(&text, options),
        false => Robot::from_urdf(&text, options),
    };
    match read(&options) {
        Err(ImportError::UnphysicalInertia { .. }) => {
            options.inertia = InertiaPolicy::AsWritten;
            let robot = read(&options).map_err(|e| e.to_string())?;
            Ok((robot, "unphysical inertias kept"))
        }
        other => other.map(|robot| (robot, "")).map_err(|e| e.to_string()),
    }
}

/// One line of the table; false if a robot disagrees, or one side alone refuses it.
fn row(folder: &Path, line: &str) -> bool {
    let mut words = line.splitn(4, ' ');
    let mut word = || words.next().unwrap_or_default();
    let (name, base, urdf, reason) = (word(), word(), word(), word());
    let kind = if base == "fixed" {
        BaseKind::Fixed
    } else {
        BaseKind::Floating
    };
    match (base, import(urdf, kind)) {
        ("-", Ok(_)) => {
            println!("| {name} | - | read by us alone: {reason} |");
            true
        }
        ("-", Err(ours)) => {
            println!("| {name} | - | refused by both: {ours}; {reason} |");
            true
        }
        (_, Err(ours)) if ours.contains("the mass of a mesh") => {
            println!("| {name} | - | refused by name: {ours} |");
            true
        }
        (_, Err(ours)) => {
            println!("| {name} | {base} | WRONG: {ours} |");
            false
        }
        (_, Ok((robot, note))) => {
            let golden = golden::Golden::read(&folder.join(format!("{name}.{base}.txt")));
            let joints: Vec<&str> = robot.joints.iter().map(|j| j.name.as_str()).collect();
            let same = golden
                .joints
                .iter()
                .zip(joints)
                .all(|(theirs, ours)| theirs == "-" || theirs == ours);
            let model = Box::new(robot.model::<f64, CAP>().expect("the tables make a model"));
            let errors = everything::errors(&*model, &golden, |link| robot.frame(link));
            let (key, worst) = errors
                .iter()
                .max_by(|a, b| a.1.total_cmp(b.1))
                .expect("errors");
            let mut note = if same {
                note.to_owned()
            } else {
                "the joints have another order".to_owned()
            };
            let mut good = same
                && errors
                    .iter()
                    .all(|(key, error)| *error < everything::bound(&golden, key));
            let file = folder.join(format!("{name}.{base}.mimic.txt"));
            if file.exists() {
                let golden = golden::Golden::read(&file);
                let reduction = robot
                    .reduction::<f64, CAP, CAP>()
                    .expect("independent joints");
                let errors = everything::coupled_errors(&*model, &reduction, &golden);
                let worst = errors.values().copied().fold(0.0, f64::max);
                note.push_str(&format!(
                    " {} independent joints: {worst:.1e}",
                    robot.independent().len()
                ));
                good &= worst < 1e-11;
            }
            let joints = robot.joints.len();
            println!(
                "| {name} | {base} | {joints} | {worst:.1e} in {key} |{}| {note} |",
                if good { " " } else { " WRONG " }
            );
            good
        }
    }
}

fn main() -> ExitCode {
    let folder = std::env::args()
        .nth(1)
        .expect("the folder of golden.py --all");
    let work = move || {
        let folder = Path::new(&folder);
        let index = std::fs::read_to_string(folder.join("index.txt")).expect("index.txt");
        let rows = index.lines().filter(|line| !line.starts_with('#'));
        rows.fold((0, 0), |(good, all), line| {
            (good + usize::from(row(folder, line)), all + 1)
        })
    };
    // Workspaces for that many joints are large.
    let thread = std::thread::Builder::new()
        .stack_size(1 << 28)
        .spawn(work)
        .expect("a thread");
    let (good, all) = thread.join().expect("no panic");
    println!("{good} of {all}");
    if good == all {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
