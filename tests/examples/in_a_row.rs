//! Ten jumps in a row in the lab: `cargo run --release -p saltus-tests --example in_a_row -- [SEEDS] [FIRST] [TASK...] [--stored]`, and with MuJoCo
//! `cargo xtask mujoco run --release -p saltus-tests --features mujoco --example in_a_row -- [SEEDS] [FIRST] [TASK...] [--stored]`.
//!
//! A row for each of SEEDS (20) labs from seed FIRST (1) on: the same robot, motors, sensors and ground for ten jumps, the TASKs (lateral, spin-90,
//! diagonal, forward-60 and barrel-roll of A1) over and over. Each jump begins where the last one has ended, planned from where the robot knows its feet;
//! with `--stored`, or where that finds no plan, as it is stored for feet below the hips. Then how many robots fell, and how many jumps were on target.
#![allow(missing_docs, reason = "a program")]

use core::ops::ControlFlow;
use jump_lab::Sim;
use jump_lab::lab::{Disturbance, Lab};
use jump_lab::quadruped::execute::Trial;
use jump_lab::quadruped::{FOOT_COUNT, Planned, run_in_a_row};
use jump_planner::task::Task;
use jump_planner::{Options, plan};
use nalgebra::Vector3;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

/// Jumps of a row.
const JUMPS: usize = 10;
/// Tasks, where none are named.
const TASKS: [&str; 5] = [
    "a1/lateral",
    "a1/spin-90",
    "a1/diagonal",
    "a1/forward-60",
    "a1/barrel-roll",
];

/// A task with its plan.
fn planned(task: Task) -> Result<Planned, String> {
    let found = plan(&task, &Options::default(), |_, _| ControlFlow::Continue(()))?;
    if let Some(answer) = found.answer {
        let (name, status, why) = (task.name, answer.status, answer.because);
        return Err(format!("{name}: {status}: {why}"));
    }
    let robot = task.robot;
    Planned::open(&robot, &found.bytes, |_| Ok::<_, String>(task))
}

fn main() -> Result<(), String> {
    let mut words = std::env::args().skip(1);
    let mut number = |default: u64| match words.next() {
        None => Ok(default),
        Some(text) => text
            .parse::<u64>()
            .map_err(|error| format!("{text}: {error}: give SEEDS and FIRST as numbers")),
    };
    let (seeds, first) = (number(20)?, number(1)?);
    let mut names: Vec<String> = words.collect();
    let as_stored = names.iter().any(|name| name == "--stored");
    names.retain(|name| name != "--stored");
    if names.is_empty() {
        names = TASKS.map(str::to_owned).to_vec();
    }
    let sim = if cfg!(feature = "mujoco") {
        Sim::MUJOCO
    } else {
        Sim::Native
    };
    let found: Result<Vec<_>, String> = names
        .iter()
        .map(|name| planned(Task::load(name).map_err(|error| error.to_string())?))
        .collect();
    let plans = found?;
    let rows: Result<Vec<_>, String> = (first..first + seeds)
        .into_par_iter()
        .map(|seed| {
            let trial = Trial {
                disturbance: Disturbance::draw(Lab::A1, seed),
                seed,
                ..Trial::nominal(sim)
            };
            let mut next = |i: usize, feet_w: Option<&[Vector3<f64>; FOOT_COUNT]>| {
                let stored = &plans[i % plans.len()];
                let anew = feet_w.filter(|_| !as_stored).map(|feet_w| {
                    let task = stored.task.from_feet(feet_w);
                    task.and_then(planned)
                        .inspect_err(|why| eprintln!("{seed}, jump {i} as it is stored: {why}"))
                });
                Ok(Some(
                    anew.and_then(Result::ok).unwrap_or_else(|| stored.clone()),
                ))
            };
            let runs = run_in_a_row(&mut next, JUMPS, &trial)?;
            let judged = runs.iter().map(|(jump, run)| jump.judge(run));
            let end = runs.last().map(|(_, run)| (run.final_phase, run.fault));
            Ok((seed, judged.collect::<Vec<_>>(), end))
        })
        .collect();
    let (mut stood, mut on_target) = (0, 0);
    for (seed, judged, end) in rows? {
        let stands = judged.len() == JUMPS && judged.iter().all(|jump| jump.verdict.stands());
        let hit = judged
            .iter()
            .filter(|jump| jump.verdict.on_target())
            .count();
        let outcomes: Vec<&str> = judged.iter().map(|jump| jump.verdict.outcome()).collect();
        let end = if stands {
            "stands".to_owned()
        } else {
            format!("NO: {end:?}")
        };
        println!("{seed:6}  {hit:2}  {}  {end}", outcomes.join(" "));
        stood += usize::from(stands);
        on_target += hit;
    }
    println!(
        "{}, seeds from {first}: {stood} of {seeds} rows of {JUMPS} jumps without a fall, {on_target} of {} jumps on target",
        sim.name(),
        seeds as usize * JUMPS
    );
    Ok(())
}
