//! The file of problems, read into srb-opt's problem.

use crate::json::named;
use core::fmt;
use nalgebra::{Matrix3, Vector3};
use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use srb_opt::{Edge, Exponential, Foot, Phase, Problem, Reference, Weights};
use std::collections::BTreeMap;

/// Feet of the reference robot.
pub const FEET: usize = 4;

/// The nine problems as shipped.
pub const SHIPPED: &str = include_str!("../data/a1-jumps.json");

/// The file: numbers shared by all tasks, and the tasks. A key that is not known is refused: it may be one that is misspelt.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    pub(crate) constants: Constants,
    #[serde(deserialize_with = "each_once")]
    pub(crate) tasks: BTreeMap<String, Task>,
}

/// The tasks; of two with one name nobody knows which is meant.
fn each_once<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, Task>, D::Error> {
    struct Tasks;

    impl<'de> Visitor<'de> for Tasks {
        type Value = BTreeMap<String, Task>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("tasks by their names")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut tasks = BTreeMap::new();
            while let Some(name) = map.next_key::<String>()? {
                if tasks.contains_key(&name) {
                    let what = format!("task `{name}` is there twice: rename one of them");
                    return Err(A::Error::custom(what));
                }
                tasks.insert(name, map.next_value()?);
            }
            Ok(tasks)
        }
    }

    from.deserialize_map(Tasks)
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE", deny_unknown_fields)]
pub(crate) struct Constants {
    pub(crate) m: f64,
    pub(crate) i_b: [[f64; 3]; 3],
    pub(crate) g: f64,
    pub(crate) l1: f64,
    pub(crate) hip: [[f64; 3]; FEET],
    pub(crate) side: [f64; FEET],
    pub(crate) feet0: [[f64; 3]; FEET],
    pub(crate) corners: [[f64; 3]; 8],
    pub(crate) z0: f64,
    pub(crate) mu: f64,
    pub(crate) fz_max: f64,
    pub(crate) reach_x: f64,
    pub(crate) reach_y: f64,
    pub(crate) reach_z: [f64; 2],
    pub(crate) t_lo: f64,
    pub(crate) t_hi: f64,
    pub(crate) ttot_lo: f64,
    pub(crate) clear: f64,
    pub(crate) eps_w: f64,
    pub(crate) eps_f: f64,
    pub(crate) eps_r: f64,
    pub(crate) eps_log: f64,
    pub(crate) edge_w: f64,
    pub(crate) tau_max: f64,
    pub(crate) qd_max: f64,
    // What the reference checkers read and the problem does not need.
    #[serde(rename = "TRUNK")]
    _trunk: Option<IgnoredAny>,
    #[serde(rename = "L2")]
    _l2: Option<IgnoredAny>,
    #[serde(rename = "L3")]
    _l3: Option<IgnoredAny>,
    #[serde(rename = "FOOT_Y")]
    _foot_y: Option<IgnoredAny>,
    #[serde(rename = "FL")]
    _fl: Option<IgnoredAny>,
    #[serde(rename = "FR")]
    _fr: Option<IgnoredAny>,
    #[serde(rename = "RL")]
    _rl: Option<IgnoredAny>,
    #[serde(rename = "RR")]
    _rr: Option<IgnoredAny>,
    #[serde(rename = "ALL")]
    _all: Option<IgnoredAny>,
    #[serde(rename = "REAR")]
    _rear: Option<IgnoredAny>,
    #[serde(rename = "RIGHT")]
    _right: Option<IgnoredAny>,
    #[serde(rename = "AIR")]
    _air: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Task {
    pub(crate) phases: Vec<Vec<usize>>,
    #[serde(rename = "N")]
    pub(crate) n: Vec<usize>,
    #[serde(rename = "T0")]
    pub(crate) t0: Vec<f64>,
    pub(crate) goal: [f64; 3],
    pub(crate) axis: [f64; 3],
    pub(crate) angle: f64,
    pub(crate) bp: Option<Vec<f64>>,
    pub(crate) r#box: f64,
    pub(crate) edge: Option<(usize, f64, f64)>,
    pub(crate) ttot: f64,
    pub(crate) euler: Option<String>,
}

/// Product names of the nine tasks, beside the names of the reference file.
const ALIASES: [(&str, &str); 9] = [
    ("a1/lateral", "lateral"),
    ("a1/lateral-down", "lateral_down"),
    ("a1/spin-90", "spin"),
    ("a1/diagonal", "diagonal"),
    ("a1/barrel-roll", "barrel"),
    ("a1/double-barrel-roll", "double_barrel"),
    ("a1/double-backflip", "double_backflip"),
    ("a1/forward-60", "forward"),
    ("a1/barrel-roll-box", "barrel_box"),
];

impl File {
    /// Parses the JSON description, and looks at every value.
    ///
    /// # Errors
    /// The key that is unknown, or whose value cannot be, and what it may be.
    pub fn parse(text: &str) -> Result<Self, String> {
        let file: Self = serde_json::from_str(text).map_err(|error| named(text, &error))?;
        if file.tasks.is_empty() {
            return Err("tasks: there must be one".to_owned());
        }
        file.constants.check()?;
        for (name, task) in &file.tasks {
            task.check(&file.constants)
                .map_err(|error| format!("task {name}: {error}"))?;
        }
        Ok(file)
    }

    /// The task's name in this file: the one asked for, or the only one there is.
    ///
    /// # Errors
    /// The tasks that there are.
    pub fn pick(&self, name: Option<&str>) -> Result<&str, String> {
        let known = || {
            self.tasks
                .keys()
                .map(String::as_str)
                .collect::<Vec<_>>()
                .join(", ")
        };
        match name {
            Some(name) => {
                let plain = ALIASES.iter().find(|(alias, _)| *alias == name);
                let name = plain.map_or(name, |(_, plain)| plain);
                self.tasks
                    .get_key_value(name)
                    .map(|(key, _)| key.as_str())
                    .ok_or_else(|| format!("no task `{name}`; there are {}", known()))
            }
            None => match self.tasks.keys().next() {
                Some(only) if self.tasks.len() == 1 => Ok(only),
                _ => Err(format!(
                    "name one of the tasks with --reference: {}",
                    known()
                )),
            },
        }
    }

    /// A task by its name in this file.
    pub(crate) fn task(&self, name: &str) -> Result<&Task, String> {
        self.tasks
            .get(name)
            .ok_or_else(|| format!("no task `{name}`"))
    }

    /// The single-rigid-body problem of a task of at most so many phases.
    ///
    /// # Errors
    /// No such task, more phases, or what `srb-opt` says of it.
    pub fn problem<const PHASES: usize>(
        &self,
        name: &str,
    ) -> Result<Problem<f64, FEET, PHASES>, String> {
        let (c, t) = (&self.constants, self.task(name)?);
        let start_w = Vector3::new(0.0, 0.0, c.z0);
        let foot = |i: usize| Foot {
            pos_wf: Vector3::from(c.feet0[i]),
            nominal_b: Vector3::from(c.hip[i]) + Vector3::new(0.0, c.side[i] * c.l1, 0.0),
        };
        let named = |error: String| format!("task {name}: {error}");
        let problem = Problem {
            mass: c.m,
            inertia_b: Matrix3::from_fn(|i, j| c.i_b[i][j]),
            gravity: c.g,
            feet: core::array::from_fn(foot),
            reach_lower: Vector3::new(-c.reach_x, -c.reach_y, c.reach_z[0]),
            reach_upper: Vector3::new(c.reach_x, c.reach_y, c.reach_z[1]),
            friction: c.mu,
            max_force: c.fz_max,
            corners: c.corners.map(Vector3::from),
            clearance: c.clear,
            edge: t.edge_of_box(c),
            phases: t.phases(c).map_err(named)?,
            phase_count: t.phase_count(),
            min_total: c.ttot_lo,
            max_total: t.ttot,
            start_w,
            goal_w: start_w + Vector3::from(t.goal),
            axis: Vector3::from(t.axis),
            angle: t.angle,
            min_final_trace: 2.5,
            reference: if t.bp.is_some() {
                Reference::PerPhase
            } else {
                Reference::Linear
            },
            weights: Weights {
                omega: c.eps_w,
                force: c.eps_f,
                rotation: c.eps_r,
            },
            exponential: Exponential::Taylor4,
            log_epsilon: c.eps_log,
        };
        problem.check().map_err(|error| named(error.to_string()))?;
        Ok(problem)
    }
}

impl Task {
    /// Number of contact phases.
    pub(crate) fn phase_count(&self) -> usize {
        self.n.len()
    }

    fn phases<const PHASES: usize>(
        &self,
        c: &Constants,
    ) -> Result<[Phase<f64, FEET>; PHASES], String> {
        let count = self.phase_count();
        if count > PHASES {
            return Err(format!("N: at most {PHASES} phases, not {count}"));
        }
        let empty = Phase {
            contacts: [false; FEET],
            intervals: 0,
            duration_guess: 0.0,
            min_duration: c.t_lo,
            max_duration: c.t_hi,
            reference_angle: 0.0,
        };
        let mut phases = [empty; PHASES];
        for (i, phase) in phases.iter_mut().enumerate().take(count) {
            phase.contacts = core::array::from_fn(|foot| self.phases[i].contains(&foot));
            phase.intervals = self.n[i];
            phase.duration_guess = self.t0[i];
            phase.reference_angle = self.bp.as_ref().map_or(0.0, |bp| bp[i]);
        }
        Ok(phases)
    }

    /// The edge of the box that the robot jumps off, if there is one.
    fn edge_of_box(&self, c: &Constants) -> Option<Edge<f64>> {
        let (axis, sign, distance) = self.edge.filter(|_| self.r#box != 0.0)?;
        Some(Edge {
            drop: self.r#box,
            axis,
            sign,
            distance,
            width: c.edge_w,
        })
    }
}
