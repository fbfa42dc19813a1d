//! Paper A: the jumps of A1.

use super::touchdown;
use super::{Row, direct, exponential, write_report};
use crate::quadruped::report;
use core::ops::ControlFlow;
use jump_lab::Sim;
use jump_lab::quadruped::execute::{self, Run};
use jump_lab::quadruped::judge::Judged;
use jump_planner::answer::Answer;
use jump_planner::bounds::impossible;
use jump_planner::planned::Planner;
use jump_planner::reference::Reference;
use jump_planner::task::{SrbPlan, Task};
use jump_planner::whole_body::{self, Timing};
use ocp_solver::Status;
use std::collections::BTreeMap;
use std::path::Path;

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

/// Jumps that figures of the paper show: name, figures, what the paper says of them.
const SHOWN: [(&str, &str, &str); 5] = [
    (
        "a1/diagonal",
        "Fig. 9: diagonal jump",
        "tracked accurately, landing handles the impact",
    ),
    (
        "a1/barrel-roll-box",
        "Fig. 1: barrel roll off 0.4 m",
        "recovers position and orientation",
    ),
    (
        "a1/double-barrel-roll",
        "Fig. 5: double barrel roll off 0.8 m",
        "recovers under hard impact",
    ),
    (
        "a1/double-backflip",
        "Fig. 6: double backflip off 2 m",
        "recovers under hard impact",
    ),
    (
        "a1/forward-60",
        "Fig. 7, 8a: forward 0.6 m, optimal timing",
        "reaches the target",
    ),
];

/// Manual timing of Fig. 7 and 8, s, and one whose flight is too short.
const MANUAL: [f64; 3] = [0.5, 0.3, 0.55];
const SHORT: [f64; 3] = [0.5, 0.3, 0.1];

/// How timings are judged that no bound of ours decides.
const FREELY: &str =
    "holds when every phase is within 0.05 s; phases may last from 0.05 to 2 s, whatever their sum";
/// How times of planning are judged.
const LESS_TIME: &str = "holds when it takes less than the paper's, on another machine";

/// How near a duration is to a bound that it ends on, s.
const BOUND_TOLERANCE: f64 = 2e-3;
/// Shortest and longest phase that a robot knows of, s: five times the delay of sensors and motors, and long enough for anything.
const PHYSICAL: [f64; 2] = [0.05, 2.0];

/// A task with its plans.
struct Planned {
    task: Task,
    srb: SrbPlan,
    reference: Reference,
}

/// Whole-body plans by task: the table, the figures and the simulators share them.
#[derive(Default)]
struct Plans(BTreeMap<&'static str, Result<Planned, String>>);

impl Plans {
    fn get(&mut self, name: &'static str) -> Result<&Planned, String> {
        let planned = self.0.entry(name);
        let planned = planned.or_insert_with(|| plan(name, Planner::WholeBody));
        planned.as_ref().map_err(Clone::clone)
    }
}

fn plan(name: &str, planner: Planner) -> Result<Planned, String> {
    let task = Task::load(name)?;
    let srb = task.solve()?;
    let reference = planner.plan(&task, &srb)?;
    Ok(Planned {
        task,
        srb,
        reference,
    })
}

/// Runs a plan and leaves its report in the folder.
fn fly(planned: &Planned, sim: Sim, folder: &Path, kind: &str) -> Result<(Run, Judged), String> {
    let run = execute::run(&planned.task, &planned.reference, sim, |_, _| {})?;
    let judged = Judged::of(&planned.task, &planned.reference, &run);
    let table = [
        ("task", planned.task.name.clone(), None),
        ("result", outcome(&judged), None),
    ];
    let html = report::html(&planned.task, &planned.reference, &run, &table);
    let name = format!(
        "{}{kind}-{}",
        planned.task.name.replace('/', "-"),
        sim.name()
    );
    write_report(folder, &name, &html)?;
    Ok((run, judged))
}

/// All rows, as they come; `tell` hears what is next and may stop.
pub(crate) fn rows(
    sims: &[Sim],
    folder: &Path,
    rows: &mut Vec<Row>,
    mut tell: impl FnMut(&str) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut plans = Plans::default();
    for tabled in &TABLE {
        tell(tabled.0)?;
        rows.extend(table(tabled, &mut plans));
    }
    for &sim in sims {
        tell("a1/spin-90 by two planners")?;
        rows.push(spin(&mut plans, sim, folder));
        for (name, item, theirs) in SHOWN {
            tell(name)?;
            let row = Row::new('A', item, theirs).simulated(sim);
            let flown = plans
                .get(name)
                .and_then(|planned| fly(planned, sim, folder, "").map(|flown| (planned, flown)));
            match flown {
                Ok((planned, (run, judged))) => {
                    match name {
                        "a1/double-backflip" => {
                            rows.push(touchdown::swing_legs(
                                &planned.reference,
                                &run,
                                &judged,
                                sim,
                            ));
                        }
                        "a1/diagonal" => rows.push(touchdown::tracked(&planned.task, &run, sim)),
                        "a1/barrel-roll-box" => {
                            rows.push(touchdown::recovered(&planned.task, &run, sim));
                        }
                        _ => {}
                    }
                    rows.push(row.ours(
                        format!(
                            "joints within {:.1}° of the plan before contact; {}",
                            touchdown::tracking(&run),
                            outcome(&judged)
                        ),
                        judged.verdict.on_target(),
                        "holds when the verdict is on target: flight, stand and hardware",
                    ));
                }
                Err(error) => rows.push(row.failed(error)),
            }
        }
    }
    for &sim in sims {
        tell("a1/forward-60 with manual timing")?;
        rows.push(manual(&mut plans, sim, folder));
    }
    tell("a1/forward-60 with other timings")?;
    rows.push(timing(
        &MANUAL,
        "Fig. 8b, 8c: forward 0.6 m, manual timing 0.50, 0.30, 0.55 s",
        "rear legs saturated for 100 ms",
    ));
    rows.push(timing(
        &SHORT,
        "V-B: forward 0.6 m, flight of 0.10 s",
        "unsolvable",
    ));
    rows.push(match plans.get("a1/double-backflip") {
        Ok(Planned { task, srb, .. }) => exponential::row(task, srb),
        Err(error) => exponential::failed(error),
    });
    tell("timings on the whole body directly")?;
    rows.push(direct::row());
    ControlFlow::Continue(())
}

/// Table II: timings and times.
fn table(&(name, title, phases, [srb_s, whole_body_s]): &Tabled, plans: &mut Plans) -> Vec<Row> {
    let seconds = |phases: &[f64]| {
        let list: Vec<String> = phases.iter().map(|t| format!("{t:.2}")).collect();
        format!("{} s", list.join(", "))
    };
    let theirs: Vec<f64> = phases.iter().map(|hundredths| hundredths * 0.01).collect();
    let row =
        |what: &str, theirs: String| Row::new('A', format!("Table II, {title}: {what}"), theirs);
    let timings = row("timings", seconds(&theirs));
    let planned = match plans.get(name) {
        Ok(planned) => planned,
        Err(error) => return vec![timings.failed(error)],
    };
    let ours = &planned.reference.durations;
    let active = active_bounds(&planned.task, ours);
    let mut rows = vec![
        timings.ours(
            format!("{}; {}", seconds(ours), list_of(&active)),
            same(ours, &theirs) && active.is_empty(),
            "holds when every phase is within 0.05 s and none of our bounds decides it",
        ),
        freely_timed(
            row("timings within physical bounds", seconds(&theirs)),
            &planned.task,
            &theirs,
        ),
        row("time for the single rigid body", format!("{srb_s} s")).ours(
            format!(
                "{:.3} s, {} iterations",
                planned.srb.wall_ms * 1e-3,
                planned.srb.iterations
            ),
            planned.srb.wall_ms * 1e-3 < srb_s,
            LESS_TIME,
        ),
    ];
    if let Some(solved) = planned.reference.origin.solved() {
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

/// Fig. 4: the spin by whole-body optimisation and by the baseline of V-A, an optimisation in joint space with the dynamics of the rigid
/// body and without torques, until touchdown, where the paper's figure ends.
fn spin(plans: &mut Plans, sim: Sim, folder: &Path) -> Row {
    let row = Row::new(
        'A',
        "Fig. 4: 90° spin by whole-body optimisation and by optimisation in joint space on a single rigid body",
        "accurate; no significant yaw",
    )
    .simulated(sim);
    let whole_body = plans.get("a1/spin-90");
    let kinematics = plan("a1/spin-90", Planner::RigidBody);
    match (
        whole_body.and_then(|planned| fly(planned, sim, folder, "")),
        kinematics.and_then(|planned| fly(&planned, sim, folder, "-kinematics")),
    ) {
        (Ok((_, whole)), Ok((_, kinematic))) => {
            let missed = |judged: &Judged| {
                judged
                    .verdict
                    .flight
                    .map_or(f64::NAN, |flight| flight.rotation)
            };
            let (whole, kinematic) = (missed(&whole), missed(&kinematic));
            row.ours(
                format!("{whole:.1}° off at touchdown; {kinematic:.1}° off"),
                whole <= 10.0 && kinematic > 45.0,
                "holds when the one is within 10° and the other misses more than half of the turn: the paper's robot hardly turned",
            )
        }
        (Err(error), _) | (_, Err(error)) => row.failed(error),
    }
}

/// Fig. 7, 8a: the manual timing executed beside the optimal one. Its whole-body plan is not found, so its rigid body's plan is executed
/// with leg kinematics and inverse dynamics.
fn manual(plans: &mut Plans, sim: Sim, folder: &Path) -> Row {
    let row = Row::new(
        'A',
        "Fig. 7, 8a: forward 0.6 m, saturation with manual timing and with the optimal one",
        "rear legs saturated for 100 ms; none",
    )
    .simulated(sim);
    let by_hand = || -> Result<Judged, String> {
        let mut task = Task::load("a1/forward-60")?;
        task.fix_timing(&MANUAL)?;
        let srb = task.solve()?;
        let reference = Planner::Kinematics.plan(&task, &srb)?;
        let planned = Planned {
            task,
            srb,
            reference,
        };
        fly(&planned, sim, folder, "-manual").map(|(_, judged)| judged)
    };
    let optimal = plans
        .get("a1/forward-60")
        .and_then(|planned| fly(planned, sim, folder, "").map(|(_, judged)| judged));
    match (by_hand(), optimal) {
        (Ok(manual), Ok(optimal)) => {
            let spent = |judged: &Judged| 1e3 * judged.verdict.hardware.saturation[0];
            let (by_hand, best) = (spent(&manual), spent(&optimal));
            row.ours(
                format!(
                    "{by_hand:.0} ms by hand ({}); {best:.0} ms optimal ({})",
                    manual.verdict.first(),
                    optimal.verdict.first()
                ),
                by_hand >= 50.0 && best <= 10.0,
                "holds when the push-off saturates for 50 ms or more by hand, and 10 ms or less with the optimal timing",
            )
        }
        (Err(error), _) | (_, Err(error)) => row.failed(error),
    }
}

/// Fig. 8: durations by hand.
fn timing(durations: &[f64], item: &str, theirs: &str) -> Row {
    let row = Row::new('A', item, theirs);
    let answer = || -> Result<Option<(Answer, bool)>, String> {
        let mut task = Task::load("a1/forward-60")?;
        task.fix_timing(durations)?;
        if let Some(proof) = impossible(&task) {
            return Ok(Some((Answer::proven(proof), true)));
        }
        let srb = task.attempt(&ocp_solver::Settings::new(), |_| ControlFlow::Continue(()))?;
        if srb.status != Status::Solved {
            return Ok(Some((Answer::no_body_plan(&task, &srb), false)));
        }
        let plan = whole_body::plan(&task, &srb, Timing::Given, |_| ControlFlow::Continue(()))?;
        Ok((plan.outcome.status != Status::Solved)
            .then(|| (Answer::no_whole_body_plan(&task, &srb, &plan), false)))
    };
    match answer() {
        Ok(Some((answer, true))) => row.ours(
            answer.text().replace('\n', " "),
            true,
            "holds when it is proven that there is no plan inside the limits, fails when one is found",
        ),
        Ok(Some((answer, false))) => row.unjudged(
            answer.text().replace('\n', " "),
            "no plan was found, which proves nothing; it would hold with a proof, and fail with a plan",
        ),
        Ok(None) => row.ours(
            "planned inside all limits",
            false,
            "holds when it is proven that there is no plan inside the limits, fails when one is found",
        ),
        Err(error) => row.failed(error),
    }
}

pub(super) fn outcome(judged: &Judged) -> String {
    let verdict = &judged.verdict;
    let end = verdict.stand.map_or("no touchdown".to_owned(), |stand| {
        let up = if stand.upright { "upright" } else { "fallen" };
        format!(
            "{up}, feet {:.3} m and {:.1}° off the goal",
            stand.feet, stand.rotation
        )
    });
    format!("{end}; {}", verdict.first())
}
