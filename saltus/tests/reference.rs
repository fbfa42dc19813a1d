//! `saltus plan --reference` and `--problem`: guesses with noise, and a file of one's own.

use serde_json::{Value, json};
use std::fs;

/// Cost that CasADi + IPOPT reach on the same problem.
const IPOPT: [(&str, f64); 9] = [
    ("lateral", 2.2332),
    ("a1/lateral-down", 2.4552),
    ("spin", 10.5365),
    ("diagonal", 7.7971),
    ("a1/barrel-roll", 40.6946),
    ("double_barrel", 89.8907),
    ("double_backflip", 65.3745),
    ("forward", 5.4518),
    ("barrel_box", 36.6729),
];

fn plan(name: &str, arguments: &[&str]) -> Value {
    let folder = crate::command::folder(&format!("reference-{name}"));
    let mut file: Value =
        serde_json::from_str(include_str!("../../reference-problems/data/a1-jumps.json")).unwrap();
    file["tasks"]["barrel"]["goal"] = json!([0.0, -0.5, 0.0]);
    fs::write(folder.join("p.json"), file.to_string()).unwrap();
    let output = crate::command::saltus(&folder, &[&["plan", "--json"], arguments].concat());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Whose costs are IPOPT's, `stage` being the entry of the report.
fn assert_reaches(report: &Value, stage: &str, cost: f64) {
    let number = |key: &str| report[stage][key].as_f64().unwrap();
    assert_eq!(report["status"], "Solved", "{report}");
    assert!(number("cost") <= 1.001 * cost, "{report}");
    assert!(number("max_violation") <= 1e-6, "{report}");
}

#[test]
fn noisy_guesses_reach_the_same_cost() {
    for (task, cost) in IPOPT {
        for seed in ["1", "2", "3"] {
            let noise = ["--reference", task, "--guess-noise", "0.1", "--seed", seed];
            assert_reaches(&plan("noise", &noise), "srb", cost);
        }
    }
}

#[test]
fn a_phase_that_may_collapse_is_solved_from_a_noisy_guess() {
    let arguments = ["--problem", "p.json", "--reference", "barrel"];
    let noise = ["--guess-noise", "0.1"];
    let report = plan("far", &[arguments.as_slice(), &noise].concat());
    assert_reaches(&report, "srb", 39.9361);
}

#[test]
fn both_stages_are_told() {
    let report = plan("spin", &["--reference", "spin", "--stage", "whole-body"]);
    assert_reaches(&report, "whole_body", 9.883);
}
