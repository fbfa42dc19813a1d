//! From a task file to the problem that is solved for execution.
//!
//! The reference problems use Table I of paper A literally; a plan that is to be executed needs the robot that executes it:
//! its mass, the composite inertia of the crouch, and margins on friction and force.

mod attempt;
mod digest;
pub mod file;
mod guess;
mod stance;
mod values;

use self::file::{Across, LimitsTable, PhaseTable, TaskError, TaskFile, WeightsTable};
use self::values::{AXIS, BODY_FORCE, DURATION, LENGTH, TOTAL, TURN};
use super::FOOT_COUNT;
use crate::folding::Folding;
use crate::range::{Range, Unusable, require, within};
use crate::robot::{JOINTS, PLACES, Quadruped, RobotError, State};
use nalgebra::Vector3;
use ocp_solver::{Stage, Status};
use srb_opt::{Edge, Exponential, Phase, Problem, Reference, Weights};
use std::path::Path;

/// Most contact phases of a task.
pub const PHASES: usize = 6;
const NX: usize = 12 + PHASES;
const NU: usize = 12;
const NI: usize = srb_opt::row_capacity(FOOT_COUNT, PHASES);
/// Height of the centre of mass at the planned touchdown over its height at the start, as a share of the leg: legs reach
/// for the ground.
const LANDING_RISE: f64 = 0.1;
/// Shortest leg, as a share of its length.
const SHORTEST_LEG: f64 = 0.25;
/// Longest leg that the push-off may use, as a share of its length: the knees stay clear of their stops and of straight.
const LONGEST_LEG: f64 = 0.75;
/// Farthest that the push-off may lean a leg forwards, as a share of its length.
const FRONT_REACH: f64 = 0.3;
/// Farthest that the push-off may lean a leg sideways, as a share of its length.
const SIDE_REACH: f64 = 0.225;
/// Shortest flight, s: the legs must fold and take up the landing posture.
const SHORTEST_FLIGHT: f64 = 0.28;
/// Longer flight where the robot jumps off a box, s per metre: the feet must clear its edge.
const FLIGHT_PER_DROP: f64 = 0.5;
/// Box height from which falling alone takes long enough, m.
const LOW_BOX: f64 = 0.4;
/// Shortest and longest phase, s.
const DURATIONS: [f64; 2] = [0.1, 1.0];
/// Longest stance on all feet, s.
const LONGEST_FOUR_LEGS: f64 = 0.55;
/// Longest stance on fewer feet, s: it is unstable open loop.
const LONGEST_TWO_LEGS: f64 = 0.35;
/// Largest difference between the goal's height and the ground's, m.
const HEIGHT_TOLERANCE: f64 = 5e-3;
/// Width over which the edge of a box is smoothed, m.
const EDGE_WIDTH: f64 = 0.03;
/// Most intervals of a phase: beyond, only memory is used.
const MOST_INTERVALS: usize = 1000;

/// A node of the rigid body's problem.
pub type SrbStage = Stage<f64, srb_opt::State<f64, PHASES>, NX, NU, NI>;

/// A task as it is planned for execution.
#[derive(Clone)]
pub struct Task {
    /// Name of a built-in task, or path of the file.
    pub name: String,
    /// Who jumps.
    pub robot: Quadruped,
    /// The single-rigid-body problem.
    pub problem: Problem<f64, FOOT_COUNT, PHASES>,
    /// Standing at the start.
    pub start: State,
    /// Legs in flight.
    pub(crate) folding: Folding,
    /// Wanted displacement of the base, m.
    pub goal: Vector3<f64>,
    /// Wanted heading at the end, rad.
    pub heading: f64,
    /// Wanted rotation of the base at the end: the whole turn, of which only the heading is a posture to stand in.
    pub rot_goal: nalgebra::Rotation3<f64>,
    /// Height of the box that the robot starts on, m, with its edge.
    pub edge: Option<Edge<f64>>,
    /// The trunk may touch the ground in the landing.
    pub trunk_may_touch: bool,
    /// What the plan may use.
    pub limits: LimitsTable,
    /// Weights of the costs.
    pub weights: WeightsTable,
}

/// A single-rigid-body plan, or how far the solver came.
pub struct SrbPlan {
    /// Its nodes.
    pub stages: Vec<SrbStage>,
    /// How the solver ended.
    pub status: Status,
    /// Its iterations.
    pub iterations: u32,
    /// Time that it took, ms.
    pub wall_ms: f64,
    /// Cost of the plan.
    pub cost: f64,
    /// Largest violation of a row, in its own unit.
    pub max_violation: f64,
}

impl Task {
    /// The task of this name, or of the TOML file of this path, for its own robot.
    ///
    /// # Errors
    /// [`TaskError`] names file, line and key.
    pub fn load(name: &str) -> Result<Self, TaskError> {
        Self::load_for(name, None, &[])
    }

    /// The task of this name or path, for the robot of another URDF or profile where one is given.
    ///
    /// # Errors
    /// [`TaskError`] names file, line and key, or what is wrong with the robot.
    pub fn load_for(name: &str, urdf: Option<&Path>, locks: &[String]) -> Result<Self, TaskError> {
        let (file, folder) = TaskFile::load(name)?;
        let robot = match urdf {
            Some(path) => {
                Quadruped::load(path, locks).map_err(|error| robot_error(name, path, error))?
            }
            None => file.own_robot(name, &folder)?,
        };
        Self::from_file(name, &file, robot)
    }

    /// What a task file says, for this robot; `name` is what errors and plans call the task.
    ///
    /// # Errors
    /// [`TaskError`] names the key.
    pub fn from_file(name: &str, file: &TaskFile, robot: Quadruped) -> Result<Self, TaskError> {
        Self::of(name, file, robot).map_err(|(key, what)| TaskError::Value {
            task: name.to_owned(),
            key,
            what,
        })
    }

    /// Whether there is nothing to choose in the durations of the phases.
    #[must_use]
    pub fn has_given_durations(&self) -> bool {
        let phases = self.problem.used_phases().iter();
        phases
            .into_iter()
            .all(|phase| phase.min_duration >= phase.max_duration)
    }

    fn of(name: &str, file: &TaskFile, robot: Quadruped) -> Result<Self, Unusable> {
        values::limits(&file.limits)?;
        values::weights(&file.weights)?;
        let goal = Vector3::from(file.goal_m);
        goal.iter().try_for_each(|x| within(*x, LENGTH, "goal_m"))?;
        require(
            file.robot != "a1" || file.lock.is_empty(),
            "lock",
            &format!(
                "{:?}: a1 has no joints but its legs': leave it out, or give a URDF as robot",
                file.lock
            ),
        )?;
        let points_w = stance::points(file, &robot)?;
        let culprit = if file.feet_m.is_some() {
            "feet_m"
        } else {
            "robot"
        };
        let standing = stance::standing(&robot, &points_w);
        let (start, start_w) = standing.map_err(|what| (culprit.to_owned(), what))?;
        let com_b = start_w - start.base.translation;
        let leg = robot.leg_length;
        let (axis, angle) = turn(file)?;
        let folding = Folding::new((&robot, &start), (&axis, angle))
            .map_err(|what| (culprit.to_owned(), format!("to land, {what}")))?;
        let edge = edge(file, &points_w)?;
        let total = file.total;
        check_total(total.min_s, total.max_s)?;
        check_height(&goal, edge)?;
        let (phases, reference) = phases(file, &robot, edge)?;
        let limits = &file.limits;
        let problem = Problem {
            mass: robot.mass(),
            inertia_b: robot.locked_inertia(&start),
            gravity: 9.81,
            // The problem's body frame sits at the centre of mass, the robot's at the trunk's middle.
            feet: stance::feet(&robot, &points_w, &com_b),
            reach_lower: Vector3::new(-FRONT_REACH, -SIDE_REACH, -LONGEST_LEG) * leg,
            reach_upper: Vector3::new(FRONT_REACH, SIDE_REACH, -SHORTEST_LEG) * leg,
            friction: limits.friction * limits.friction_share,
            max_force: limits.force_weights.unwrap_or(BODY_FORCE) * robot.mass() * 9.81,
            corners: robot.corners.map(|corner| corner - com_b),
            clearance: limits.clearance_m,
            edge,
            phases,
            phase_count: file.phases.len(),
            min_total: total.min_s,
            max_total: total.max_s,
            start_w,
            goal_w: start_w + goal + Vector3::z() * (LANDING_RISE * leg),
            axis,
            angle,
            min_final_trace: 2.5,
            reference,
            weights: Weights {
                omega: file.weights.omega * folding.energy(),
                force: file.weights.force,
                rotation: file.weights.rotation,
            },
            exponential: Exponential::Taylor4,
            log_epsilon: 1e-6,
        };
        Ok(Self {
            name: name.to_owned(),
            robot,
            edge,
            problem,
            start,
            folding,
            goal,
            rot_goal: so3::exp(&(axis * angle)),
            heading: if axis.z.abs() > 0.5 {
                angle * axis.z
            } else {
                0.0
            },
            trunk_may_touch: file.trunk_may_touch,
            limits: *limits,
            weights: file.weights,
        })
    }

    /// Fixes the durations of the phases, s: the manual timing of paper A. The bounds of the task give way.
    ///
    /// # Errors
    /// As many durations as phases are needed, each possible.
    pub fn fix_timing(&mut self, durations: &[f64]) -> Result<(), TaskError> {
        let count = self.problem.phase_count;
        let refuse = |what: String| TaskError::Value {
            task: self.name.clone(),
            key: "--timing".to_owned(),
            what,
        };
        if durations.len() != count {
            return Err(refuse(format!(
                "the task has {count} phases, {} durations are given",
                durations.len()
            )));
        }
        DURATION.check_all(durations).map_err(&refuse)?;
        TOTAL
            .check(durations.iter().sum())
            .map_err(|what| refuse(format!("the sum {what}")))?;
        for (phase, duration) in self.problem.phases.iter_mut().zip(durations) {
            phase.duration_guess = *duration;
            (phase.min_duration, phase.max_duration) = (*duration, *duration);
        }
        let total: f64 = durations.iter().sum();
        // Wide: a bound on the sum that fixed durations just meet would only be in the solver's way.
        (self.problem.min_total, self.problem.max_total) = (0.5 * total, 2.0 * total);
        Ok(())
    }

    /// Joints with which the robot lands, rad: feet below and outside the hips.
    #[must_use]
    pub const fn landing_joints(&self) -> &[f64; JOINTS] {
        self.folding.landing()
    }

    /// Name of a phase: the feet on the ground.
    #[must_use]
    pub fn phase_name(&self, contacts: &[bool; FOOT_COUNT]) -> String {
        let on: Vec<&str> = PLACES
            .into_iter()
            .filter(|place| self.robot.leg(place).is_some_and(|leg| contacts[leg]))
            .collect();
        match on.len() {
            0 => "flight".to_owned(),
            FOOT_COUNT => "four legs".to_owned(),
            _ => on.join(" "),
        }
    }
}

/// A robot that a task cannot be planned for.
fn robot_error(task: &str, robot: &Path, error: RobotError) -> TaskError {
    TaskError::Robot {
        task: task.to_owned(),
        robot: robot.display().to_string(),
        error: Box::new(error),
    }
}

fn turn(file: &TaskFile) -> Result<(Vector3<f64>, f64), Unusable> {
    let Some(turn) = file.turn else {
        return Ok((Vector3::z(), 0.0));
    };
    let axis = Vector3::from(turn.axis);
    let length = axis.norm();
    let what = |what| ("turn.axis".to_owned(), format!("its length {what}"));
    AXIS.check(length).map_err(what)?;
    within(turn.angle_deg, TURN, "turn.angle_deg")?;
    Ok((axis / length, turn.angle_deg.to_radians()))
}

fn edge(
    file: &TaskFile,
    points_w: &[Vector3<f64>; FOOT_COUNT],
) -> Result<Option<Edge<f64>>, Unusable> {
    let Some(table) = file.r#box else {
        return Ok(None);
    };
    within(table.drop_m, LENGTH, "box.drop_m")?;
    require(matches!(table.side, 1 | -1), "box.side", "must be 1 or -1")?;
    let axis = match table.axis {
        Across::X => 0,
        Across::Y => 1,
    };
    let sign = f64::from(table.side);
    let nearest = points_w.iter().map(|point| sign * point[axis]);
    let nearest = nearest.fold(f64::NEG_INFINITY, f64::max);
    let (key, given, from) = match (table.beyond_feet_m, table.distance_m) {
        (Some(beyond), None) => ("box.beyond_feet_m", beyond, nearest),
        (None, Some(distance)) => ("box.distance_m", distance, 0.0),
        _ => {
            let what = match table.beyond_feet_m {
                Some(_) => "give either this or distance_m, not both",
                None => "missing: give either this or distance_m",
            };
            return Err(("box.beyond_feet_m".to_owned(), what.to_owned()));
        }
    };
    within(given, LENGTH, key)?;
    let distance = from + given;
    Ok(Some(Edge {
        drop: table.drop_m,
        axis,
        sign,
        distance,
        width: EDGE_WIDTH,
    }))
}

/// Bounds of the whole jump's duration, s.
fn check_total(min: f64, max: f64) -> Result<(), Unusable> {
    within(min, TOTAL, "total.min_s")?;
    within(max, TOTAL, "total.max_s")?;
    require(min <= max, "total", "min_s must not be above max_s")
}

/// The ground decides how high the goal is: a goal in the air, or in the ground, is none.
fn check_height(goal: &Vector3<f64>, edge: Option<Edge<f64>>) -> Result<(), Unusable> {
    let ground = edge.map_or(0.0, |edge| -edge.drop);
    require(
        (goal.z - ground).abs() <= HEIGHT_TOLERANCE,
        "goal_m",
        &format!(
            "its third number must be the landing's ground, {ground} m: -drop_m with a box, 0 without one, not {}",
            goal.z
        ),
    )
}

type Phases = ([Phase<f64, FOOT_COUNT>; PHASES], Reference);

fn phases(file: &TaskFile, robot: &Quadruped, edge: Option<Edge<f64>>) -> Result<Phases, Unusable> {
    let count = file.phases.len();
    require(
        (1..=PHASES).contains(&count),
        "phase",
        &format!("there must be 1 to {PHASES} phases"),
    )?;
    let turning = file.phases.iter().filter(|p| p.turn_deg.is_some()).count();
    require(
        turning == 0 || turning == count,
        "phase.turn_deg",
        "must be in all phases or in none",
    )?;
    let turned = file.turn.map_or(0.0, |turn| turn.angle_deg);
    let last = file.phases.last().and_then(|phase| phase.turn_deg);
    require(
        last.is_none_or(|last| (last - turned).abs() < 1e-9),
        &format!("phase {count}: turn_deg"),
        &format!("the last phase ends with the whole turn, {turned} degrees by `turn.angle_deg`"),
    )?;
    let drop = edge.map_or(0.0, |edge| edge.drop.clamp(0.0, LOW_BOX));
    let mut phases = [Phase {
        contacts: [false; FOOT_COUNT],
        intervals: 0,
        duration_guess: 0.0,
        min_duration: 0.0,
        max_duration: 0.0,
        reference_angle: 0.0,
    }; PHASES];
    for (i, (slot, table)) in phases.iter_mut().zip(&file.phases).enumerate() {
        *slot = phase(table, robot, SHORTEST_FLIGHT + FLIGHT_PER_DROP * drop)
            .map_err(|(key, what)| (format!("phase {}: {key}", i + 1), what))?;
    }
    let reference = if turning > 0 {
        Reference::PerPhase
    } else {
        Reference::Linear
    };
    Ok((phases, reference))
}

fn phase(
    table: &PhaseTable,
    robot: &Quadruped,
    shortest_flight: f64,
) -> Result<Phase<f64, FOOT_COUNT>, Unusable> {
    let mut contacts = [false; FOOT_COUNT];
    for foot in &table.feet {
        let leg = robot.leg(foot).ok_or_else(|| {
            let known = PLACES.join(", ");
            (
                "feet".to_owned(),
                format!("no foot `{foot}`; there are {known}"),
            )
        })?;
        if core::mem::replace(&mut contacts[leg], true) {
            return Err(("feet".to_owned(), format!("`{foot}` is named twice")));
        }
    }
    let [shortest, longest] = match table.feet.len() {
        0 => [shortest_flight, DURATIONS[1]],
        FOOT_COUNT => [DURATIONS[0], LONGEST_FOUR_LEGS],
        _ => [DURATIONS[0], LONGEST_TWO_LEGS],
    };
    let min = table.min_s.unwrap_or(shortest);
    let max = table.max_s.unwrap_or(longest.max(min));
    let min = table.min_s.unwrap_or(min.min(max));
    within(min, DURATION, "min_s")?;
    within(max, DURATION, "max_s")?;
    require(min <= max, "max_s", "must not be below min_s")?;
    within(table.guess_s, DURATION, "guess_s")?;
    // A bound that is not written down moves the guess instead: that of a flight off a box depends on its height.
    let low = table.min_s.unwrap_or(min.min(table.guess_s));
    let high = table.max_s.unwrap_or(max.max(table.guess_s));
    let what = |what| ("guess_s".to_owned(), format!("{what}: its min_s and max_s"));
    Range::From(low, high).check(table.guess_s).map_err(what)?;
    require(
        (1..=MOST_INTERVALS).contains(&table.intervals),
        "intervals",
        &format!("must be 1 to {MOST_INTERVALS}, not {}", table.intervals),
    )?;
    let turn = table.turn_deg.unwrap_or(0.0);
    within(turn, TURN, "turn_deg")?;
    Ok(Phase {
        contacts,
        intervals: table.intervals,
        duration_guess: table.guess_s.clamp(min, max),
        min_duration: min,
        max_duration: max,
        reference_angle: turn.to_radians(),
    })
}
