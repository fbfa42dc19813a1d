//! The whole-body problem of a task, along a solution of its single-rigid-body problem.

use crate::file::{Constants, FEET, File, Task};
use a1_model::{A1Reference, a1_reference::frame};
use jump_planner::track::Track;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use wb_opt::{
    BASE, Clearance, EulerOrder, Foot, Friction, Phase, Point, Pose, Problem, Robot, Weights,
};

/// Coordinates of the reference robot.
pub(crate) const N: usize = 18;

/// Length of an interval, s.
pub(crate) const DT: f64 = 0.01;
/// Landing configuration of a leg.
const LANDING: [f64; 3] = [0.0, 0.8957, -1.7914];
/// Intervals before touchdown over which the joints rest.
const LANDING_INTERVALS: usize = 5;
/// How far R of a solution, which is stored in decimals, may be from a rotation.
const ROTATION: f64 = 1e-3;
const KNEE_CLEARANCE: f64 = 0.02;
const SWING_HEIGHT: f64 = -0.01;
const DRIFT: f64 = 0.01;
/// The reference robot has no joint friction, so any value does.
const FRICTION_SMOOTHING: f64 = 1.0;
const GOAL_TOLERANCE: [f64; BASE] = [0.02, 0.02, 0.02, 0.05, 0.05, 0.05];
const WEIGHTS: Weights<f64> = Weights {
    position: 1.0,
    effort: 1e-4,
    goal: 10.0,
};

/// A solution of the single-rigid-body problem in the layout of the reference checkers.
#[derive(Deserialize)]
pub struct SrbMotion {
    sol: SrbArrays,
}

#[derive(Deserialize)]
struct SrbArrays {
    #[serde(rename = "T")]
    durations: Vec<f64>,
    p: Vec<[f64; 3]>,
    /// Body to world, column-major.
    #[serde(rename = "R")]
    rotations: Vec<[f64; 9]>,
    f: Vec<[f64; 3 * FEET]>,
}

/// The single-rigid-body solution that is shipped for one of the nine tasks.
#[must_use]
pub fn shipped(name: &str) -> Option<&'static str> {
    let text = match name {
        "lateral" => include_str!("../data/srb/lateral.json"),
        "lateral_down" => include_str!("../data/srb/lateral_down.json"),
        "spin" => include_str!("../data/srb/spin.json"),
        "diagonal" => include_str!("../data/srb/diagonal.json"),
        "barrel" => include_str!("../data/srb/barrel.json"),
        "double_barrel" => include_str!("../data/srb/double_barrel.json"),
        "double_backflip" => include_str!("../data/srb/double_backflip.json"),
        "forward" => include_str!("../data/srb/forward.json"),
        "barrel_box" => include_str!("../data/srb/barrel_box.json"),
        _ => return None,
    };
    Some(text)
}

impl SrbMotion {
    /// Parses a solution.
    ///
    /// # Errors
    /// What is missing or no number.
    pub fn parse(text: &str) -> Result<Self, String> {
        serde_json::from_str(text)
            .map_err(|error| format!("SRB solution: {}", crate::json::named(text, &error)))
    }

    /// The motion of the base, for phases of this many intervals.
    fn track(&self, intervals: &[usize], order: EulerOrder) -> Result<Track<[f64; BASE]>, String> {
        let sol = &self.sol;
        let total: usize = intervals.iter().sum();
        let fits = sol.durations.len() == intervals.len()
            && sol.p.len() == total + 1
            && sol.rotations.len() == total + 1
            && sol.f.len() == total;
        if !fits {
            return Err(format!(
                "the SRB solution must have {} durations, {} nodes and {total} forces",
                intervals.len(),
                total + 1
            ));
        }
        let turned = |r: &[f64; 9]| {
            let rotation = Matrix3::from_column_slice(r);
            (rotation.transpose() * rotation - Matrix3::identity()).amax() < ROTATION
        };
        if !sol.rotations.iter().all(turned) {
            return Err("R of the SRB solution: must be rotations".into());
        }
        let mut times = vec![0.0];
        let mut begin = 0.0;
        for (n, duration) in intervals.iter().zip(&sol.durations) {
            let named = crate::values::DURATION.check(*duration);
            named.map_err(|what| format!("T of the SRB solution: {what}"))?;
            times.extend((1..=*n).map(|i| begin + duration / *n as f64 * i as f64));
            begin += duration;
        }
        let rotations = sol.rotations.iter().map(|r| Matrix3::from_column_slice(r));
        let poses = sol.p.iter().map(|p| Vector3::from(*p)).zip(rotations);
        Ok(Track::in_angles(times, poses, order))
    }
}

/// What a whole-body problem borrows, and the guess that comes with it.
pub(crate) struct Data {
    robot: Robot<f64, N>,
    feet: [Foot<f64>; FEET],
    clearances: Vec<Clearance<f64>>,
    phases: Vec<Phase<f64, FEET>>,
    /// References of the intervals.
    reference: Vec<Pose<f64, N>>,
    /// References of the nodes.
    pub(crate) nodes: Vec<Pose<f64, N>>,
    /// Forces of the SRB solution, per interval.
    pub(crate) forces: Vec<[f64; 3 * FEET]>,
    edge: Option<srb_opt::Edge<f64>>,
    start: Pose<f64, N>,
    goal: Pose<f64, N>,
    friction: f64,
    /// Order of the base coordinates.
    pub(crate) order: EulerOrder,
}

impl Data {
    /// Durations of the phases, s.
    pub(crate) fn durations(&self) -> Vec<f64> {
        let seconds = |phase: &Phase<f64, FEET>| DT * phase.intervals as f64;
        self.phases.iter().map(seconds).collect()
    }

    /// The problem.
    pub(crate) fn problem(&self) -> Problem<'_, f64, N, FEET> {
        Problem {
            robot: self.robot,
            feet: self.feet,
            clearances: &self.clearances,
            apart: &[],
            swing_height: SWING_HEIGHT,
            swing_rise: 0.0,
            edge: self.edge,
            phases: &self.phases,
            reference: &self.reference,
            start: self.start,
            goal: self.goal,
            goal_tolerance: GOAL_TOLERANCE,
            least_force: 0.0,
            release: f64::INFINITY,
            max_force: f64::INFINITY,
            landing_intervals: LANDING_INTERVALS,
            friction_smoothing: FRICTION_SMOOTHING,
            friction: Friction::pyramid(self.friction),
            drift: DRIFT,
            weights: WEIGHTS,
        }
    }
}

/// A base in the order of the chain, with the legs at the landing configuration.
fn with_landing_legs(base: [f64; BASE]) -> Pose<f64, N> {
    Pose::level(core::array::from_fn(|i| match i.checked_sub(BASE) {
        None => base[i],
        Some(joint) => LANDING[joint % 3],
    }))
}

impl Task {
    pub(crate) fn order(&self) -> Result<EulerOrder, String> {
        match self.euler.as_deref() {
            None | Some("zyx") => Ok(EulerOrder::Zyx),
            Some("zxy") => Ok(EulerOrder::Zxy),
            Some(other) => Err(format!("euler: must be zyx or zxy, not `{other}`")),
        }
    }
}

/// Phases of whole intervals, as long as those of the solution within half an interval.
fn rounded(contacts: &[srb_opt::Phase<f64, FEET>], durations: &[f64]) -> Vec<Phase<f64, FEET>> {
    let phase = |(phase, duration): (&srb_opt::Phase<f64, FEET>, &f64)| Phase {
        contacts: phase.contacts,
        intervals: (duration / DT).round_ties_even().max(1.0) as usize,
        dt: DT,
        weight: 1.0,
    };
    contacts.iter().zip(durations).map(phase).collect()
}

/// When the nodes are on the clock of the solution, which is stretched phase by phase onto the intervals.
fn node_times(phases: &[Phase<f64, FEET>], durations: &[f64]) -> Vec<f64> {
    let mut times = vec![0.0];
    let mut begin = 0.0;
    for (phase, duration) in phases.iter().zip(durations) {
        let step = duration / phase.intervals as f64;
        times.extend((1..=phase.intervals).map(|i| begin + step * i as f64));
        begin += duration;
    }
    times
}

/// References of the intervals: the middles between nodes, and the goal in the end.
fn interval_references(nodes: &[Pose<f64, N>], goal: Pose<f64, N>) -> Vec<Pose<f64, N>> {
    let middle = |pair: &[Pose<f64, N>]| {
        Pose::level(core::array::from_fn(|i| {
            0.5 * (pair[0].q[i] + pair[1].q[i])
        }))
    };
    let mut references: Vec<_> = nodes.windows(2).map(middle).collect();
    if let Some(last) = references.last_mut() {
        *last = goal;
    }
    references
}

impl Constants {
    fn robot(&self, order: EulerOrder) -> Robot<f64, N> {
        let mut robot = Robot::on_euler_base(&A1Reference, order);
        for limit in robot.limits.iter_mut().skip(BASE) {
            (limit.effort, limit.speed) = (self.tau_max, self.qd_max);
        }
        robot
    }

    fn contacts(&self) -> [Foot<f64>; FEET] {
        let frames = [
            frame::FL_FOOT,
            frame::FR_FOOT,
            frame::RL_FOOT,
            frame::RR_FOOT,
        ];
        core::array::from_fn(|i| Foot {
            point: Robot::<f64, N>::point(&frames[i]),
            pos_wf: Vector3::from(self.feet0[i]),
            radius: 0.0,
        })
    }

    /// The trunk's corners and the knees.
    fn clearances(&self) -> Vec<Clearance<f64>> {
        let corner = |offset: &[f64; 3]| Clearance {
            point: Point {
                link: BASE - 1,
                offset_l: Vector3::from(*offset),
            },
            height: self.clear,
        };
        let knee = |leg: usize| Clearance {
            point: Point {
                link: BASE + 3 * leg + 2,
                offset_l: Vector3::zeros(),
            },
            height: KNEE_CLEARANCE,
        };
        let corners = self.corners.iter().map(corner);
        corners.chain((0..FEET).map(knee)).collect()
    }
}

impl File {
    /// The whole-body problem of a task.
    pub(crate) fn whole_body(&self, name: &str, srb: &SrbMotion) -> Result<Data, String> {
        let t = self.task(name)?;
        // Data that both stages share is checked by the rigid body's problem.
        let shared: srb_opt::Problem<f64, FEET, 12> = self.problem(name)?;
        let named = |error: String| format!("task {name}: {error}");
        let order = t.order().map_err(named)?;
        let track = srb.track(&t.n, order).map_err(named)?;
        let phases = rounded(shared.used_phases(), &srb.sol.durations);
        let times = node_times(&phases, &srb.sol.durations);
        let pose = |time: &f64| with_landing_legs(track.at(*time));
        let nodes: Vec<Pose<f64, N>> = times.iter().map(pose).collect();
        let force = |time: &f64| srb.sol.f[track.interval(*time)];
        let (p, turn) = (shared.goal_w, shared.axis * shared.angle);
        let filed = [p.x, p.y, p.z, turn.x, turn.y, turn.z];
        let goal = with_landing_legs(order.columns().map(|i| filed[i]));
        let s = shared.start_w;
        Ok(Data {
            robot: self.constants.robot(order),
            feet: self.constants.contacts(),
            clearances: self.constants.clearances(),
            phases,
            reference: interval_references(&nodes, goal),
            forces: times[..times.len() - 1].iter().map(force).collect(),
            nodes,
            edge: shared.edge,
            start: with_landing_legs([s.x, s.y, s.z, 0.0, 0.0, 0.0]),
            goal,
            friction: shared.friction,
            order,
        })
    }
}
