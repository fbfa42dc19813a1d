//! Runs are watched: one's report, several on one page, and folders that are no run are named with their remedy.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use crate::command::{folder, saltus};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// What the page holds as data.
fn data(page: &Path) -> Value {
    let text = fs::read_to_string(page).unwrap();
    let data = text.split("id=\"data\">").nth(1).unwrap();
    serde_json::from_str(data.split("</script>").next().unwrap()).unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8([output.stdout.as_slice(), &output.stderr].concat()).unwrap()
}

fn run(root: &Path, task: &str, out: &str, more: &[&str]) {
    let made = saltus(
        root,
        &[&["run", task, "--quiet", "--out", out], more].concat(),
    );
    assert_ne!(made.status.code(), Some(1), "{}", said(&made));
    assert!(
        root.join(out).join("report.html").exists(),
        "{}",
        said(&made)
    );
}

/// A copy of a run, with its report changed.
fn copy(root: &Path, name: &str, change: impl FnOnce(String) -> String) {
    fs::create_dir(root.join(name)).unwrap();
    let text = fs::read_to_string(root.join("one/report.html")).unwrap();
    fs::write(root.join(name).join("report.html"), change(text)).unwrap();
}

fn refused(root: &Path, folders: &[&str], words: &[&str]) {
    let output = saltus(root, &[&["watch", "--no-open"], folders].concat());
    let told = said(&output);
    assert_eq!(output.status.code(), Some(2), "{folders:?}: {told}");
    for word in words {
        assert!(
            told.contains(word),
            "{folders:?} does not say `{word}`: {told}"
        );
    }
    assert!(!root.join("out").exists(), "{folders:?} left a page");
}

/// Folders that are no run, or not whole, or do not go together: exit code 2, the culprit by name, the remedy, and no page.
fn mistakes(root: &Path) {
    refused(root, &["one", "one/../one"], &["one/../one is given twice"]);
    let of_other = |text: String| text.replace("\"kind\":\"quadruped\"", "\"kind\":\"humanoid\"");
    copy(root, "upright", of_other);
    let both = [
        "one is a quadruped",
        "upright a humanoid",
        "watch each alone",
    ];
    refused(root, &["one", "upright"], &both);
    copy(root, "cut", |text| {
        text[..text.len() / 2 + 300_000].to_owned()
    });
    refused(
        root,
        &["cut"],
        &["cut/report.html is cut off", "copy the folder again"],
    );
    refused(root, &["one", "cut"], &["cut/report.html is cut off"]);
    copy(root, "scratched", |text| {
        text.replace("\"takeoff\":", "\"takeof\":")
    });
    refused(
        root,
        &["scratched"],
        &[
            "scratched/report.html is damaged",
            "takeoff",
            "run the task again",
        ],
    );
    copy(root, "short", |text| {
        text.replacen("\"phase\":[\"Hold\",", "\"phase\":[", 1)
    });
    refused(
        root,
        &["short"],
        &["short/report.html is damaged", "lengths"],
    );
    copy(root, "newer", |text| {
        text.replace("{\"version\":1,", "{\"version\":2,")
    });
    refused(
        root,
        &["newer"],
        &["not written by this version", "run the task again"],
    );
    copy(root, "blank", |_| String::new());
    refused(root, &["blank"], &["not written by this version"]);
    fs::create_dir(root.join("binary")).unwrap();
    fs::write(root.join("binary/report.html"), [0xff, 0xfe]).unwrap();
    refused(root, &["binary"], &["is not text"]);
    for (file, what) in [
        ("plan.bin", "is a plan"),
        ("table.csv", "is a study"),
        ("reproduce.json", "open its index.html"),
        ("gallery.json", "give folders in it"),
        ("comparison.html", "is a comparison"),
    ] {
        let name = format!("of-{file}");
        fs::create_dir(root.join(&name)).unwrap();
        fs::write(root.join(&name).join(file), "").unwrap();
        refused(root, &["one", &name], &[name.as_str(), what]);
    }
}

#[test]
fn runs_are_watched_alone_and_side_by_side() {
    let root = folder("watch");
    run(&root, "a1/lateral", "one", &[]);
    run(
        &root,
        "a1/lateral",
        "other runs",
        &["--plant", "ground=soft", "--planner", "kinematics"],
    );
    mistakes(&root);

    // Alone: nothing is written, the report is the page.
    let alone = saltus(&root, &["watch", "one", "--no-open", "--json"]);
    let told: Value = serde_json::from_slice(&alone.stdout).unwrap();
    assert_eq!(alone.status.code(), Some(0));
    assert_eq!(told["page"], "one/report.html");
    assert_eq!(told["runs"][0]["on_target"], true);
    let words = told["runs"][0]["verdict"].as_str().unwrap();
    assert!(words.starts_with("On target:"), "{words}");
    assert!(!root.join("out").exists());

    // Side by side: one page that needs no other file, with both runs and what differs.
    let both = [
        "watch",
        "one",
        "other runs",
        "--no-open",
        "--out",
        "both pages",
    ];
    let output = saltus(&root, &both);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(
        said(&output).contains("/both%20pages/comparison.html"),
        "{}",
        said(&output)
    );
    let page = root.join("both pages/comparison.html");
    let text = fs::read_to_string(&page).unwrap();
    for outside in ["src=\"", "href=\"http", "@import", "@DATA@"] {
        assert!(!text.contains(outside), "{outside}");
    }
    let data = data(&page);
    let runs = data["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2);
    for (run, label) in runs.iter().zip(["one", "other runs"]) {
        assert_eq!(run["label"], label);
        assert!(run["takeoff"].as_f64().unwrap() > 0.2);
        // Every measure has the run's curve, and the ghost ends at the touchdown.
        assert!(run["measures"].as_array().unwrap().len() >= 9);
        let last = |times: &Value| times.as_array().unwrap().last().unwrap().as_f64().unwrap();
        assert!(last(&run["plan"]["t"]) < last(&run["frames"]["t"]) - 1.0);
    }
    let differences: Vec<&str> = data["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row[0].as_str().unwrap())
        .collect();
    for cause in ["planner", "plan, CRC-32", "plant: ground"] {
        assert!(differences.contains(&cause), "{differences:?}");
    }
    for same in ["task", "robot", "simulator", "seed", "plant: mass"] {
        assert!(!differences.contains(&same), "{differences:?}");
    }

    // Nothing is overwritten.
    let again = saltus(&root, &both);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("nothing is overwritten"));
    opens(&root);
}

/// Where there is a screen the address goes to the desktop's own program, which nobody waits for; where that is missing the address is told.
#[cfg(target_os = "linux")]
fn opens(root: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let programs = root.join("bin");
    fs::create_dir(&programs).unwrap();
    let watch = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
        command.args(["watch", "one"]).current_dir(root);
        command.env("PATH", &programs).env("DISPLAY", ":7");
        command.output().unwrap()
    };
    let missing = watch();
    assert_eq!(missing.status.code(), Some(0));
    assert!(said(&missing).contains("page: file:///"));
    let program = programs.join("xdg-open");
    let note = root.join("opened");
    let script = format!(
        "#!/bin/sh\necho \"$1\" > '{0}.part'\n/bin/mv '{0}.part' '{0}'\n",
        note.display()
    );
    fs::write(&program, script).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(watch().status.code(), Some(0));
    let end = std::time::Instant::now() + core::time::Duration::from_secs(30);
    while !note.exists() {
        assert!(std::time::Instant::now() < end, "nothing was opened");
        std::thread::sleep(core::time::Duration::from_millis(20));
    }
    let opened = fs::read_to_string(note).unwrap();
    assert!(
        opened.starts_with("file:///") && opened.trim_end().ends_with("/one/report.html"),
        "{opened}"
    );
}

#[cfg(not(target_os = "linux"))]
fn opens(_: &Path) {}

/// A gallery has a page with every task, a report of every run that can be watched, and the verdicts as `--json` tells them.
#[test]
fn a_gallery_shows_every_task() {
    let root = folder("gallery");
    let lateral = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let far = lateral.replace("goal_m = [0.0, 0.3, 0.0]", "goal_m = [0.0, 30.0, 0.0]");
    assert_ne!(far, lateral);
    fs::write(root.join("far <b>.toml"), far).unwrap();
    let tasks = ["verdicts", "a1/lateral", "far <b>.toml", "--sim", "native"];
    let output = saltus(&root, &[&tasks[..], &["--json", "--out", "all"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let all = root.join("all");
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let kept: Value = serde_json::from_slice(&fs::read(all.join("gallery.json")).unwrap()).unwrap();
    assert_eq!(told, kept);
    let page = fs::read_to_string(all.join("index.html")).unwrap();
    assert_eq!(page.matches("class=\"card\"").count(), 2);
    assert!(page.contains("1 of 2 runs are on target"));
    assert!(
        page.contains("<td class=\"good\"><a href=\"a1-lateral-native/report.html\">On target:")
    );
    assert!(page.contains("No run: ") && !page.contains("<b>"));
    for outside in ["src=", "href=\"http", "url(", "<script"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // The picture stands in the page and beside the report.
    let strip = fs::read_to_string(all.join("a1-lateral-native/strip.svg")).unwrap();
    assert!(page.contains(&strip));
    let watched = saltus(&root, &["watch", "all/a1-lateral-native", "--no-open"]);
    assert_eq!(watched.status.code(), Some(0), "{}", said(&watched));
    refused(&root, &["all"], &["all is a gallery", "give folders in it"]);
}

/// Humanoids go together as quadrupeds do, and a quadruped from a URDF is one.
#[test]
#[ignore = "long: cargo xtask suites"]
fn every_kind_of_robot_is_compared_with_its_like() {
    let root = folder("watch-kinds");
    run(&root, "icub/velocity", "velocity", &[]);
    run(&root, "icub/torque", "torque", &[]);
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.toml");
    run(&root, "a1/lateral", "built-in", &[]);
    run(
        &root,
        "a1/lateral",
        "imported",
        &["--robot", urdf.to_str().unwrap()],
    );
    for pair in [["velocity", "torque"], ["built-in", "imported"]] {
        let name = format!("{}-page", pair[0]);
        let arguments = ["watch", pair[0], pair[1], "--no-open", "--out", &name];
        let output = saltus(&root, &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        assert_eq!(
            data(&root.join(name).join("comparison.html"))["runs"]
                .as_array()
                .unwrap()
                .len(),
            2
        );
    }
    refused(&root, &["velocity", "built-in"], &["humanoid", "quadruped"]);
}
