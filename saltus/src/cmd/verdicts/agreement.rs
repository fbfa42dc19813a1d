//! How far both simulators are apart where a jump is decided: at the take-off, at the top of the flight and at the planned touchdown.
//!
//! Where they do not agree, the measure of what could be agreed on is told beside it: how far each simulator is from itself when its
//! integration steps are cut into four.

use super::Args;
use super::subject::Subject;
use crate::cmd::failure::Failure;
use crate::jump::plant::Sim;
use core::fmt::Write;
use rbd_core::Transform;
use serde_json::{Value, json};
use std::process::ExitCode;

/// Largest distance and angle between both simulators' bases: m, degrees.
const ALLOWED: [f64; 2] = [0.03, 3.0];
/// The grounds that are compared.
const GROUNDS: [&str; 2] = ["ground=hard", "ground=firm"];
/// Moments that are compared.
const MOMENTS: [&str; 3] = ["take-off", "middle of the flight", "touchdown"];

/// Into how many the steps are cut by which a simulator is compared with itself.
const FINER: u32 = 4;

/// One line: task, ground, and distance and angle at each moment; the same between each simulator and itself with smaller steps, where
/// the two do not agree.
struct Line {
    task: String,
    ground: &'static str,
    apart: [[f64; 2]; 3],
    own: Option<[[[f64; 2]; 3]; 2]>,
}

impl Line {
    fn agrees(&self) -> bool {
        let within = |x: &[f64; 2]| x[0] <= ALLOWED[0] && x[1] <= ALLOWED[1];
        self.apart.iter().all(within)
    }

    fn json(&self) -> Value {
        json!({
            "task": self.task,
            "ground": self.ground,
            "apart": self.apart,
            "agrees": self.agrees(),
            "from_itself": self.own.map(|[native, mujoco]| json!({ "native": native, "mujoco": mujoco })),
        })
    }
}

/// Prints the table. Exit code 0 when all agree, 2 when one does not.
pub(super) fn run(args: &Args, subjects: &[Subject]) -> Result<ExitCode, Failure> {
    let mut lines = Vec::new();
    for ground in GROUNDS {
        let plant = ground.parse()?;
        for subject in subjects {
            let fly = |sim, finer| subject.poses((sim, finer), plant);
            let (native, mujoco) = (fly(Sim::Native, 1)?, fly(Sim::Mujoco, 1)?);
            let mut line = Line {
                task: subject.name.clone(),
                ground,
                apart: apart(&native, &mujoco),
                own: None,
            };
            if !line.agrees() {
                line.own = Some([
                    apart(&native, &fly(Sim::Native, FINER)?),
                    apart(&mujoco, &fly(Sim::Mujoco, FINER)?),
                ]);
            }
            lines.push(line);
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

/// Distance and angle between two poses at each moment: m, degrees.
fn apart(a: &[Transform<f64>; 3], b: &[Transform<f64>; 3]) -> [[f64; 2]; 3] {
    core::array::from_fn(|i| {
        let (a, b) = (&a[i], &b[i]);
        let turn = so3::log(&(a.rotation.inverse() * b.rotation));
        [
            (a.translation - b.translation).norm(),
            turn.norm().to_degrees(),
        ]
    })
}

fn table(lines: &[Line]) -> String {
    let mut out = format!(
        "| task | ground | {}: m, deg | agree |\n|---|---|---|---|---|---|\n",
        MOMENTS.join(" | ")
    );
    for line in lines {
        let ground = line.ground.trim_start_matches("ground=");
        let mut row = |name: &str, apart: &[[f64; 2]; 3], last: &str| {
            let cells = apart.map(|[m, deg]| format!("{m:.3}, {deg:.1}"));
            let _ = writeln!(
                out,
                "| {name} | {ground} | {} | {last} |",
                cells.join(" | ")
            );
        };
        let yes = if line.agrees() { "yes" } else { "NO" };
        row(&format!("`{}`", line.task), &line.apart, yes);
        for (sim, own) in [Sim::Native, Sim::Mujoco]
            .iter()
            .zip(line.own.iter().flatten())
        {
            let name = format!("{}, steps cut into {FINER}", sim.name());
            row(&name, own, "from itself");
        }
    }
    out
}
