//! `saltus import` as a program: exit codes, messages, files, and what it refuses to overwrite.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn saltus(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command.arg("import").args(arguments).output().unwrap()
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn writes_a_crate_once() {
    let (urdf, out) = (models().join("a1.urdf"), scratch("a1"));
    let arguments = [
        urdf.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--licence",
        "BSD-3-Clause",
        "--lock",
        "FL_hip_joint=0.1",
        "RR_hip_joint=-0.1",
        "--json",
    ];
    let first = saltus(&arguments);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let said: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!(said["joints"].as_array().unwrap().len(), 10);
    assert_eq!(said["locked"]["RR_hip_joint"], -0.1);
    assert_eq!(
        said["limbs"],
        "1 * [RevoluteTilted, RevoluteZ], 2 * [RevoluteX, RevoluteY, RevoluteY], 1 * [RevoluteTilted, RevoluteZ]",
        "a hip locked at an angle inclines the thigh's axis"
    );
    let manifest = fs::read_to_string(out.join("Cargo.toml")).unwrap();
    assert!(manifest.contains("name = \"a1-model\"") && manifest.contains("BSD-3-Clause"));
    let tables = fs::read_to_string(out.join("src/tables.rs")).unwrap();
    assert!(tables.contains(said["sha256"].as_str().unwrap()));
    assert!(tables.contains("FL_hip_joint=0.1"));
    assert!(
        fs::read_to_string(out.join("src/lib.rs"))
            .unwrap()
            .contains("#![no_std]")
    );
    assert!(
        fs::read_to_string(out.join("README.md"))
            .unwrap()
            .contains("a1.urdf")
    );

    fs::write(out.join("src/tables.rs"), "mine").unwrap();
    let second = saltus(&arguments);
    assert_eq!(second.status.code(), Some(2));
    assert!(text(&second.stderr).contains("not empty"));
    assert_eq!(
        fs::read_to_string(out.join("src/tables.rs")).unwrap(),
        "mine"
    );
}

#[test]
fn bad_input_ends_with_two_and_says_what_to_do() {
    let a1 = models().join("a1.urdf");
    let a1 = a1.to_str().unwrap();
    for (arguments, words) in [
        (&[a1, "--lock", "FL_knee=0"][..], "FL_calf_joint"),
        (&[a1, "--lock", "FL_hip_joint"], "joint=value"),
        (&[a1, "--lock", "FL_hip_joint=NaN"], "finite"),
        (&["no-such-file.urdf"], "no-such-file.urdf"),
        (
            &[a1, "--out", "never", "--rbd-core", "no-such-folder"],
            "neither a folder nor a version",
        ),
        (
            &[a1, "--out", "never", "--package", "a b"],
            "not a package name",
        ),
    ] {
        let output = saltus(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.contains(words), "{message}");
        assert!(!Path::new("never").exists());
    }
    let torn = scratch("torn.urdf");
    let good = fs::read_to_string(a1).unwrap();
    fs::write(&torn, &good[..good.len() / 2]).unwrap();
    let output = saltus(&[torn.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        said["error"].as_str().unwrap().contains("not XML"),
        "{said}"
    );
}

#[test]
fn a_check_alone_writes_nothing() {
    let urdf = models().join("icub_gazebo_v2_5.urdf");
    let output = saltus(&[urdf.to_str().unwrap(), "--base", "fixed"]);
    assert!(output.status.success());
    assert!(
        text(&output.stdout).contains("32 joints on a fixed base"),
        "{}",
        text(&output.stdout)
    );
    assert!(!text(&output.stdout).contains("wrote"));
}
