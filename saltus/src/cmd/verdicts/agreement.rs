//! How far both simulators are apart where a jump is decided: at the take-off, at the top of the flight and at the planned touchdown.

use super::Args;
use super::subject::Subject;
use crate::cmd::failure::Failure;
use core::fmt::Write;
use jump_lab::Sim;
use serde_json::{Value, json};
use std::process::ExitCode;

/// Largest distance and angle between both simulators' bases: m, degrees.
const ALLOWED: [f64; 2] = [0.03, 3.0];
/// The grounds that are compared.
const GROUNDS: [&str; 2] = ["ground=hard", "ground=firm"];
/// Moments that are compared.
const MOMENTS: [&str; 3] = ["take-off", "middle of the flight", "touchdown"];

/// One line: task, ground, and distance and angle at each moment.
struct Line {
    task: String,
    ground: &'static str,
    apart: [[f64; 2]; 3],
}

impl Line {
    fn agrees(&self) -> bool {
        let within = |x: &[f64; 2]| x[0] <= ALLOWED[0] && x[1] <= ALLOWED[1];
        self.apart.iter().all(within)
    }

    fn json(&self) -> Value {
        json!({ "task": self.task, "ground": self.ground, "apart": self.apart, "agrees": self.agrees() })
    }
}

/// Prints the table. Exit code 0 when all agree, 2 when one does not.
pub(super) fn run(args: &Args, subjects: &[Subject]) -> Result<ExitCode, Failure> {
    let mut lines = Vec::new();
    for ground in GROUNDS {
        let plant = ground.parse()?;
        for subject in subjects {
            let poses = [Sim::Native, Sim::MUJOCO].map(|sim| subject.poses(sim, plant));
            let [native, mujoco] = poses;
            let (native, mujoco) = (native?, mujoco?);
            let apart = core::array::from_fn(|i| {
                let (a, b) = (&native[i], &mujoco[i]);
                let turn = so3::log(&(a.rotation.inverse() * b.rotation));
                [
                    (a.translation - b.translation).norm(),
                    turn.norm().to_degrees(),
                ]
            });
            lines.push(Line {
                task: subject.name.clone(),
                ground,
                apart,
            });
        }
    }
    if args.output.json {
        say!(
            "{}",
            json!({ "agreement": lines.iter().map(Line::json).collect::<Vec<_>>() })
        );
    } else if !args.output.quiet {
        put!("{}", table(&lines));
    }
    let all = lines.iter().all(Line::agrees);
    Ok(ExitCode::from(if all { 0 } else { 2 }))
}

fn table(lines: &[Line]) -> String {
    let mut out = format!(
        "| task | ground | {}: m, deg | agree |\n|---|---|---|---|---|---|\n",
        MOMENTS.join(" | ")
    );
    for line in lines {
        let cells = line.apart.map(|[m, deg]| format!("{m:.3}, {deg:.1}"));
        let yes = if line.agrees() { "yes" } else { "NO" };
        let ground = line.ground.trim_start_matches("ground=");
        let _ = writeln!(
            out,
            "| `{}` | {ground} | {} | {yes} |",
            line.task,
            cells.join(" | ")
        );
    }
    out
}
