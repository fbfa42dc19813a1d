//! Paper A: the jumps of A1.

use super::touchdown;
use super::{Row, Watch, direct, exponential, table};
use crate::Sim;
use crate::quadruped::Planned;
use crate::quadruped::execute::{Run, Trial};
use crate::quadruped::judge::Judged;
use core::ops::ControlFlow;
use jump_planner::NoPlan;
use jump_planner::answer::Answer;
use jump_planner::planned::{self, Planner};
use jump_planner::task::{SrbPlan, Task};
use jump_planner::whole_body::{self, Timing};
use ocp_solver::Status;
use std::collections::BTreeMap;

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

/// A jump with its plans.
pub(super) struct Plans {
    pub(super) srb: SrbPlan,
    pub(super) jump: Planned,
}

impl Plans {
    fn new(task: Task, planner: Planner) -> Result<Self, String> {
        let srb = task.solve()?;
        let reference = planner.plan(&task, &srb)?;
        let jump = Planned { task, reference };
        Ok(Self { srb, jump })
    }

    /// Flies it, and shows the flight.
    fn fly(&self, sim: Sim, kind: &str, watch: &mut impl Watch) -> Result<(Run, Judged), String> {
        let run = self.jump.run(Trial::nominal(sim))?;
        let judged = self.jump.judge(&run);
        let task = self.jump.task.name.replace('/', "-");
        let name = format!("{task}{kind}-{}", sim.name());
        watch.flown(&name, &self.jump, &run, &outcome(&judged));
        Ok((run, judged))
    }
}

/// Whole-body plans by task: the table, the figures and the simulators share them.
#[derive(Default)]
pub(super) struct AllPlans(BTreeMap<&'static str, Result<Plans, String>>);

impl AllPlans {
    pub(super) fn get(&mut self, name: &'static str) -> Result<&Plans, String> {
        let plans = self.0.entry(name);
        let plans = plans.or_insert_with(|| Plans::new(Task::load(name)?, Planner::WholeBody));
        plans.as_ref().map_err(Clone::clone)
    }
}

/// All rows.
pub(super) fn rows(sims: &[Sim], rows: &mut Vec<Row>, watch: &mut impl Watch) -> ControlFlow<()> {
    let mut plans = AllPlans::default();
    table::rows(&mut plans, rows, watch)?;
    for &sim in sims {
        watch.next("a1/spin-90 by two planners")?;
        rows.push(spin(&mut plans, sim, watch));
        for shown in SHOWN {
            watch.next(shown.0)?;
            show(shown, &mut plans, sim, rows, watch);
        }
    }
    for &sim in sims {
        watch.next("a1/forward-60 with manual timing")?;
        rows.push(manual(&mut plans, sim, watch));
    }
    watch.next("a1/forward-60 with other timings")?;
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
        Ok(plans) => exponential::row(&plans.jump.task, &plans.srb),
        Err(error) => exponential::failed(error),
    });
    watch.next("timings on the whole body directly")?;
    rows.push(direct::row());
    ControlFlow::Continue(())
}

/// A jump that a figure shows: its row, after what else is shown of it.
fn show(
    (name, item, theirs): (&'static str, &str, &str),
    plans: &mut AllPlans,
    sim: Sim,
    rows: &mut Vec<Row>,
    watch: &mut impl Watch,
) {
    let row = Row::new('A', item, theirs).simulated(sim);
    let flown = plans.get(name).and_then(|plans| {
        let (run, judged) = plans.fly(sim, "", watch)?;
        Ok((&plans.jump, run, judged))
    });
    let (jump, run, judged) = match flown {
        Ok(flown) => flown,
        Err(error) => return rows.push(row.failed(error)),
    };
    rows.extend(match name {
        "a1/double-backflip" => Some(touchdown::swing_legs(jump, &run, &judged, sim)),
        "a1/diagonal" => Some(touchdown::tracked(&jump.task, &run, sim)),
        "a1/barrel-roll-box" => Some(touchdown::recovered(&jump.task, &run, sim)),
        _ => None,
    });
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

/// Fig. 4: the spin by whole-body optimisation and by the baseline of V-A, an optimisation in joint space with the dynamics of the rigid
/// body and without torques, until touchdown, where the paper's figure ends.
fn spin(plans: &mut AllPlans, sim: Sim, watch: &mut impl Watch) -> Row {
    let row = Row::new(
        'A',
        "Fig. 4: 90° spin by whole-body optimisation and by optimisation in joint space on a single rigid body",
        "accurate; no significant yaw",
    )
    .simulated(sim);
    let whole = plans.get("a1/spin-90");
    let whole = whole.and_then(|plans| plans.fly(sim, "", watch));
    let kinematic = Task::load("a1/spin-90")
        .map_err(|error| error.to_string())
        .and_then(|task| Plans::new(task, Planner::RigidBody))
        .and_then(|plans| plans.fly(sim, "-kinematics", watch));
    match (whole, kinematic) {
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
fn manual(plans: &mut AllPlans, sim: Sim, watch: &mut impl Watch) -> Row {
    let row = Row::new(
        'A',
        "Fig. 7, 8a: forward 0.6 m, saturation with manual timing and with the optimal one",
        "rear legs saturated for 100 ms; none",
    )
    .simulated(sim);
    let mut by_hand = || -> Result<Judged, String> {
        let mut task = Task::load("a1/forward-60")?;
        task.fix_timing(&MANUAL)?;
        let plans = Plans::new(task, Planner::Kinematics)?;
        plans.fly(sim, "-manual", watch).map(|(_, judged)| judged)
    };
    let by_hand = by_hand();
    let optimal = plans.get("a1/forward-60");
    let optimal = optimal.and_then(|plans| plans.fly(sim, "", watch));
    match (by_hand, optimal) {
        (Ok(manual), Ok((_, optimal))) => {
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
        let srb = match planned::body(&task) {
            Ok(srb) => srb,
            Err(NoPlan::Answer(answer)) => {
                let is_proven = answer.status == "Infeasible";
                return Ok(Some((answer, is_proven)));
            }
            Err(NoPlan::Error(error)) => return Err(error),
        };
        let plan = whole_body::plan(&task, &srb, Timing::Given, |_| ControlFlow::Continue(()))?;
        Ok((plan.outcome.status != Status::Solved)
            .then(|| (Answer::no_whole_body_plan(&task, &plan), false)))
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
