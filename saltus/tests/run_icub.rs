//! The humanoid's jumps, end to end.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use serde_json::Value;
use std::path::Path;
use std::process::Command;

fn run(task: &str, name: &str, more: &[&str]) -> (Value, bool) {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&out);
    let result = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["run", task, "--json", "--out", out.to_str().unwrap()])
        .args(more)
        .output()
        .unwrap();
    let json = serde_json::from_slice(&result.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&result.stderr)));
    (json, result.status.success())
}

fn number(json: &Value, name: &str) -> f64 {
    json[name].as_f64().unwrap()
}

/// What issue 5 asks of a nominal run, and the verdict's keys of issue 19.
fn check(task: &str, name: &str) {
    let (json, good) = run(task, name, &[]);
    assert_eq!(json["on_target"], good, "{json}");
    crate::keys::are_all_there(&json);
    let verdict = &json["verdict"];
    let failures = verdict["failures"].as_array().unwrap();
    assert_eq!(failures.is_empty(), good, "{json}");
    // Whatever the budgets say, the jump is flown and stood as planned.
    for failure in failures {
        assert!(
            failure["name"].as_str().unwrap().starts_with("hardware."),
            "{json}"
        );
    }
    assert!(number(&verdict["flight"], "position_m") < 0.03, "{json}");
    assert!(number(&verdict["stand"], "height_m") < 0.05, "{json}");
    assert!(verdict["hardware"]["saturation_ms"]["landing"].is_number());
    assert_eq!(json["interface"], "torque");
    assert_eq!(json["plant"]["rotor"], 1.0);
    let gain = number(&json, "com_gain_m");
    assert!((0.035..=0.045).contains(&gain), "{json}");
    assert!(number(&json, "sole_clearance_m") >= 0.035, "{json}");
    assert_eq!(json["upright"], true);
    assert_eq!(json["qp"]["failures"], 0);
    let with = number(&json, "locked_rotation_deg");
    assert!(with < 1.5, "{json}");
    // The gain follows from the speed at the loss of contact, v² = 2 g h.
    let speed = number(&json, "takeoff_speed_m_s");
    assert!((gain - speed * speed / (2.0 * 9.81)).abs() < 5e-3, "{json}");

    let (json, _) = run(task, &format!("{name}-free"), &["--no-momentum"]);
    let without = number(&json, "locked_rotation_deg");
    assert!(without > 4.0 * with, "{with} {without}");
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn the_velocity_program_jumps_four_centimetres_and_stands() {
    check("icub/velocity", "icub-velocity");
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn the_torque_program_jumps_four_centimetres_and_stands() {
    check("icub/torque", "icub-torque");
}

/// The page opens offline, and carries the paper's figures and a second run for figure 6.
#[test]
#[ignore = "long: cargo xtask suites"]
fn the_report_has_the_figures_of_the_paper() {
    crate::keys::are_all_there(&run("icub/velocity", "icub-report", &[]).0);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("icub-report");
    assert!(crate::recording::agrees_with_csv(&folder) > 100);
    let path = folder.join("report.html");
    let page = std::fs::read_to_string(path).unwrap();
    let data = page.split("id=\"data\">").nth(1).unwrap();
    let data: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let data = &data["runs"][0];
    let titles: Vec<&str> = data["plots"]
        .as_array()
        .unwrap()
        .iter()
        .map(|plot| plot["title"].as_str().unwrap())
        .collect();
    for figure in [
        "Figure 1:",
        "Figures 2a, 3a:",
        "Figures 2c, 3c:",
        "Figures 2d",
        "Figure 6:",
    ] {
        assert!(titles.iter().any(|t| t.starts_with(figure)), "{figure}");
    }
    let pitch = data["plots"]
        .as_array()
        .unwrap()
        .iter()
        .find(|plot| plot["title"].as_str().unwrap().starts_with("Figure 6"))
        .unwrap();
    let spread = |k: usize| {
        let values = pitch["series"][k]["values"].as_array().unwrap();
        let numbers = values.iter().filter_map(Value::as_f64);
        let (low, high) = numbers.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    assert!(spread(1) > 2.0 * spread(0), "{} {}", spread(0), spread(1));
    let links = &data["frames"]["origins"][0];
    assert_eq!(links.as_array().unwrap().len(), 23);
    for outside in ["src=\"http", "href=\"http", "import(\"http"] {
        assert!(!page.contains(outside), "{outside}");
    }
}
