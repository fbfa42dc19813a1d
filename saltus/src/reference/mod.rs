//! The reference problems: `a1-jumps.json` read into srb-opt's problem.

mod values;
pub(crate) mod whole_body;

use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use serde::de::IgnoredAny;
use srb_opt::{Edge, Exponential, Foot, Phase, Problem, Reference, Weights};
use std::collections::BTreeMap;

/// Feet of the reference robot.
pub(crate) const FEET: usize = 4;

/// The nine problems as shipped.
pub(crate) const SHIPPED: &str = include_str!("../../data/a1-jumps.json");

/// The file: numbers shared by all tasks, and the tasks. A key that is not known is refused: it may be one that is misspelt.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    constants: Constants,
    tasks: BTreeMap<String, Task>,
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE", deny_unknown_fields)]
struct Constants {
    m: f64,
    i_b: [[f64; 3]; 3],
    g: f64,
    l1: f64,
    hip: [[f64; 3]; FEET],
    side: [f64; FEET],
    feet0: [[f64; 3]; FEET],
    corners: [[f64; 3]; 8],
    z0: f64,
    mu: f64,
    fz_max: f64,
    reach_x: f64,
    reach_y: f64,
    reach_z: [f64; 2],
    t_lo: f64,
    t_hi: f64,
    ttot_lo: f64,
    clear: f64,
    eps_w: f64,
    eps_f: f64,
    eps_r: f64,
    eps_log: f64,
    edge_w: f64,
    tau_max: f64,
    qd_max: f64,
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
struct Task {
    phases: Vec<Vec<usize>>,
    #[serde(rename = "N")]
    n: Vec<usize>,
    #[serde(rename = "T0")]
    t0: Vec<f64>,
    goal: [f64; 3],
    axis: [f64; 3],
    angle: f64,
    bp: Option<Vec<f64>>,
    r#box: f64,
    edge: Option<(usize, f64, f64)>,
    ttot: f64,
    euler: Option<String>,
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
    /// Parses the JSON description.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let file: Self =
            serde_json::from_str(text).map_err(|error| format!("problem file: {error}"))?;
        file.constants.check()?;
        for (name, task) in &file.tasks {
            task.check()
                .map_err(|error| format!("task {name}: {error}"))?;
        }
        Ok(file)
    }

    /// The task's name in this file: the one asked for, or the only one there is.
    pub(crate) fn pick(&self, name: Option<&str>) -> Result<&str, String> {
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

    /// Number of contact phases of a task.
    pub(crate) fn phase_count(&self, name: &str) -> usize {
        self.tasks.get(name).map_or(0, |task| task.n.len())
    }

    /// The problem of a task.
    pub(crate) fn problem<const PHASES: usize>(
        &self,
        name: &str,
    ) -> Result<Problem<f64, FEET, PHASES>, String> {
        let c = &self.constants;
        let t = self
            .tasks
            .get(name)
            .ok_or_else(|| format!("no task `{name}`"))?;
        let count = t.n.len();
        if count > PHASES {
            return Err(format!(
                "task {name}: N: at most {PHASES} phases, not {count}"
            ));
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
            phase.contacts = core::array::from_fn(|foot| t.phases[i].contains(&foot));
            phase.intervals = t.n[i];
            phase.duration_guess = t.t0[i];
            phase.reference_angle = t.bp.as_ref().map_or(0.0, |bp| bp[i]);
        }
        let edge = match (t.r#box, t.edge) {
            (0.0, _) => None,
            (drop, Some((axis, sign, distance))) => Some(Edge {
                drop,
                axis,
                sign,
                distance,
                width: c.edge_w,
            }),
            (_, None) => return Err(format!("task {name}: a box needs an edge")),
        };
        let start_w = Vector3::new(0.0, 0.0, c.z0);
        let foot = |i: usize| Foot {
            pos_wf: Vector3::from(c.feet0[i]),
            nominal_b: Vector3::from(c.hip[i]) + Vector3::new(0.0, c.side[i] * c.l1, 0.0),
        };
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
            edge,
            phases,
            phase_count: count,
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
        problem
            .check()
            .map_err(|error| format!("task {name}: {error}"))?;
        Ok(problem)
    }
}
