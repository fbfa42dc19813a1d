//! The nine whole-body reference problems, solved by the program and judged against IPOPT's costs.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::process::Command;

/// Cost that CasADi + IPOPT reach on the same problem, midpoint.
const IPOPT: [(&str, f64); 9] = [
    ("lateral", 2.170),
    ("a1/lateral-down", 2.463),
    ("spin", 9.883),
    ("diagonal", 15.192),
    ("a1/barrel-roll", 8.307),
    ("double_barrel", 10.247),
    ("a1/double-backflip", 18.243),
    ("forward", 10.716),
    ("barrel_box", 7.437),
];

fn plan(arguments: &[&str]) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["plan", "--stage", "whole-body", "--json"])
        .args(arguments)
        .output()
        .unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(report: &serde_json::Value, key: &str) -> f64 {
    report["whole_body"][key].as_f64().unwrap()
}

#[test]
fn all_nine_reach_the_reference_cost_without_violation() {
    for (task, cost) in IPOPT {
        let report = plan(&["--reference", task]);
        assert_eq!(report["status"], "Solved", "{report}");
        assert!(number(&report, "cost") <= 1.001 * cost, "{report}");
        assert!(number(&report, "max_violation") <= 1e-6, "{report}");
        assert!(number(&report, "peak_torque_nm") <= 33.5 + 1e-6, "{report}");
    }
}

#[test]
fn a_solution_in_the_checkers_layout_meets_the_equations_of_motion() {
    let path = std::env::temp_dir().join(format!("saltus-wb-{}.json", std::process::id()));
    plan(&["--reference", "spin", "--solution", path.to_str().unwrap()]);
    let file: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(file["integ"], "mid");
    let sol = &file["sol"];
    let rows = |key: &str| sol[key].as_array().unwrap().len();
    assert_eq!(
        [rows("q"), rows("v"), rows("a"), rows("tau"), rows("F")],
        [90; 5]
    );
    // Yaw is the sixth coordinate of the checkers, and the one that spins: midpoint of the last interval.
    let yaw = sol["q"][89][5].as_f64().unwrap() + 0.005 * sol["v"][89][5].as_f64().unwrap();
    assert!((yaw - core::f64::consts::FRAC_PI_2).abs() <= 0.05 + 1e-6);
    // Over all feet and intervals the momentum that forces and gravity give is that of the motion.
    let x = |key: &str, k: usize, i: usize| sol[key][k][i].as_f64().unwrap();
    let lift: f64 = (0..90)
        .map(|k| {
            (0..4)
                .map(|f| sol["F"][k][f][2].as_f64().unwrap())
                .sum::<f64>()
        })
        .sum::<f64>()
        * 0.01
        / 12.453
        - 9.81 * 0.9;
    let fall = x("v", 89, 2) + 0.005 * x("a", 89, 2);
    // The legs rest in the end, so the trunk moves as the centre of mass does; the midpoint rule keeps the
    // momentum to second order.
    assert!((lift - fall).abs() < 3e-3, "{lift} {fall}");
}

#[test]
fn a_problem_file_is_planned_from_its_own_rigid_body() {
    let mut file: serde_json::Value =
        serde_json::from_str(include_str!("../data/a1-jumps.json")).unwrap();
    let mut spin = file["tasks"]["spin"].take();
    spin["angle"] = 1.2.into();
    file["tasks"] = serde_json::json!({ "mine": spin });
    file["constants"]["TAU_MAX"] = 30.0.into();
    let path = std::env::temp_dir().join(format!("saltus-wb-problem-{}.json", std::process::id()));
    std::fs::write(&path, file.to_string()).unwrap();
    let report = plan(&["--problem", path.to_str().unwrap()]);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(report["status"], "Solved", "{report}");
    assert!(report["srb"]["cost"].is_number(), "{report}");
    assert!(number(&report, "peak_torque_nm") <= 30.0 + 1e-6, "{report}");
}
