//! Studies of many runs: shards, resumption, and what is refused.

use crate::command::saltus;
use crate::refused::refused;
use core::time::Duration;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn envelope(out: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command.args(["envelope", "a1/lateral", "--samples", "4", "--out"]);
    command.arg(out).args(more).output().unwrap()
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// The study in three parts at the same time, as the commands in `examples/cluster` run them.
fn on_a_cluster(out: &Path) {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cluster");
    let saltus = Path::new(env!("CARGO_BIN_EXE_saltus"));
    let job = std::fs::read_to_string(files.join("kubernetes.yaml")).unwrap();
    let mut lines = job.lines().map(|line| line.trim().trim_start_matches("- "));
    let line = lines.find(|line| line.starts_with("exec saltus ")).unwrap();
    let study = format!("a1/lateral --samples 4 --out {}", out.display());
    let paths = [
        saltus.parent().unwrap(),
        Path::new("/usr/bin"),
        Path::new("/bin"),
    ];
    let mut pod = Command::new("sh");
    pod.args(["-c", line])
        .env("PATH", std::env::join_paths(paths).unwrap());
    pod.env("STUDY", &study).env("SHARDS", "3");
    let mut parts = vec![pod.env("JOB_COMPLETION_INDEX", "2").spawn().unwrap()];
    for task in ["1", "2"] {
        let mut slurm = Command::new("bash");
        slurm.arg(files.join("slurm.sh")).args(study.split(' '));
        slurm.env("SALTUS", saltus).env("SLURM_ARRAY_TASK_ID", task);
        parts.push(slurm.env("SLURM_ARRAY_TASK_COUNT", "3").spawn().unwrap());
    }
    for mut part in parts {
        assert!(part.wait().unwrap().success());
    }
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn shards_and_a_stopped_study_make_the_same_table_as_one_run() {
    let (whole, parts) = (folder("whole"), folder("parts"));
    assert!(envelope(&whole, &[]).status.success());
    on_a_cluster(&parts);
    let table = read(&whole, "table.csv");
    assert_eq!(read(&parts, "table.csv"), table);
    assert!(table.contains("\nall,,,,,,4,"), "{table}");
    assert!(read(&parts, "picture.svg").ends_with("</svg>\n"));

    // Stopped in the middle of a line: the cut sample is run again, the others are not.
    let file = whole.join("shard-1-of-1.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let cut = &text[..text.len() - 9];
    std::fs::write(&file, cut).unwrap();
    assert!(envelope(&whole, &[]).status.success());
    assert_eq!(read(&whole, "table.csv"), table);
    let now = std::fs::read_to_string(&file).unwrap();
    assert!(now.starts_with(cut) && now.lines().count() == text.lines().count() + 1);

    // The folder says what it is, and another version does not mix with this one.
    let manifest = read(&whole, "manifest.json");
    let known: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(
        (&known["seed"], &known["plant"]),
        (&1.into(), &"lab".into())
    );
    let older = manifest.replace(env!("CARGO_PKG_VERSION"), "0.0.1");
    std::fs::write(whole.join("manifest.json"), older).unwrap();
    let refused = envelope(&whole, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("0.0.1"));
    std::fs::write(whole.join("manifest.json"), manifest).unwrap();

    // Another study does not mix with this one.
    let other = envelope(&whole, &["--seed", "2"]);
    assert!(!other.status.success());
    assert!(String::from_utf8_lossy(&other.stderr).contains("another study"));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), now);
}

/// A task file that has been changed since is another task, although its path is the same.
#[test]
fn a_study_of_a_task_that_was_changed_is_another_study() {
    let folder = crate::command::folder("changed");
    let task = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let write = |text: &str| std::fs::write(folder.join("t.toml"), text).unwrap();
    let study = "envelope t.toml --samples 1 --planner kinematics --json --out study";
    let study: Vec<&str> = study.split(' ').collect();
    write(task);
    assert!(saltus(&folder, &study).status.success());
    let file = "study/shard-1-of-1.csv";
    let known = read(&folder, file);

    write(&task.replace("[0.0, 0.3, 0.0]", "[0.0, 0.28, 0.0]"));
    let limit = Duration::from_secs(20);
    let part = [&study[..], &["--shard", "2/2"]].concat();
    for again in [&study, &part] {
        refused(limit, &folder, again, &["shard-1-of-1", "another study"]);
    }
    assert_eq!(std::fs::read_dir(folder.join("study")).unwrap().count(), 4);
    assert_eq!(read(&folder, file), known);

    // What only a reader sees does not count.
    write(&format!("# words\n{task}"));
    assert!(saltus(&folder, &study).status.success());
    let manifest: serde_json::Value =
        serde_json::from_str(&read(&folder, "study/manifest.json")).unwrap();
    let content = manifest["content"].as_str().unwrap();
    assert!(known.contains(&format!("# task t.toml content {content} ")));
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn the_study_without_each_measure_is_one_table() {
    let out = folder("ablation");
    let ablate = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
        command.args(["envelope", "a1/spin-90", "--samples", "1", "--json"]);
        // A robot that feels heavier than its model: a lighter one carries nothing.
        command.args(["--seed", "7"]).args(more);
        command.arg("--out").arg(&out).output().unwrap()
    };
    let first = ablate(&["--ablate"]);
    assert!(first.status.success());
    let report: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    let rows = report["ablation"].as_array().unwrap();
    let named: Vec<&str> = rows.iter().filter_map(|r| r["without"].as_str()).collect();
    assert_eq!(
        named,
        [
            "nothing",
            "weighing",
            "centring",
            "load",
            "drives",
            "margins",
            "lookahead",
            "posture",
            "regulator",
            "unloading",
            "inertia-shaping",
            "retraction"
        ]
    );
    for row in rows {
        assert!(row["done"] == 1 || row["no_plan"].is_string(), "{row}");
    }
    assert_eq!(rows[0]["done"], 1);

    // Each measure changes the run: the errors differ from those with all.
    let line = |name: &str| {
        let text = read(&out.join(format!("without-{name}")), "shard-1-of-1.csv");
        text.lines().nth(2).unwrap().to_owned()
    };
    for name in &named[1..] {
        assert_ne!(line(name), line("nothing"), "{name}");
    }

    // What is there goes on, as a study of its own too.
    let table = read(&out, "ablation.csv");
    assert!(ablate(&["--ablate"]).status.success());
    assert_eq!(read(&out, "ablation.csv"), table);
    let other = ablate(&[]);
    assert!(String::from_utf8_lossy(&other.stderr).contains("something else"));
}

/// Ctrl-C: the samples so far make a table, and the same command goes on.
#[cfg(unix)]
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_study_that_is_interrupted_keeps_what_it_has() {
    let out = folder("interrupted");
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command.args([
        "envelope",
        "a1/lateral",
        "--samples",
        "400",
        "--json",
        "--out",
    ]);
    let mut study = command
        .arg(&out)
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let file = out.join("shard-1-of-1.csv");
    let lines = || std::fs::read_to_string(&file).map_or(0, |text| text.lines().count());
    while lines() < 3 {
        assert!(study.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(core::time::Duration::from_millis(20));
    }
    let interrupt = Command::new("kill")
        .args(["-INT", &study.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    let output = study.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["complete"], false);
    let done = report["done"].as_u64().unwrap();
    assert_eq!(done as usize + 2, lines());
    assert!(read(&out, "table.csv").contains(&format!("\nall,,,,,,{done},")));
}
