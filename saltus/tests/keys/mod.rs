//! The keys of a verdict in `saltus run --json`, which programs read: the same for every robot, none missing and none new.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

const PARTS: [(&str, &[&str]); 5] = [
    ("", &["flight", "stand", "hardware", "failures"]),
    ("/flight", &["position_m", "rotation_deg", "joints_deg"]),
    (
        "/stand",
        &[
            "feet_m",
            "heading_deg",
            "height_m",
            "rotation_deg",
            "upright",
        ],
    ),
    (
        "/hardware",
        &[
            "within",
            "exceeded",
            "saturation_ms",
            "stop_ms",
            "stop_torque_nm",
            "overspeed_ms",
            "peak_joint_speed",
            "ground_force_10ms_weights",
            "links_touched",
            "heat_share",
            "supply_power_w",
            "supply_limit_w",
            "supply_energy_j",
        ],
    ),
    (
        "/hardware/saturation_ms",
        &["push_off", "flight", "landing"],
    ),
];

/// What `--plant` takes, as `saltus verdicts --ranges` prints it.
fn plant_keys() -> BTreeSet<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["verdicts", "--ranges"])
        .output()
        .unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| row.split('`').next().unwrap().to_owned())
        .collect()
}

fn names(value: &Value) -> BTreeSet<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

/// A run that flew and stood has all of them, each of its kind.
pub(crate) fn are_all_there(json: &Value) {
    assert!(json["on_target"].is_boolean(), "{json}");
    assert!(json["interface"].is_string(), "{json}");
    assert_eq!(names(&json["plant"]), plant_keys());
    let verdict = &json["verdict"];
    for (part, wanted) in PARTS {
        let found = verdict.pointer(part).unwrap();
        let wanted = wanted.iter().map(|name| (*name).to_owned()).collect();
        assert_eq!(names(found), wanted, "verdict{part}");
        for (name, value) in found.as_object().unwrap() {
            let right = match name.as_str() {
                // A flight has its own measures, and its own time of saturation.
                "flight" if part.is_empty() => value.is_object(),
                "stand" | "hardware" | "saturation_ms" => value.is_object(),
                "upright" | "within" => value.is_boolean(),
                "failures" => value.is_array(),
                "exceeded" | "links_touched" => {
                    let list = value.as_array().unwrap();
                    list.iter().all(Value::is_string)
                }
                "supply_limit_w" | "heat_share" => value.is_null() || value.is_number(),
                _ => value.is_number(),
            };
            assert!(right, "verdict{part}/{name} is {value}");
        }
    }
}
