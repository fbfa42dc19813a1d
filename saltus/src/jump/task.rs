//! From a task's name to the problem that is solved for execution.
//!
//! The reference problems use Table I of paper A literally; a plan that is to be executed needs the robot that executes it:
//! the published mass, the composite inertia of the crouch, and margins on friction and force.

use super::{FOOT_COUNT, ROBOT, State, kinematics};
use crate::reference::{File, SHIPPED};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{Settings, Solver, Stage, Status};
use rbd_core::{CentroidalMap, Posture, centroidal_map};
use srb_opt::Problem;

/// Most contact phases of a task.
pub(crate) const PHASES: usize = 4;
const NX: usize = 16;
const NU: usize = 12;
const NI: usize = 40;
/// Friction that plans may use of the ground's 0.6.
const PLANNED_FRICTION: f64 = 0.45;
/// Height of the centre of mass at the planned touchdown over its height at the start, m: legs reach for the ground.
const LANDING_RISE: f64 = 0.04;
/// Longest leg that the push-off may use, m: the knees stay clear of their stops and of straight.
const LONGEST_LEG: f64 = 0.30;
/// Farthest that the push-off may lean a leg sideways, m.
const SIDE_REACH: f64 = 0.09;
/// Shortest flight, s: the legs must fold and take up the landing posture.
const SHORTEST_FLIGHT: f64 = 0.28;
/// Longer flight where the robot jumps off a box, s per metre: the feet must clear its edge.
const FLIGHT_PER_DROP: f64 = 0.5;
/// Box height from which falling alone takes long enough, m.
const LOW_BOX: f64 = 0.4;
/// Longest stance on all feet, s.
const LONGEST_FOUR_LEGS: f64 = 0.55;
/// Longest stance on two feet, s: it is unstable open loop.
const LONGEST_TWO_LEGS: f64 = 0.35;

pub(crate) type SrbStage = Stage<f64, srb_opt::State<f64, PHASES>, NX, NU, NI>;

/// A task as it is planned for execution.
pub(crate) struct Task {
    /// Product name.
    pub(crate) name: String,
    /// The single-rigid-body problem.
    pub(crate) problem: Problem<f64, FOOT_COUNT, PHASES>,
    /// Standing at the start.
    pub(crate) start: State,
    /// Wanted displacement of the base, m.
    pub(crate) goal: Vector3<f64>,
    /// Wanted heading at the end, rad.
    pub(crate) heading: f64,
    /// Height of the box that the robot starts on, m, with its edge.
    pub(crate) edge: Option<srb_opt::Edge<f64>>,
}

/// A single-rigid-body plan, solved.
pub(crate) struct SrbPlan {
    pub(crate) stages: Vec<SrbStage>,
    pub(crate) iterations: u32,
    pub(crate) wall_ms: f64,
    pub(crate) max_violation: f64,
}

impl Task {
    /// The task of this name, for the robot that is simulated.
    pub(crate) fn load(name: &str) -> Result<Self, String> {
        let file = File::parse(SHIPPED)?;
        let key = file.pick(Some(name))?;
        if file.phase_count(key) > PHASES {
            return Err(format!("task {name} has more than {PHASES} phases"));
        }
        let mut problem: Problem<f64, FOOT_COUNT, PHASES> = file.problem(key)?;
        let goal = problem.goal_w - problem.start_w;
        let points = problem.feet.map(|foot| foot.pos_wf);
        let start = kinematics::stand(&problem.start_w, &points)?;
        let mut map = CentroidalMap::ZERO;
        centroidal_map(&ROBOT, &Posture::new(&ROBOT, &start), &mut map);
        let s = map.locked_inertia_w;
        problem.mass = map.mass;
        problem.inertia_b = Matrix3::new(s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz);
        problem.friction = PLANNED_FRICTION;
        // The problem's body frame sits at the centre of mass, the robot's at the trunk's middle.
        let com_b = kinematics::com(&start) - start.base.translation;
        for foot in &mut problem.feet {
            foot.nominal_b -= com_b;
        }
        for corner in &mut problem.corners {
            *corner -= com_b;
        }
        problem.goal_w.z += LANDING_RISE;
        problem.reach_lower.z = problem.reach_lower.z.max(-LONGEST_LEG);
        problem.reach_lower.y = problem.reach_lower.y.max(-SIDE_REACH);
        problem.reach_upper.y = problem.reach_upper.y.min(SIDE_REACH);
        let drop = problem
            .edge
            .map_or(0.0, |edge| edge.drop.clamp(0.0, LOW_BOX));
        let shortest = SHORTEST_FLIGHT + FLIGHT_PER_DROP * drop;
        for phase in &mut problem.phases[..problem.phase_count] {
            let feet = phase.contacts.iter().filter(|on| **on).count();
            if feet == 0 {
                phase.min_duration = phase.min_duration.max(shortest).min(phase.max_duration);
            } else if feet < FOOT_COUNT {
                phase.max_duration = phase.max_duration.min(LONGEST_TWO_LEGS);
            } else {
                phase.max_duration = phase.max_duration.min(LONGEST_FOUR_LEGS);
            }
            let guess = phase.duration_guess.min(phase.max_duration);
            phase.duration_guess = guess.max(phase.min_duration);
        }
        problem
            .check()
            .map_err(|error| format!("task {name}: {error}"))?;
        let heading = if problem.axis.z.abs() > 0.5 {
            problem.angle * problem.axis.z
        } else {
            0.0
        };
        Ok(Self {
            name: name.to_owned(),
            edge: problem.edge,
            problem,
            start,
            goal,
            heading,
        })
    }

    /// Solves the single-rigid-body problem; anything but a solved problem is an error.
    pub(crate) fn solve(&self) -> Result<SrbPlan, String> {
        let problem = &self.problem;
        let mut stages = vec![Stage::new(srb_opt::State::new()); problem.intervals() + 1];
        let clock = std::time::Instant::now();
        problem.write_guess(&mut stages, || 0.0);
        let solution = Solver::new(Settings::new())
            .solve(problem, &mut stages, |_| {
                core::ops::ControlFlow::Continue(())
            })
            .map_err(|error| error.to_string())?;
        let wall_ms = clock.elapsed().as_secs_f64() * 1e3;
        let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
        if solution.status != Status::Solved {
            return Err(format!(
                "task {}: the planner ended with {:?} after {} iterations, violation {:.1e}",
                self.name, solution.status, solution.iterations, judged.max_violation
            ));
        }
        Ok(SrbPlan {
            stages,
            iterations: solution.iterations as u32,
            wall_ms,
            max_violation: judged.max_violation,
        })
    }
}
