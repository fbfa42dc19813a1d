//! The main job, end to end: one command plans, simulates and reports a jump.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn saltus(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command.args(arguments).output().unwrap()
}

/// A folder of this test run, not there yet.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn run(task: &str, seed: &str, name: &str) -> (Value, PathBuf) {
    let out = folder(name);
    let result = saltus(&[
        "run",
        task,
        "--seed",
        seed,
        "--json",
        "--out",
        out.to_str().unwrap(),
    ]);
    let text = String::from_utf8(result.stdout).unwrap();
    let json: Value = serde_json::from_str(&text)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&result.stderr)));
    assert_eq!(
        result.status.success(),
        on_target(&json),
        "exit code and result disagree: {json}"
    );
    (json, out)
}

fn on_target(json: &Value) -> bool {
    json["on_target"] == true
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn a_jump_onto_a_box_ends_on_it() {
    let path = folder("onto.toml");
    let forward = include_str!("../../jump-planner/tasks/a1/forward-60.toml");
    let table = "[box]\ndrop_m = -0.1\naxis = \"x\"\nside = 1\ndistance_m = 0.3\n\n[total]";
    let onto = forward.replace("0.0, 0.0]", "0.0, 0.1]");
    std::fs::write(&path, onto.replace("[total]", table)).unwrap();
    let (json, out) = run(path.to_str().unwrap(), "0", "onto");
    assert!(on_target(&json), "{json}");
    assert_eq!(json["trunk_contact"], false);
    // A robot beside the box would be 0.1 m too low.
    assert!(json["verdict"]["stand"]["height_m"].as_f64().unwrap() < 0.05);
    assert!(out.join("report.html").exists());
}

#[test]
fn lateral_lands_upright_on_its_target_and_leaves_a_report() {
    let (json, out) = run("a1/lateral", "0", "lateral");
    assert!(on_target(&json), "{json}");
    assert_eq!(json["trunk_contact"], false);
    assert_eq!(json["torque_saturation_ms"], 0.0);
    assert!(json["peak_torque_nm"].as_f64().unwrap() <= 33.5);
    assert_eq!(json["qp"]["failures"], 0);
    // It jumped: the centre of mass rose well above standing, and there was a flight.
    assert!(json["apex_height_m"].as_f64().unwrap() > 0.33);
    let flight = json["plan"]["durations_s"][1].as_f64().unwrap();
    assert!(flight >= 0.25);

    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("id=\"data\">{\"version\":1,") && !report.contains("@DATA@"));
    for outside in ["src=\"http", "href=\"http", "@import"] {
        assert!(
            !report.contains(outside),
            "the report needs the network: {outside}"
        );
    }
    // Standing on four feet alone is longer than the flight.
    assert!(crate::recording::agrees_with_csv(&out) > 500);
    let log = std::fs::read_to_string(out.join("log.csv")).unwrap();
    let columns = log.lines().next().unwrap().split(',').count();
    assert!(log.lines().all(|line| line.split(',').count() == columns));
    assert!(!log.contains("NaN"));
    // In the log: airborne between take-off and landing, on all feet in the end.
    let header: Vec<&str> = log.lines().next().unwrap().split(',').collect();
    let normal: Vec<usize> = ["FL", "FR", "RL", "RR"]
        .map(|foot| {
            header
                .iter()
                .position(|h| *h == format!("f_{foot}_z"))
                .unwrap()
        })
        .to_vec();
    let loads = |line: &str| -> Vec<f64> {
        let cells: Vec<&str> = line.split(',').collect();
        normal.iter().map(|i| cells[*i].parse().unwrap()).collect()
    };
    let airborne = log
        .lines()
        .skip(1)
        .filter(|line| loads(line).iter().all(|f| *f == 0.0));
    assert!(airborne.count() > 200, "less than 0.2 s in the air");
    assert!(loads(log.lines().last().unwrap()).iter().all(|f| *f > 5.0));
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn the_same_seed_gives_the_same_run() {
    let (first, a) = run("a1/lateral", "3", "seed-3a");
    let (_, b) = run("a1/lateral", "3", "seed-3b");
    let read = |folder: &Path| std::fs::read(folder.join("log.csv")).unwrap();
    assert!(read(&a) == read(&b), "the same seed, another run");
    let (_, nominal) = run("a1/lateral", "0", "seed-0");
    assert!(read(&a) != read(&nominal), "the seed has no effect");
    // The controller saw an estimate, and a good one.
    let error = |name: &str| first["estimate"][name].as_f64().unwrap();
    let (place, turn) = (
        error("max_position_error_m"),
        error("max_rotation_error_deg"),
    );
    assert!(0.0 < place && place < 0.10, "{place} m");
    assert!(0.0 < turn && turn < 3.0, "{turn} deg");
}

#[test]
fn nothing_is_overwritten_and_unknown_tasks_are_named() {
    let out = folder("kept");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("report.html"), "mine").unwrap();
    let refused = saltus(&["run", "a1/lateral", "--out", out.to_str().unwrap()]);
    assert!(!refused.status.success());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("nothing is overwritten"));
    assert_eq!(
        std::fs::read_to_string(out.join("report.html")).unwrap(),
        "mine"
    );

    let unknown = saltus(&[
        "run",
        "a1/moonwalk",
        "--out",
        folder("moon").to_str().unwrap(),
    ]);
    assert!(!unknown.status.success());
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("a1/moonwalk"));
}

/// What fails leaves nothing behind that looks like a run.
#[test]
fn a_run_that_fails_leaves_no_folder() {
    let out = folder("failed");
    let path = out.to_str().unwrap();
    let mut failures = vec![["run", "a1/moonwalk", "--out", path, "--sim", "native"]];
    if cfg!(not(feature = "mujoco")) {
        failures.push(["run", "a1/lateral", "--out", path, "--sim", "mujoco"]);
    }
    for arguments in failures {
        let failed = saltus(&arguments);
        assert_eq!(failed.status.code(), Some(2));
        assert!(!out.exists(), "{arguments:?} left a folder");
        if arguments[5] == "mujoco" {
            let said = String::from_utf8_lossy(&failed.stderr).into_owned();
            assert!(said.contains("cargo xtask mujoco"), "{said}");
        }
    }
}

/// The judge agrees: `cargo xtask mujoco test -p saltus --features mujoco`.
#[cfg(feature = "mujoco")]
#[test]
#[ignore = "long: cargo xtask suites"]
fn lateral_lands_on_its_target_in_mujoco_too() {
    let out = folder("judged-0");
    let path = out.to_str().unwrap();
    let result = saltus(&[
        "run",
        "a1/lateral",
        "--sim",
        "mujoco",
        "--seed",
        "0",
        "--json",
        "--out",
        path,
    ]);
    let json: Value = serde_json::from_slice(&result.stdout).unwrap();
    assert_eq!(json["sim"], "mujoco");
    assert!(on_target(&json), "{json}");
    assert_eq!(json["trunk_contact"], false);
}

/// Every field that the program promises is there and has a value.
#[test]
#[ignore = "long: cargo xtask suites"]
fn the_result_has_every_field() {
    let (json, _) = run("a1/lateral", "0", "fields");
    for field in [
        "task",
        "sim",
        "interface",
        "landed",
        "upright_after_s",
        "final_position_error_m",
        "final_orientation_error_deg",
        "apex_height_m",
        "first_contact_s",
        "peak_torque_nm",
        "torque_saturation_ms",
        "peak_foot_force_n",
    ] {
        assert!(!json[field].is_null(), "{field} is missing in {json}");
    }
    for (group, fields) in [
        ("ticks", ["joint", "cartesian", "landing"]),
        ("qp", ["solves", "failures", "max_iterations"]),
    ] {
        for field in fields {
            assert!(json[group][field].is_u64(), "{group}.{field} in {json}");
        }
    }
    crate::keys::are_all_there(&json);
    assert_eq!(json["plant"]["ground"], 2.0);
    assert!(json["ticks"]["joint"].as_u64() > json["ticks"]["cartesian"].as_u64());
}
