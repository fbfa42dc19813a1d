//! Table II of paper A: timings, and times of planning.

use super::quadruped::{AllPlans, Plans};
use super::{Row, Watch};
use core::ops::ControlFlow;
use jump_planner::task::Task;

/// A task of table II: name, the paper's name, phases in hundredths of a second, seconds for both stages.
type Tabled = (&'static str, &'static str, &'static [f64], [f64; 2]);

/// Table II of the paper.
const TABLE: [Tabled; 7] = [
    (
        "a1/lateral",
        "lateral jump 30 cm",
        &[50.0, 28.0],
        [4.14, 31.0],
    ),
    (
        "a1/lateral-down",
        "lateral jump down",
        &[52.0, 35.0],
        [5.02, 32.0],
    ),
    (
        "a1/spin-90",
        "90° spinning jump",
        &[56.0, 31.0],
        [5.7, 39.0],
    ),
    (
        "a1/diagonal",
        "diagonal jump",
        &[54.0, 30.0, 33.0],
        [5.98, 226.0],
    ),
    (
        "a1/barrel-roll",
        "barrel roll",
        &[51.0, 32.0, 35.0],
        [6.61, 35.0],
    ),
    (
        "a1/double-barrel-roll",
        "double barrel roll",
        &[52.0, 34.0, 45.0],
        [11.7, 46.0],
    ),
    (
        "a1/double-backflip",
        "double backflip",
        &[50.0, 33.0, 69.0],
        [7.23, 89.0],
    ),
];

/// How timings are judged that no bound of ours decides.
const FREELY: &str =
    "holds when every phase is within 0.05 s; phases may last from 0.05 to 2 s, whatever their sum";
/// How times of planning are judged.
const LESS_TIME: &str = "holds when it takes less than the paper's, on another machine";

/// How near a duration is to a bound that it ends on, s.
const BOUND_TOLERANCE: f64 = 2e-3;
/// Shortest and longest phase that a robot knows of, s: five times the delay of sensors and motors, and long enough for anything.
const PHYSICAL: [f64; 2] = [0.05, 2.0];

/// All rows.
pub(super) fn rows(
    plans: &mut AllPlans,
    rows: &mut Vec<Row>,
    watch: &mut impl Watch,
) -> ControlFlow<()> {
    for tabled in &TABLE {
        watch.next(tabled.0)?;
        rows.extend(table(tabled, plans));
    }
    ControlFlow::Continue(())
}

/// Table II: timings and times.
fn table(&(name, title, phases, [srb_s, whole_body_s]): &Tabled, plans: &mut AllPlans) -> Vec<Row> {
    let seconds = |phases: &[f64]| {
        let list: Vec<String> = phases.iter().map(|t| format!("{t:.2}")).collect();
        format!("{} s", list.join(", "))
    };
    let theirs: Vec<f64> = phases.iter().map(|hundredths| hundredths * 0.01).collect();
    let row =
        |what: &str, theirs: String| Row::new('A', format!("Table II, {title}: {what}"), theirs);
    let timings = row("timings", seconds(&theirs));
    let Plans { srb, jump } = match plans.get(name) {
        Ok(plans) => plans,
        Err(error) => return vec![timings.failed(error)],
    };
    let ours = &jump.reference.durations;
    let active = active_bounds(&jump.task, ours);
    let mut rows = vec![
        timings.ours(
            format!("{}; {}", seconds(ours), list_of(&active)),
            same(ours, &theirs) && active.is_empty(),
            "holds when every phase is within 0.05 s and none of our bounds decides it",
        ),
        freely_timed(
            row("timings within physical bounds", seconds(&theirs)),
            &jump.task,
            &theirs,
        ),
        row("time for the single rigid body", format!("{srb_s} s")).ours(
            format!("{:.3} s, {} iterations", srb.wall_ms * 1e-3, srb.iterations),
            srb.wall_ms * 1e-3 < srb_s,
            LESS_TIME,
        ),
    ];
    if let Some(solved) = jump.reference.origin.solved() {
        rows.push(
            row("time for the whole body", format!("{whole_body_s} s")).ours(
                format!(
                    "{:.2} s, {} iterations",
                    solved.wall_ms * 1e-3,
                    solved.iterations
                ),
                solved.wall_ms * 1e-3 < whole_body_s,
                LESS_TIME,
            ),
        );
    }
    rows
}

/// Whether every phase is within 0.05 s of the paper's.
fn same(ours: &[f64], theirs: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 0.05;
    ours.len() == theirs.len() && ours.iter().zip(theirs).all(near)
}

/// Bounds on durations that a plan ends on: `total at most 0.80 s`.
fn active_bounds(task: &Task, durations: &[f64]) -> Vec<String> {
    let problem = &task.problem;
    let total: f64 = durations.iter().sum();
    let phases = problem.phases.iter().zip(durations).enumerate();
    let mut all: Vec<(String, f64, [f64; 2])> = phases
        .map(|(i, (phase, t))| {
            let bounds = [phase.min_duration, phase.max_duration];
            (format!("phase {}", i + 1), *t, bounds)
        })
        .collect();
    all.push((
        "total".to_owned(),
        total,
        [problem.min_total, problem.max_total],
    ));
    let mut active = Vec::new();
    for (name, value, [least, most]) in all {
        for (bound, word) in [(least, "least"), (most, "most")] {
            if (value - bound).abs() < BOUND_TOLERANCE {
                active.push(format!("{name} at {word} {bound:.2} s"));
            }
        }
    }
    active
}

fn list_of(active: &[String]) -> String {
    if active.is_empty() {
        "no bound is active".to_owned()
    } else {
        format!("active: {}", active.join(", "))
    }
}

/// The rigid body's plan where durations are bounded by what a robot needs and by nothing of the paper's table: a phase is longer than the
/// sensors' and motors' delays, and a jump ends.
fn freely_timed(row: Row, task: &Task, theirs: &[f64]) -> Row {
    let mut task = task.clone();
    let problem = &mut task.problem;
    for phase in &mut problem.phases[..problem.phase_count] {
        (phase.min_duration, phase.max_duration) = (PHYSICAL[0], PHYSICAL[1]);
    }
    (problem.min_total, problem.max_total) = (PHYSICAL[0], PHYSICAL[1] * theirs.len() as f64);
    let solved = task.solve().and_then(|plan| {
        let first = plan.stages.first().ok_or("a plan without stages")?;
        Ok(first.state.durations[..problem_phases(&task)].to_vec())
    });
    match solved {
        Ok(ours) => {
            let list: Vec<String> = ours.iter().map(|t| format!("{t:.2}")).collect();
            let active = list_of(&active_bounds(&task, &ours));
            row.ours(
                format!("{} s; {active}", list.join(", ")),
                same(&ours, theirs),
                FREELY,
            )
        }
        Err(error) => row.ours(format!("not found: {error}"), false, FREELY),
    }
}

fn problem_phases(task: &Task) -> usize {
    task.problem.phase_count
}
