//! Problem files that a closed form can see have no solution.

use crate::command::{folder, saltus};
use crate::values::problem;
use serde_json::{Value, json};

/// Problems that a closed form can see have no solution, and what it says of them.
fn proven_problems() -> [(&'static str, &'static str, Value, &'static [&'static str]); 4] {
    [
        (
            "inside the box",
            "lateral_down",
            json!({ "/tasks/lateral_down/goal": [0.0, 0.5, -0.6] }),
            &["at the goal the trunk is", "(goal bound)"],
        ),
        (
            "out of reach",
            "lateral_down",
            json!({ "/constants/Z0": 0.5 }),
            &["out of reach of its leg along z", "(reach bound)"],
        ),
        (
            "eight metres aside",
            "lateral_down",
            json!({ "/tasks/lateral_down/goal": [0.0, 8.0, -0.3] }),
            &["the goal is 8.000 m away", "(run-up bound)"],
        ),
        (
            "two seconds in the air",
            "spin",
            json!({ "/constants/T_LO": 2.0, "/constants/T_HI": 3.0, "/tasks/spin/ttot": 6.0 }),
            &["in the air for 2.000 s", "(hanging bound)"],
        ),
    ]
}

/// They are answered at once, with the reason, and nothing is left behind.
#[test]
fn problems_that_a_bound_refuses_are_told_why() {
    let folder = folder("proven");
    for (name, task, changes, words) in proven_problems() {
        problem(&folder.join("p.json"), |file| {
            for (pointer, value) in changes.as_object().unwrap() {
                *file.pointer_mut(pointer).unwrap() = value.clone();
            }
        });
        for stage in ["srb", "whole-body"] {
            let arguments = [
                "plan",
                "--problem",
                "p.json",
                "--reference",
                task,
                "--stage",
                stage,
                "--solution",
                "s.json",
                "--json",
            ];
            let output = saltus(&folder, &arguments);
            assert_eq!(output.status.code(), Some(2), "{name}");
            let told: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(told["status"], "Infeasible", "{name}");
            let because = told["because"].as_str().unwrap();
            assert!(
                words.iter().all(|w| because.contains(w)),
                "{name}: {because}"
            );
            assert_eq!(told["relaxations"].as_array().unwrap().len(), 1, "{name}");
            assert!(!folder.join("s.json").exists(), "{name}");
        }
    }
}
