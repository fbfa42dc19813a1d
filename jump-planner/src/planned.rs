//! From a task to what the controller follows: which planner, and its plan node by node.

use super::answer::Answer;
use super::bounds::impossible;
use super::no_plan::NoPlan;
use super::reference::{self, Reference};
use super::robot::Quadruped;
use super::stored::{self, open, store};
use super::task::{SrbPlan, Task};
use super::whole_body::{self, Interval, N, Timing, WholeBodyPlan};
use super::{FOOT_COUNT, JOINTS, Node};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{Settings, Status};
use rbd_core::{Motion, Transform};
use std::time::Instant;
use wb_opt::{BASE, State};

/// How the legs are planned along the single rigid body's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planner {
    /// Whole-body trajectory optimisation, paper A, III-B.
    WholeBody,
    /// Leg kinematics along the rigid body's angular momentum, and inverse dynamics.
    Kinematics,
    /// Trajectory optimisation in joint space with the dynamics of the rigid body, on legs of which only the rotors have inertia and
    /// without limits of torque: the baseline of paper A, V-A.
    RigidBody,
}

/// How a whole-body problem was solved.
#[derive(Clone, Copy, Debug)]
pub struct Solved {
    /// Time that it took, ms.
    pub wall_ms: f64,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Cost of the plan.
    pub cost: f64,
    /// Largest violation of a row, in its own unit.
    pub max_violation: f64,
    /// Torque that the plan was allowed, N m.
    pub torque_limit: f64,
}

/// Where a reference comes from.
#[derive(Clone, Copy, Debug)]
pub enum Origin {
    /// Leg kinematics.
    Kinematics,
    /// Optimisation on legs that weigh nothing, just now.
    RigidBody(Solved),
    /// Whole-body optimisation, just now.
    WholeBody(Solved),
    /// A container that was stored before.
    Stored,
}

impl Origin {
    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinematics => "srb+kinematics",
            Self::RigidBody(_) => "srb+massless-legs",
            Self::WholeBody(_) => "whole-body",
            Self::Stored => "stored",
        }
    }

    /// How the whole-body problem was solved, where that is known.
    #[must_use]
    pub fn solved(self) -> Option<Solved> {
        match self {
            Self::WholeBody(solved) | Self::RigidBody(solved) => Some(solved),
            Self::Kinematics | Self::Stored => None,
        }
    }
}

impl core::str::FromStr for Planner {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|planner| planner.name() == name);
        found.ok_or_else(|| {
            format!(
                "no planner `{name}`; there are {}",
                Self::ALL.map(Self::name).join(", ")
            )
        })
    }
}

impl Planner {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::WholeBody, Self::Kinematics, Self::RigidBody];

    /// Its name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WholeBody => "whole-body",
            Self::Kinematics => "kinematics",
            Self::RigidBody => "rigid-body",
        }
    }

    /// Plans the legs along a plan of the body.
    ///
    /// # Errors
    /// [`NoPlan`]: not solved, or refused by its audit.
    pub fn plan(self, task: &Task, srb: &SrbPlan) -> Result<Reference, NoPlan> {
        match self {
            Self::WholeBody => whole_body(task, srb),
            Self::Kinematics => Ok(reference::build(task, srb)?),
            Self::RigidBody => rigid_body(task, srb),
        }
    }
}

/// The motion of the body, which the legs' plans follow.
///
/// # Errors
/// [`NoPlan`]: the proof that there is no plan at all, or what blocks the body and what would have to change.
pub fn body(task: &Task) -> Result<SrbPlan, NoPlan> {
    if let Some(proof) = impossible(task) {
        return Err(Answer::proven(proof).into());
    }
    let plan = task.attempt(&Settings::new(), |_| ControlFlow::Continue(()))?;
    if plan.status != Status::Solved {
        let blocked = Answer::no_body_plan(task, &plan);
        let answer = blocked.with_easier_tasks(task, |_| ControlFlow::Continue(()));
        return Err(answer.into());
    }
    Ok(plan)
}

fn whole_body(task: &Task, srb: &SrbPlan) -> Result<Reference, NoPlan> {
    let whole = whole_body::audited(task, srb, Timing::Given, |_| ControlFlow::Continue(()))?;
    let solved = solved(task, &whole.plan, whole.wall_ms)?;
    if let Some(audit) = whole.audit.filter(|audit| !audit.is_a_motion()) {
        return Err(Answer::failed(&audit).into());
    }
    let origin = Origin::WholeBody(solved);
    Ok(follow(task, &task.robot, &whole.bytes, origin)?)
}

/// Not audited: it is the plan of another robot.
fn rigid_body(task: &Task, srb: &SrbPlan) -> Result<Reference, NoPlan> {
    let robot = task.robot.on_massless_legs(&task.start);
    let light = Task {
        robot: robot.map_err(|error| error.to_string())?,
        ..task.clone()
    };
    let clock = Instant::now();
    let plan = whole_body::plan(&light, srb, Timing::Given, |_| ControlFlow::Continue(()))?;
    let solved = solved(&light, &plan, clock.elapsed().as_secs_f64() * 1e3)?;
    let bytes = store(&light, &plan)?;
    let origin = Origin::RigidBody(solved);
    Ok(follow(task, &light.robot, &bytes, origin)?)
}

/// How a plan was solved; an error if it was not.
fn solved(task: &Task, plan: &WholeBodyPlan, wall_ms: f64) -> Result<Solved, NoPlan> {
    let outcome = &plan.outcome;
    if outcome.status != Status::Solved {
        return Err(Answer::no_whole_body_plan(task, plan).into());
    }
    Ok(Solved {
        wall_ms,
        iterations: outcome.iterations,
        cost: plan.judged.cost,
        max_violation: plan.judged.max_violation,
        torque_limit: plan.torque_limit,
    })
}

/// What the controller follows: what stands in the bytes, and nothing else.
pub(crate) fn follow(
    task: &Task,
    robot: &Quadruped,
    bytes: &[u8],
    origin: Origin,
) -> Result<Reference, String> {
    let stored = open(bytes, robot).map_err(|error| error.to_string())?;
    Ok(Reference {
        origin,
        ..stored::reference(&stored, task)?
    })
}

/// Largest torque, N m, and largest tangential over normal force of the nodes before the take-off.
#[must_use]
pub fn peaks(nodes: &[Node], takeoff: f64) -> [f64; 2] {
    let (mut torque, mut friction) = (0.0, 0.0);
    for node in nodes.iter().filter(|node| node.time < takeoff) {
        torque = node
            .torques
            .iter()
            .fold(torque, |m, t| f64::max(m, t.abs()));
        for f in node.forces_w.iter().filter(|f| f.z > 5.0) {
            friction = f64::max(friction, f.xy().norm() / f.z);
        }
    }
    [torque, friction]
}

/// A node of the plan: a state, and what is held over the interval that starts there; nothing after the last.
#[must_use]
pub fn node(time: f64, state: &State<f64, N>, interval: Option<&Interval>) -> Node {
    let held = interval.map(|interval| &interval.sample);
    let (q, v, rot_wb) = (&state.q, &state.v, &state.rot_wc);
    let velocity_w = Vector3::new(v[0], v[1], v[2]);
    Node {
        time,
        base: Transform::new(*rot_wb, Vector3::new(q[0], q[1], q[2])),
        base_velocity: Motion::new(
            rot_wb.inverse() * velocity_w,
            Vector3::new(v[3], v[4], v[5]),
        ),
        joints: core::array::from_fn(|i| q[BASE + i]),
        joint_velocities: core::array::from_fn(|i| v[BASE + i]),
        torques: held.map_or([0.0; JOINTS], |held| {
            core::array::from_fn(|i| held.effort[BASE + i])
        }),
        forces_w: held.map_or([Vector3::zeros(); FOOT_COUNT], |held| held.forces_w),
    }
}
