//! The nine reference problems, and what CasADi with IPOPT finds.
#![allow(dead_code, reason = "every file that includes this uses its own part")]

use nalgebra::Vector3;
use srb_opt::onboard::{FEET, Jump, example};
use srb_opt::{Edge, Phase, Reference};

const ALL: [bool; FEET] = [true; FEET];
const REAR: [bool; FEET] = [false, false, true, true];
const RIGHT: [bool; FEET] = [false, true, false, true];

/// A task: legs of the second phase, goal, turn in degrees about an axis, edge `(drop, axis, sign, distance)`,
/// longest total duration, and IPOPT's cost.
pub(crate) struct Task {
    pub(crate) name: &'static str,
    second: Option<[bool; FEET]>,
    goal: [f64; 3],
    turn: (usize, f64),
    edge: Option<(f64, usize, f64, f64)>,
    longest: f64,
    pub(crate) cost: f64,
}

const fn task(
    name: &'static str,
    second: Option<[bool; FEET]>,
    goal: [f64; 3],
    turn: (usize, f64),
    edge: Option<(f64, usize, f64, f64)>,
    longest: f64,
    cost: f64,
) -> Task {
    Task {
        name,
        second,
        goal,
        turn,
        edge,
        longest,
        cost,
    }
}

pub(crate) const TASKS: [Task; 9] = [
    task(
        "lateral",
        None,
        [0.0, 0.3, 0.0],
        (2, 0.0),
        None,
        0.8,
        2.2332,
    ),
    task(
        "lateral_down",
        None,
        [0.0, 0.5, -0.3],
        (2, 0.0),
        Some((0.3, 1, 1.0, 0.18)),
        0.9,
        2.4552,
    ),
    task("spin", None, [0.0; 3], (2, 90.0), None, 0.9, 10.5365),
    task(
        "diagonal",
        Some(REAR),
        [0.4, -0.3, 0.0],
        (2, 45.0),
        None,
        1.2,
        7.7971,
    ),
    task(
        "barrel",
        Some(RIGHT),
        [0.0, -0.3, 0.0],
        (0, 360.0),
        None,
        1.2,
        40.6946,
    ),
    task(
        "double_barrel",
        Some(RIGHT),
        [0.0, -0.5, -0.8],
        (0, 720.0),
        Some((0.8, 1, -1.0, 0.18)),
        1.35,
        89.8907,
    ),
    task(
        "double_backflip",
        Some(REAR),
        [-0.7, 0.0, -2.0],
        (1, -720.0),
        Some((2.0, 0, -1.0, 0.23)),
        1.55,
        65.3745,
    ),
    task(
        "forward",
        Some(REAR),
        [0.6, 0.0, 0.0],
        (2, 0.0),
        None,
        1.2,
        5.4518,
    ),
    task(
        "barrel_box",
        Some(RIGHT),
        [0.0, -0.5, -0.4],
        (0, 360.0),
        Some((0.4, 1, -1.0, 0.18)),
        1.2,
        36.6729,
    ),
];

impl Task {
    /// The problem, with `scale` times as many intervals as stated.
    pub(crate) fn problem(&self, scale: f64) -> Jump<f64> {
        let mut jump = example::<f64>();
        let count = |intervals: f64| (intervals * scale) as usize;
        let empty = jump.phases[2];
        let phase = |contacts, intervals: f64, duration_guess| Phase {
            contacts,
            intervals: count(intervals),
            duration_guess,
            ..empty
        };
        let air = [false; FEET];
        match self.second {
            None => {
                jump.phases = [phase(ALL, 50.0, 0.5), phase(air, 30.0, 0.3), empty];
                jump.phase_count = 2;
            }
            Some(legs) => {
                jump.phases = [
                    phase(ALL, 50.0, 0.5),
                    phase(legs, 30.0, 0.3),
                    phase(air, 40.0, 0.4),
                ];
                jump.phase_count = 3;
            }
        }
        jump.goal_w = jump.start_w + Vector3::from(self.goal);
        jump.axis = Vector3::zeros();
        jump.axis[self.turn.0] = 1.0;
        jump.angle = self.turn.1.to_radians();
        if self.turn.1.abs() >= 360.0 {
            jump.reference = Reference::PerPhase;
            jump.phases[1].reference_angle = 60f64.to_radians() * self.turn.1.signum();
            jump.phases[2].reference_angle = jump.angle;
        }
        jump.edge = self.edge.map(|(drop, axis, sign, distance)| Edge {
            drop,
            axis,
            sign,
            distance,
            width: 0.03,
        });
        jump.max_total = self.longest;
        jump
    }
}
