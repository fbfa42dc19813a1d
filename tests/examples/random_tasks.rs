//! How planning jumps that nobody chose ends: `cargo run --release -p saltus-tests --features bench --example random_tasks -- [TASKS] [SEED] [SECONDS] [ROBOT] [explain]`.
//!
//! A row a task: how it ended, in what time, what was asked. Then how many ended in a plan that passed its audit or in a proof.
#![allow(missing_docs, reason = "a program")]

use core::ops::ControlFlow;
use core::time::Duration;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use jump_planner::task::file::TaskFile;
use jump_planner::{Options, plan};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use saltus_tests::random_tasks::tasks;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// What a task asks for, in a line.
fn told(file: &TaskFile) -> String {
    let [x, y, z] = file.goal_m;
    let mut text = format!("{x:5.2} {y:5.2} {z:5.2} m");
    if let Some(turn) = file.turn {
        let about = ["x", "y", "z"][turn.axis.iter().position(|x| *x > 0.0).unwrap_or(0)];
        text += &format!(", {:4.0} deg about {about}", turn.angle_deg);
    }
    if file.phases.len() > 2 {
        text += &format!(", last {}", file.phases[1].feet.join(" "));
    }
    text + &format!(", friction {:.2}", file.limits.friction)
}

fn main() -> Result<(), String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u64| {
        words.get(i).map_or(Ok(default), |word| {
            word.parse()
                .map_err(|_| format!("`{word}` is no whole number"))
        })
    };
    let (count, seed, seconds) = (number(0, 200)?, number(1, 1)?, number(2, 5)?);
    let name = words.get(3).map_or("a1", String::as_str);
    let robot = match name {
        "a1" => Quadruped::a1(),
        path => Quadruped::load(Path::new(path), &[]),
    };
    let robot = robot.map_err(|error| error.to_string())?;
    let explained = words.get(4).is_some_and(|word| word == "explain");
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), random);
    let strategy = tasks(name);
    let options = Options {
        within: Some(Duration::from_secs(seconds)),
        ..Options::default()
    };
    let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
    for index in 0..count {
        let file = strategy
            .new_tree(&mut runner)
            .map_err(|reason| reason.to_string())?
            .current();
        let task = Task::from_file("random", &file, robot)
            .map_err(|error| format!("task {index}: {error}"))?;
        let clock = Instant::now();
        let found = plan(&task, &options, |_, _| ControlFlow::Continue(()))?;
        let (end, because) = match &found.answer {
            None => ("planned", String::new()),
            Some(answer) => (answer.status, answer.because.clone()),
        };
        *ends.entry(end).or_default() += 1;
        println!(
            "{index:4} {end:11} {:6.2} s  {}  {because}",
            clock.elapsed().as_secs_f64(),
            told(&file)
        );
        if explained {
            found
                .path
                .iter()
                .for_each(|solve| println!("       {solve}"));
        }
    }
    println!("{ends:?} of {count}, seed {seed}, within {seconds} s");
    Ok(())
}
