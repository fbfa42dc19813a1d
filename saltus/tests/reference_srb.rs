//! The nine reference problems, solved by the program and judged against IPOPT's costs.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::process::Command;

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

fn plan(arguments: &[&str]) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .arg("plan")
        .args(arguments)
        .output()
        .unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn all_nine_reach_the_reference_cost_without_violation() {
    for (task, cost) in IPOPT {
        let report = plan(&["--reference", task, "--stage", "srb", "--json"]);
        assert_eq!(report["status"], "Solved", "{report}");
        assert!(
            report["srb"]["cost"].as_f64().unwrap() <= 1.001 * cost,
            "{report}"
        );
        assert!(
            report["srb"]["max_violation"].as_f64().unwrap() <= 1e-6,
            "{report}"
        );
    }
}

#[test]
fn noisy_guesses_reach_the_same_cost() {
    for (task, cost) in IPOPT {
        for seed in ["1", "2", "3"] {
            let noise = ["--guess-noise", "0.1", "--seed", seed];
            let report = plan(&[&["--reference", task, "--json"], noise.as_slice()].concat());
            assert!(
                report["srb"]["cost"].as_f64().unwrap() <= 1.001 * cost,
                "{report}"
            );
            assert!(
                report["srb"]["max_violation"].as_f64().unwrap() <= 1e-6,
                "{report}"
            );
        }
    }
}

#[test]
fn a_quarter_less_friction_a_half_turn_and_a_phase_that_may_collapse_are_solved() {
    // Costs of IPOPT on the same three problems.
    let file: serde_json::Value =
        serde_json::from_str(include_str!("../data/a1-jumps.json")).unwrap();
    let (mut slippery, mut half_turn, mut far_roll) = (file.clone(), file.clone(), file);
    slippery["constants"]["MU"] = 0.4.into();
    half_turn["tasks"]["spin"]["angle"] = core::f64::consts::PI.into();
    far_roll["tasks"]["barrel"]["goal"] = serde_json::json!([0.0, -0.5, 0.0]);
    let cases = [
        (slippery, "forward", 6.9209, "0"),
        (half_turn, "spin", 63.4513, "0"),
        (far_roll, "barrel", 39.9361, "0.1"),
    ];
    for (file, task, cost, noise) in cases {
        let path = std::env::temp_dir().join(format!("saltus-{task}-{}.json", std::process::id()));
        std::fs::write(&path, file.to_string()).unwrap();
        let report = plan(&[
            "--problem",
            path.to_str().unwrap(),
            "--reference",
            task,
            "--json",
            "--guess-noise",
            noise,
        ]);
        std::fs::remove_file(&path).unwrap();
        assert_eq!(report["status"], "Solved", "{report}");
        assert!(
            report["srb"]["cost"].as_f64().unwrap() <= 1.001 * cost,
            "{report}"
        );
        assert!(
            report["srb"]["max_violation"].as_f64().unwrap() <= 1e-6,
            "{report}"
        );
    }
}

#[test]
fn a_problem_file_with_other_numbers_is_solved() {
    let mut file: serde_json::Value =
        serde_json::from_str(include_str!("../data/a1-jumps.json")).unwrap();
    let mut spin = file["tasks"]["spin"].take();
    spin["angle"] = 1.2.into();
    spin["goal"] = serde_json::json!([0.1, 0.1, 0.0]);
    file["tasks"] = serde_json::json!({ "mine": spin });
    file["constants"]["M"] = 14.0.into();
    let path = std::env::temp_dir().join(format!("saltus-problem-{}.json", std::process::id()));
    std::fs::write(&path, file.to_string()).unwrap();
    let report = plan(&["--problem", path.to_str().unwrap(), "--json"]);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(
        (report["task"].as_str(), report["status"].as_str()),
        (Some("mine"), Some("Solved"))
    );
    assert!(report["srb"]["max_violation"].as_f64().unwrap() <= 1e-6);
}
