//! What is judged: a task with its plan, run under a condition.

use super::gallery::{Gallery, Kept};
use crate::cmd::expected::Found;
use crate::cmd::failure::Failure;
use crate::report::{About, words};
use crate::{humanoid as told, quadruped, verdict};
use jump_lab::Sim;
use jump_lab::humanoid;
use jump_lab::lab::{Interface, Lab, PlantArgument};
use jump_lab::quadruped::execute::{self, Trial};
use jump_lab::quadruped::judge::Judged;
use jump_lab::verdict::{TARGET, Verdict};
use jump_planner::planned::{Planner, body};
use jump_planner::reference::Reference;
use jump_planner::task::Task;
use rbd_core::Transform;
use serde_json::{Value, json};

/// The nine tasks of A1, as the tables list them.
pub(super) const A1: [&str; 9] = [
    "a1/lateral",
    "a1/lateral-down",
    "a1/spin-90",
    "a1/diagonal",
    "a1/forward-60",
    "a1/barrel-roll",
    "a1/barrel-roll-box",
    "a1/double-barrel-roll",
    "a1/double-backflip",
];

/// How a run differs from the plan.
#[derive(Clone, Copy)]
pub(super) struct Condition {
    pub(super) plant: Option<PlantArgument>,
    pub(super) seed: u64,
    pub(super) interface: Interface,
}

impl Condition {
    pub(super) const NOMINAL: Self = Self {
        plant: None,
        seed: 0,
        interface: Interface::Torque,
    };
}

/// A task that was planned, or why not.
pub(super) struct Subject {
    pub(super) name: String,
    kind: Kind,
}

enum Kind {
    Quadruped(Box<Task>, Box<Reference>),
    Humanoid(humanoid::Task),
    NoPlan(String),
}

impl Subject {
    /// Reads a task and plans it; a task that has no plan is a subject too. Humanoid tasks may have variants:
    /// `icub/velocity+stiff`.
    pub(super) fn load(name: &str) -> Result<Self, String> {
        let kind = match humanoid::Task::variant(name) {
            Some(task) => Kind::Humanoid(task),
            None => planned(Task::load(name)?),
        };
        Ok(Self {
            name: name.to_owned(),
            kind,
        })
    }

    pub(super) fn is_humanoid(&self) -> bool {
        matches!(self.kind, Kind::Humanoid(_))
    }

    /// Runs it; a gallery keeps its report.
    pub(super) fn judge(
        &self,
        sim: Sim,
        condition: &Condition,
        gallery: Option<&Gallery>,
    ) -> Result<Cell, Failure> {
        let shown = gallery.is_some();
        let flown = match &self.kind {
            Kind::NoPlan(why) => Err(why.clone()),
            Kind::Quadruped(task, reference) => fly(task, reference, sim, condition, shown),
            Kind::Humanoid(task) => rise(task, sim, condition, shown),
        };
        let (verdict, pages) = flown.map_or_else(|why| (Err(why), None), |(v, p)| (Ok(v), p));
        let keep = |(gallery, pages): (&Gallery, Pages)| {
            gallery.keep(&self.name, sim, &pages.report, pages.strip)
        };
        Ok(Cell {
            task: self.name.clone(),
            sim,
            verdict,
            kept: gallery.zip(pages).map(keep).transpose()?,
        })
    }
}

impl Subject {
    /// Poses of a quadruped's base at the take-off, in the middle of the flight and at the planned touchdown.
    pub(super) fn poses(
        &self,
        sim: Sim,
        plant: PlantArgument,
    ) -> Result<[Transform<f64>; 3], String> {
        let Kind::Quadruped(task, reference) = &self.kind else {
            return Err(format!(
                "{}: only jumps of a quadruped that were planned are compared",
                self.name
            ));
        };
        let trial = Trial {
            disturbance: PlantArgument::plant(Some(&plant), Lab::A1, 0),
            ..Trial::nominal(sim)
        };
        let run = execute::run_watched(task, reference, trial, |_, _| {}, |_, _| {}, |_| {})?;
        let (takeoff, touchdown) = (reference.takeoff, reference.touchdown);
        let pose = |time: f64| {
            let sample = run.samples.iter().find(|s| s.time >= time);
            let sample = sample.ok_or_else(|| format!("{}: the run ended early", self.name))?;
            Ok::<_, String>(Transform::new(
                sample.orientation.to_rotation_matrix(),
                sample.position,
            ))
        };
        let [a, b, c] = [takeoff, 0.5 * (takeoff + touchdown), touchdown].map(pose);
        Ok([a?, b?, c?])
    }
}

fn planned(task: Task) -> Kind {
    let planned = body(&task).and_then(|srb| Planner::WholeBody.plan(&task, &srb));
    match planned {
        Ok(reference) => Kind::Quadruped(Box::new(task), Box::new(reference)),
        Err(why) => Kind::NoPlan(why.to_string()),
    }
}

fn fly(
    task: &Task,
    reference: &Reference,
    sim: Sim,
    condition: &Condition,
    shown: bool,
) -> Result<Flown, String> {
    let trial = Trial {
        disturbance: PlantArgument::plant(condition.plant.as_ref(), Lab::A1, condition.seed),
        seed: condition.seed,
        interface: condition.interface,
        ..Trial::nominal(sim)
    };
    let run = execute::run_watched(task, reference, trial, |_, _| {}, |_, _| {}, |_| {})?;
    let judged = Judged::of(task, reference, &run);
    if !shown {
        return Ok((judged.verdict, None));
    }
    let mut table = vec![("task", task.name.clone(), None)];
    table.extend(verdict::lines(&judged.verdict));
    let how = format!("{} simulator, interface {}", sim.name(), trial.interface);
    table.push(("simulated", how, None));
    let about = About {
        disturbance: &trial.disturbance,
        verdict: words(&judged.verdict),
        result: quadruped::json::json(&judged, task, None, reference, &run, &trial),
        table: &table,
    };
    let pages = Pages {
        report: quadruped::report::html(task, reference, &run, about)?,
        strip: quadruped::strip::svg(task, &run, &trial.disturbance, reference.takeoff),
    };
    Ok((judged.verdict, Some(pages)))
}

fn rise(
    task: &humanoid::Task,
    sim: Sim,
    condition: &Condition,
    shown: bool,
) -> Result<Flown, String> {
    if condition.interface != Interface::Torque {
        return Err("iCub's joints take torques".to_owned());
    }
    let plant = PlantArgument::plant(condition.plant.as_ref(), Lab::Icub, condition.seed);
    let run = humanoid::execute::run(task, sim, &plant, condition.seed, |_, _| {})?;
    let judged = humanoid::judge::Judged::of(task, &run);
    if !shown {
        return Ok((judged.verdict, None));
    }
    let from = (sim.name(), condition.seed);
    let about = About {
        disturbance: &plant,
        verdict: words(&judged.verdict),
        result: told::json::json(&judged, task, &run, from, &plant),
        table: &told::table::table(&judged, task, &run, sim.name(), &plant),
    };
    let pages = Pages {
        report: told::report::html(task, &run, None, about)?,
        strip: told::strip::svg(&run),
    };
    Ok((judged.verdict, Some(pages)))
}

/// What a gallery keeps of a run.
struct Pages {
    report: String,
    strip: String,
}

/// A run's verdict, with its pages where they are wanted.
type Flown = (Verdict, Option<Pages>);

/// One verdict of the table; an error where there was nothing to judge.
pub(super) struct Cell {
    pub(super) task: String,
    pub(super) sim: Sim,
    pub(super) verdict: Result<Verdict, String>,
    /// What a gallery has of it.
    pub(super) kept: Option<Kept>,
}

impl Cell {
    pub(super) fn on_target(&self) -> bool {
        self.outcome() == TARGET
    }

    /// What failed first, in a word.
    pub(super) fn outcome(&self) -> &str {
        self.verdict.as_ref().map_or("no_run", Verdict::outcome)
    }

    /// The same for people.
    pub(super) fn words(&self) -> String {
        match &self.verdict {
            Ok(verdict) => verdict.first(),
            Err(why) => format!("NO: {}", why.replace('\n', " ")),
        }
    }

    /// The same as a sentence.
    pub(super) fn sentence(&self) -> String {
        match &self.verdict {
            Ok(verdict) => verdict::sentence(verdict),
            Err(why) => format!("No run: {}", why.replace('\n', " ")),
        }
    }

    pub(super) fn found(&self) -> Found {
        Found {
            name: self.task.clone(),
            sim: self.sim.name().to_owned(),
            outcome: self.outcome().to_owned(),
            words: self.words(),
        }
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "task": self.task,
            "sim": self.sim.name(),
            "outcome": self.outcome(),
            "verdict": self.verdict.as_ref().ok().map(Verdict::json),
            "error": self.verdict.as_ref().err(),
        })
    }
}
