//! iCub's jumps in the lab: `cargo run --release -p saltus-tests --example icub_lab -- [SEEDS] [FIRST] [TASK...]`, and with MuJoCo
//! `cargo xtask mujoco run --release -p saltus-tests --features mujoco --example icub_lab -- [SEEDS] [FIRST] [TASK...]`.
//!
//! A row for each TASK (icub/velocity and icub/torque; `icub/torque+2cm` jumps 2 cm): of SEEDS (100) labs from seed FIRST (1) on, in how many the robot
//! stands in the end, in how many it also gained its height within half a centimetre, how much it gained at least and on average, in how many the whole
//! verdict is yes, and what failed first in the others.
#![allow(missing_docs, reason = "a program")]

use jump_lab::Sim;
use jump_lab::humanoid::judge::{GAIN, Judged};
use jump_lab::humanoid::{Task, execute};
use jump_lab::lab::{Disturbance, Lab};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeMap;

/// The labs of a task.
fn labs(task: &Task, sim: Sim, seeds: core::ops::Range<u64>) -> Result<Vec<Judged>, String> {
    let one = |seed| {
        let disturbance = Disturbance::draw(Lab::Icub, seed);
        let run = execute::run(task, sim, &disturbance, seed, |_, _| {})?;
        Ok(Judged::of(task, &run))
    };
    seeds.into_par_iter().map(one).collect()
}

fn main() -> Result<(), String> {
    let mut words = std::env::args().skip(1);
    let mut number = |default: u64| match words.next() {
        None => Ok(default),
        Some(text) => text
            .parse::<u64>()
            .map_err(|error| format!("{text}: {error}: give SEEDS and FIRST as numbers")),
    };
    let (seeds, first) = (number(100)?, number(1)?);
    let mut names: Vec<String> = words.collect();
    if names.is_empty() {
        names = ["icub/velocity", "icub/torque"].map(str::to_owned).to_vec();
    }
    let sim = if cfg!(feature = "mujoco") {
        Sim::MUJOCO
    } else {
        Sim::Native
    };
    println!("{}, seeds from {first}", sim.name());
    for name in names {
        let task = Task::variant(&name).ok_or_else(|| format!("no humanoid task `{name}`"))?;
        let labs = labs(&task, sim, first..first + seeds)?;
        let count = |good: &dyn Fn(&Judged) -> bool| labs.iter().filter(|lab| good(lab)).count();
        let gains = labs.iter().map(|lab| lab.com_gain);
        let least = gains.clone().fold(f64::INFINITY, f64::min);
        let mean = gains.sum::<f64>() / labs.len().max(1) as f64;
        let mut first_failures: BTreeMap<&str, usize> = BTreeMap::new();
        for lab in labs.iter().filter(|lab| !lab.verdict.on_target()) {
            *first_failures.entry(lab.verdict.outcome()).or_default() += 1;
        }
        println!(
            "{name}: of {seeds} upright {}, and high enough {}; gained {:.1} mm at least, {:.1} on average; on target {}, else {first_failures:?}",
            count(&|lab| lab.upright),
            count(&|lab| lab.upright && lab.com_gain >= task.height - GAIN),
            1e3 * least,
            1e3 * mean,
            count(&|lab| lab.verdict.on_target()),
        );
    }
    Ok(())
}
