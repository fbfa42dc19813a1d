//! The bytes that `plan` writes are those that the audit reads, and those that the machine flies, in `saltus run` and in the firmware's
//! images (`tests/tests/plan_in_flash.rs` has the last step: from the file to the nodes in flash).

use crate::command::{folder, saltus};
use serde_json::Value;
use std::path::Path;

/// What the program says of a plan; it may find that a jump is not on target.
fn result(folder: &Path, arguments: &[&str]) -> Value {
    let output = saltus(folder, arguments);
    assert_ne!(output.stdout, b"", "{arguments:?}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Plans, audits, audits again, flies the file and flies the task: one checksum. Returns the file.
fn one_plan(task: &str) -> Vec<u8> {
    let folder = folder(&format!("one-plan-{}", task.replace('/', "-")));
    let planned = result(&folder, &["plan", task, "--json", "--out", "plan"]);
    let bytes = std::fs::read(folder.join("plan/plan.bin")).unwrap();
    // Where the container's own description says that its checksum stands.
    let written = u32::from_le_bytes(bytes[20..24].try_into().unwrap());
    let verified = result(&folder, &["verify", "plan/plan.bin", "--json"]);
    let stored = result(
        &folder,
        &["run", "plan/plan.bin", "--json", "--out", "stored"],
    );
    let fresh = result(&folder, &["run", task, "--json", "--out", "fresh"]);
    for (what, said) in [
        ("the audit of the plan", &planned["audit"]["crc32"]),
        ("its audit from the file", &verified["audit"]["crc32"]),
        ("the flight of the file", &stored["plan"]["crc32"]),
        ("the flight of the task", &fresh["plan"]["crc32"]),
    ] {
        assert_eq!(said.as_u64(), Some(u64::from(written)), "{task}: {what}");
    }
    bytes
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn what_is_planned_is_audited_and_flown() {
    one_plan("a1/lateral");
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn what_the_images_have_in_flash_is_what_is_planned_now() {
    let flash = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../firmware/probe/plans/a1-double-backflip.bin"
    );
    let bytes = one_plan("a1/double-backflip");
    assert!(
        std::fs::read(flash).unwrap() == bytes,
        "the plan of a1/double-backflip is another now: `cargo xtask flash-plan`"
    );
}

/// A jump that is not found: what `plan` answers, every command that would have executed it does.
#[test]
#[ignore = "long: cargo xtask suites"]
fn what_is_not_found_is_told_alike_by_all() {
    let folder = folder("one-answer");
    let task = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let far = task.replace("[0.0, 0.3, 0.0]", "[0.0, 0.8, 0.0]");
    std::fs::write(
        folder.join("t.toml"),
        format!("{far}\n[limits]\nforce_weights = 0.3\n"),
    )
    .unwrap();
    let planned = result(&folder, &["plan", "t.toml", "--json"]);
    assert_eq!(planned["status"], "NotFound", "{planned}");
    let because = planned["answer"]["because"].as_str().unwrap();
    for command in ["run", "envelope"] {
        let told = result(&folder, &[command, "t.toml", "--json"]);
        assert_eq!(told["status"], planned["status"], "{command}");
        assert_eq!(told["answer"], planned["answer"], "{command}");
    }
    let told = result(&folder, &["verdicts", "t.toml", "--json"]);
    let told = told["verdicts"][0]["error"].as_str().unwrap();
    assert!(told.starts_with(&format!("not found: {because}")), "{told}");
    assert!(!folder.join("out").exists());
}
