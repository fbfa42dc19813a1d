//! Values that cannot be: named with their key, what they are and what is allowed, before anything is computed; nothing is left behind.

use crate::command::saltus;
use core::time::Duration;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    crate::command::folder(&format!("values-{name}"))
}

fn refused(folder: &Path, arguments: &[&str], words: &[&str]) -> String {
    crate::refused::refused(Duration::from_secs(60), folder, arguments, words)
}

const LATERAL: &str = include_str!("../../jump-planner/tasks/a1/lateral.toml");

/// The shipped problem file with one value changed.
pub(crate) fn problem(path: &Path, change: impl FnOnce(&mut Value)) {
    let mut file: Value =
        serde_json::from_str(include_str!("../../reference-problems/data/a1-jumps.json")).unwrap();
    change(&mut file);
    fs::write(path, file.to_string()).unwrap();
}

/// Values of the problem file that cannot be, and what is told of each.
fn impossible_problems() -> Vec<(&'static str, Value, &'static [&'static str])> {
    vec![
        (
            "/tasks/spin/N",
            json!([1_000_000_000, 30]),
            &["spin", "N", "2000", "1000000000"],
        ),
        (
            "/tasks/spin/N",
            json!([usize::MAX, usize::MAX]),
            &["N", "2000"],
        ),
        (
            "/tasks/spin/N",
            json!(vec![50; 100]),
            &["N", "12 phases", "100"],
        ),
        (
            "/tasks/spin/phases",
            json!([[0, 1, 2, 2], []]),
            &["phases", "foot 2", "twice"],
        ),
        (
            "/tasks/spin/phases",
            json!([[0, 1, 2, 7], []]),
            &["phases", "no foot 7"],
        ),
        (
            "/tasks/lateral_down/edge",
            json!([1, 0, 0.18]),
            &["lateral_down", "edge", "sign", "1 or -1", "0"],
        ),
        (
            "/tasks/lateral_down/edge",
            json!([2, 1, 0.18]),
            &["edge", "axis"],
        ),
        ("/tasks/lateral_down/edge", json!(null), &["edge"]),
        (
            "/tasks/spin/angle",
            json!(1e8),
            &["angle", "63", "100000000"],
        ),
        (
            "/tasks/spin/goal",
            json!([0.0, 1e300, 0.0]),
            &["goal", "100", "1e300"],
        ),
        ("/tasks/spin/T0", json!([1e9, 0.3]), &["T0", "10"]),
        (
            "/tasks/spin/axis",
            json!([0.0, 0.0, 0.0]),
            &["axis", "unit"],
        ),
        (
            "/constants/I_B/0/1",
            json!(0.01),
            &["I_B", "symmetric", "0.01"],
        ),
        (
            "/constants/I_B/0/0",
            json!(-1.0),
            &["I_B", "positive definite"],
        ),
        ("/constants/M", json!(0.0), &["M", "above 0"]),
        ("/tasks/spin/T0", json!([1e-300, 0.3]), &["T0", "1e-300"]),
        ("/tasks/spin/ttot", json!(0.1), &["TTOT_LO and ttot", "0.1"]),
        (
            "/tasks/spin/euler",
            json!("xyz"),
            &["spin", "euler", "zyx or zxy", "xyz"],
        ),
        // What is no number of its kind is named with its key too, and so is a file without a task.
        ("/tasks/spin/N", json!([-1, 30]), &["tasks.spin.N", "-1"]),
        ("/constants/MU", json!("0.6"), &["constants.MU", "0.6"]),
        ("/tasks", json!({}), &["tasks", "there must be one"]),
        ("/constants/SIDE/0", json!(3.0), &["SIDE", "1 or -1"]),
    ]
}

#[test]
fn a_problem_file_is_looked_at_before_it_is_solved() {
    let folder = folder("problem");
    let path = folder.join("p.json");
    let big = 1_000_000_000;
    for (pointer, value, words) in impossible_problems() {
        problem(&path, |file| *file.pointer_mut(pointer).unwrap() = value);
        for stage in ["srb", "whole-body"] {
            let arguments = [
                "plan",
                "--problem",
                "p.json",
                "--reference",
                "spin",
                "--stage",
                stage,
                "--solution",
                "s.json",
            ];
            let said = refused(&folder, &arguments, words);
            assert!(said.contains("p.json"), "{pointer}: {said}");
            assert!(!folder.join("s.json").exists(), "{pointer}");
        }
    }
    for (pointer, key) in [
        ("", "tsaks"),
        ("/constants", "MASS"),
        ("/tasks/spin", "nodes"),
    ] {
        problem(&path, |file| {
            file.pointer_mut(pointer).unwrap()[key] = json!(big)
        });
        refused(
            &folder,
            &["plan", "--problem", "p.json", "--reference", "spin"],
            &["unknown field", key],
        );
    }
}

/// Of two tasks with one name the last was solved in silence.
#[test]
fn a_task_that_is_there_twice_is_refused() {
    let folder = folder("twice");
    problem(&folder.join("p.json"), |_| {});
    let text = fs::read_to_string(folder.join("p.json")).unwrap();
    let twice = text.replacen("\"tasks\":{", "\"tasks\":{\"spin\":SPIN,", 1);
    let file: Value = serde_json::from_str(&text).unwrap();
    let twice = twice.replace("SPIN", &file["tasks"]["spin"].to_string());
    assert_ne!(text, twice);
    fs::write(folder.join("p.json"), twice).unwrap();
    let arguments = ["plan", "--problem", "p.json", "--reference", "spin"];
    refused(&folder, &arguments, &["p.json", "`spin`", "twice"]);
    let arguments = ["plan", "--problem", "p.json", "--reference", "spun"];
    problem(&folder.join("p.json"), |_| {});
    refused(
        &folder,
        &arguments,
        &["p.json", "`spun`", "there are", "spin"],
    );
}

/// A solution that the whole-body stage is told to follow, for a thousand years or in no direction.
#[test]
fn a_solution_to_follow_is_looked_at() {
    let folder = folder("solution");
    let shipped: Value =
        serde_json::from_str(include_str!("../../reference-problems/data/srb/spin.json")).unwrap();
    for (pointer, value, word) in [
        ("/sol/T/0", json!(3e10), "T of"),
        ("/sol/R/3/0", json!(2.0), "R of"),
    ] {
        let mut file = shipped.clone();
        *file.pointer_mut(pointer).unwrap() = value;
        fs::write(folder.join("srb.json"), file.to_string()).unwrap();
        let arguments = [
            "plan",
            "--reference",
            "spin",
            "--stage",
            "whole-body",
            "--srb",
            "srb.json",
        ];
        refused(&folder, &arguments, &[word]);
    }
}

/// What was not solved leaves nothing that looks as if it were.
#[test]
fn a_problem_without_solution_leaves_none() {
    let folder = folder("unsolved");
    // Ten metres up in 0.9 s.
    problem(&folder.join("p.json"), |file| {
        file["tasks"]["spin"]["goal"] = json!([0.0, 0.0, 10.0])
    });
    let arguments = [
        "plan",
        "--problem",
        "p.json",
        "--reference",
        "spin",
        "--solution",
        "s.json",
    ];
    assert_eq!(saltus(&folder, &arguments).status.code(), Some(2));
    let far =
        include_str!("../../jump-planner/tasks/a1/lateral.toml").replace("0.3, 0.0]", "50.0, 0.0]");
    fs::write(folder.join("far.toml"), far).unwrap();
    let arguments = ["plan", "far.toml", "--solution", "s.json", "--out", "far"];
    assert_eq!(saltus(&folder, &arguments).status.code(), Some(2));
    let mut left: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|x| x.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["far.toml", "p.json"]);
}

/// Task files with a value that cannot be, and what is told of each.
fn impossible_tasks() -> Vec<(String, &'static [&'static str])> {
    let turn =
        |angle: &str| format!("{LATERAL}\n[turn]\naxis = [0.0, 0.0, 1.0]\nangle_deg = {angle}\n");
    let limit = |line: &str| format!("{LATERAL}\n[limits]\n{line}\n");
    let first = |line: &str| format!("{line}\n{LATERAL}");
    let edge = "[box]\naxis = \"y\"\ndrop_m = 0.0\n";
    vec![
        (
            turn("1e8"),
            &["turn.angle_deg", "100000000", "-3600 to 3600"][..],
        ),
        (turn("inf"), &["turn.angle_deg", "finite"]),
        (
            LATERAL
                .replace("guess_s = 0.5", "guess_s = 0.5\nturn_deg = 0.0")
                .replace("guess_s = 0.3", "guess_s = 0.3\nturn_deg = 90.0"),
            &["phase 2", "turn_deg", "0 degrees", "turn.angle_deg"],
        ),
        (
            limit("friction_share = 2.0"),
            &["limits.friction_share", "2", "up to 1"],
        ),
        (
            limit("speed_share = 1.5"),
            &["limits.speed_share", "1.5", "up to 1"],
        ),
        (
            limit("torque_shares = [0.5, 0.6, 7.0]"),
            &["limits.torque_shares", "7", "up to 1"],
        ),
        (
            limit("friction = -0.1"),
            &["limits.friction", "-0.1", "0 to 10"],
        ),
        (
            first("lock = [\"FL_hip_joint=0.3\"]"),
            &["lock", "FL_hip_joint=0.3", "a1"],
        ),
        (
            LATERAL.replace("max_s = 0.8", "max_s = 1e12"),
            &["total.max_s", "up to 10"],
        ),
        (
            LATERAL.replace("guess_s = 0.5", "guess_s = 1e12"),
            &["guess_s", "up to 5"],
        ),
        (
            LATERAL.replace("guess_s = 0.5", "guess_s = 0.5\nmin_s = 0.51"),
            &["phase 1: guess_s", "from 0.51 to 0.55, not 0.5", "min_s"],
        ),
        (
            LATERAL.replace("guess_s = 0.3", "guess_s = 0.3\nmax_s = 0.29"),
            &["phase 2: guess_s", "to 0.29, not 0.3", "max_s"],
        ),
        (
            limit("clearance_m = -1"),
            &["limits.clearance_m", "from 0 to 10", "-1"],
        ),
        (
            LATERAL.replace("intervals = 50", "intervals = 1000000000"),
            &["intervals", "1 to 1000"],
        ),
        (
            format!("{LATERAL}\n{edge}side = -128\ndistance_m = 1.0\n"),
            &["box.side", "1 or -1"],
        ),
        (
            format!("{LATERAL}\n{edge}side = 1\ndistance_m = 1e9\n"),
            &["box.distance_m", "-100 to 100"],
        ),
        (
            format!("{LATERAL}\n{edge}side = 1\n"),
            &["box.beyond_feet_m", "distance_m"],
        ),
        (
            format!("{LATERAL}\n[weights]\ngoal = 1e300\n"),
            &["weights.goal", "1e300"],
        ),
    ]
}

#[test]
fn a_task_file_names_key_value_and_what_is_allowed() {
    let folder = folder("task");
    for (text, words) in impossible_tasks() {
        assert_ne!(text, LATERAL);
        fs::write(folder.join("task.toml"), text).unwrap();
        for command in ["plan", "run", "envelope", "verdicts"] {
            refused(&folder, &[command, "task.toml"], words);
        }
    }
    refused(
        &folder,
        &["plan", "a1/lateral", "--timing", "1e9,0.3"],
        &["--timing", "up to 5"],
    );
    refused(
        &folder,
        &[
            "envelope",
            "a1/lateral",
            "--samples",
            "18446744073709551615",
        ],
        &["--samples", "10000000"],
    );
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// A1's URDF with the first value of an attribute changed, behind the texts `after`.
fn robot(after: &[&str], attribute: &str, value: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.urdf");
    let urdf = fs::read_to_string(path).unwrap();
    let key = format!("{attribute}=\"");
    let behind =
        |at: usize, text: &str| at + urdf.get(at..).unwrap().find(text).unwrap() + text.len();
    let from = after
        .iter()
        .chain(&[key.as_str()])
        .fold(0, |at, text| behind(at, text));
    let (before, rest) = urdf.split_at(from);
    let (_, rest) = rest.split_once('"').unwrap();
    format!("{before}{value}\"{rest}")
}

#[test]
fn a_robot_that_cannot_be_is_refused() {
    let folder = folder("urdf");
    for (after, attribute, value, words) in [
        (&[][..], "effort", "-1", ["joint ", "effort", "-1"]),
        (&[][..], "effort", "0", ["joint ", "effort", "above 0"]),
        (&[][..], "velocity", "-1", ["joint ", "speed", "-1"]),
        (&[][..], "velocity", "0", ["joint ", "velocity", "above 0"]),
        (&[][..], "damping", "-1", ["joint ", "damping", "-1"]),
        (&[][..], "friction", "-1", ["joint ", "friction", "-1"]),
        (&[][..], "ixx", "-1", ["link `trunk`", "moments", "-1"]),
        (
            &["<link name=\"FL_foot\"", "<collision>"],
            "sphere radius",
            "-1",
            ["FL_foot", "radius", "-1"],
        ),
        (
            &["<link name=\"FL_foot\"", "<collision>"],
            "sphere radius",
            "nan",
            ["FL_foot", "radius", "nan"],
        ),
        (
            &["<link name=\"RR_foot\"", "<collision>"],
            "sphere radius",
            "9",
            ["foot's radius", "up to 0.4", "9"],
        ),
        (
            &["<link name=\"trunk\"", "<collision>"],
            "box size",
            "1 -1 1",
            ["trunk", "size", "1 -1 1"],
        ),
        (
            &["<link name=\"trunk\"", "<collision>"],
            "box size",
            "1 1",
            ["trunk", "size", "1 1"],
        ),
    ] {
        fs::write(folder.join("bad.urdf"), robot(after, attribute, value)).unwrap();
        let plan = ["plan", "a1/lateral", "--robot", "bad.urdf"];
        let [first, second, third] = words;
        refused(&folder, &plan, &["bad.urdf", first, second, third]);
        // What may be a placeholder, and shapes, are for others than planners.
        if value == "-1" && attribute != "sphere radius" {
            refused(&folder, &["import", "bad.urdf"], &["bad.urdf", value]);
        }
    }
}

/// Ten megabytes of anything are told in a few lines.
#[test]
fn long_values_are_cut_in_what_is_told() {
    let folder = folder("long");
    let long = "x".repeat(10_000_000);
    let lateral = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let files = [
        (
            "value.toml",
            lateral.replace("guess_s = 0.5", &format!("guess_s = \"{long}\"")),
        ),
        (
            "key.toml",
            lateral.replace("guess_s = 0.5", &format!("{long} = 0.5")),
        ),
        (
            "robot.toml",
            lateral.replace("\"a1\"", &format!("\"{long}\"")),
        ),
        ("lock.toml", format!("lock = [\"{long}\"]\n{lateral}")),
        (
            "foot.toml",
            lateral.replacen("\"FL\"", &format!("\"{long}\""), 1),
        ),
        ("p.json", format!("{{\"constants\": \"{long}\"}}")),
        ("key.json", format!("{{\"{long}\": 1}}")),
        (
            "r.urdf",
            format!("<robot name='r'><link name='{long}'/><link name='{long}'/></robot>"),
        ),
        (
            "w.urdf",
            format!(
                "<robot name='r'><link name='a'><inertial><mass value='{long}'/></inertial></link></robot>"
            ),
        ),
    ];
    for (name, text) in &files {
        fs::write(folder.join(name), text).unwrap();
        let arguments = match name.rsplit_once('.').unwrap().1 {
            "toml" => vec!["plan", name],
            "json" => vec!["plan", "--problem", name],
            _ => vec!["import", name],
        };
        for more in [None, Some("--json")] {
            let arguments: Vec<&str> = arguments.iter().copied().chain(more).collect();
            let said = refused(&folder, &arguments, &["…"]);
            assert!(said.len() < 8000, "{name}: {} bytes", said.len());
        }
    }
    // An argument, as long as the system lets it be.
    let word = "y".repeat(100_000);
    for arguments in [
        vec!["run", &word],
        vec!["run", "a1/lateral", "--plant", &word],
        vec!["run", "a1/lateral", "--seed", &word],
        vec![&word],
        vec!["plan", &word, "--json"],
        vec!["plan", "--reference", &word],
    ] {
        let said = refused(&folder, &arguments, &["…"]);
        assert!(said.len() < 8000, "{} bytes", said.len());
    }
}
