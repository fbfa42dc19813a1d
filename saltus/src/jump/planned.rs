//! From a task to what the controller follows: which planner, and its plan node by node.

use super::reference::{self, Reference, standing};
use super::task::{SrbPlan, Task};
use super::whole_body::{self, Interval, N, Timing, WholeBodyPlan};
use super::{FOOT_COUNT, JOINTS, Node};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::Status;
use rbd_core::{Motion, Transform};
use std::time::Instant;
use wb_opt::{BASE, Phase, State};

/// How the legs are planned along the single rigid body's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Planner {
    /// Whole-body trajectory optimisation, paper A, III-B.
    WholeBody,
    /// Leg kinematics along the rigid body's angular momentum, and inverse dynamics.
    Kinematics,
    /// Trajectory optimisation in joint space with the dynamics of the rigid body, on legs that weigh nothing and without limits of
    /// torque: the baseline of paper A, V-A.
    RigidBody,
}

/// How a whole-body problem was solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solved {
    pub(crate) wall_ms: f64,
    pub(crate) iterations: usize,
    pub(crate) cost: f64,
    pub(crate) max_violation: f64,
    /// Torque that the plan was allowed, N m.
    pub(crate) torque_limit: f64,
}

/// Where a reference comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Origin {
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
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Kinematics => "srb+kinematics",
            Self::RigidBody(_) => "srb+massless-legs",
            Self::WholeBody(_) => "whole-body",
            Self::Stored => "stored",
        }
    }

    /// How the whole-body problem was solved, where that is known.
    pub(crate) fn solved(self) -> Option<Solved> {
        match self {
            Self::WholeBody(solved) | Self::RigidBody(solved) => Some(solved),
            Self::Kinematics | Self::Stored => None,
        }
    }
}

impl Planner {
    /// Its name on the command line and in results.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::WholeBody => "whole-body",
            Self::Kinematics => "kinematics",
            Self::RigidBody => "rigid-body",
        }
    }

    /// Plans the legs along a plan of the body.
    pub(crate) fn plan(self, task: &Task, srb: &SrbPlan) -> Result<Reference, String> {
        match self {
            Self::WholeBody => whole_body(task, srb),
            Self::Kinematics => reference::build(task, srb),
            Self::RigidBody => rigid_body(task, srb),
        }
    }
}

fn whole_body(task: &Task, srb: &SrbPlan) -> Result<Reference, String> {
    let whole = whole_body::audited(task, srb, Timing::Given, false, |_| {
        ControlFlow::Continue(())
    })?;
    let solved = solved(task, &whole.plan, whole.wall_ms)?;
    if let Some(audit) = whole.audit.filter(|audit| !audit.is_a_motion()) {
        return Err(format!(
            "task {}: the plan failed its audit: {}",
            task.name,
            audit.complaint()
        ));
    }
    follow(task, &whole.plan, Origin::WholeBody(solved))
}

/// Not audited: it is the plan of another robot.
fn rigid_body(task: &Task, srb: &SrbPlan) -> Result<Reference, String> {
    let robot = task.robot.on_massless_legs(&task.start);
    let light = Task {
        robot: robot.map_err(|error| error.to_string())?,
        ..task.clone()
    };
    let clock = Instant::now();
    let plan = whole_body::plan(&light, srb, Timing::Given, |_| ControlFlow::Continue(()))?;
    let solved = solved(task, &plan, clock.elapsed().as_secs_f64() * 1e3)?;
    follow(task, &plan, Origin::RigidBody(solved))
}

/// How a plan was solved; an error if it was not.
fn solved(task: &Task, plan: &WholeBodyPlan, wall_ms: f64) -> Result<Solved, String> {
    let outcome = &plan.outcome;
    if outcome.status != Status::Solved {
        return Err(format!(
            "task {}: the whole-body planner ended with {:?} after {} iterations, violation {:.1e}: \
             ask for less, or try --planner kinematics",
            task.name, outcome.status, outcome.iterations, plan.judged.max_violation
        ));
    }
    Ok(Solved {
        wall_ms,
        iterations: outcome.iterations,
        cost: plan.judged.cost,
        max_violation: plan.judged.max_violation,
        torque_limit: plan.torque_limit,
    })
}

/// A whole-body plan as the controller follows it.
fn follow(task: &Task, plan: &WholeBodyPlan, origin: Origin) -> Result<Reference, String> {
    let stands = |phase: &&Phase<f64, FOOT_COUNT>| phase.contacts.contains(&true);
    let duration = |phase: &Phase<f64, FOOT_COUNT>| phase.dt * phase.intervals as f64;
    let takeoff: f64 = plan.phases.iter().take_while(stands).map(duration).sum();
    let touchdown: f64 = plan.phases.iter().map(duration).sum();
    let mut nodes = vec![standing(task)?];
    nodes.extend(
        plan.intervals
            .iter()
            .map(|interval| node(interval.start, &interval.state, Some(interval))),
    );
    let [peak_torque, peak_friction] = peaks(&nodes, takeoff);
    Ok(Reference {
        nodes,
        takeoff,
        posing: touchdown - whole_body::POSED,
        touchdown,
        landing_joints: task.robot.landing_joints(&task.start)?,
        durations: plan.phases.iter().map(duration).collect(),
        peak_torque,
        peak_friction,
        base_residual: plan.judged.max_violation,
        origin,
    })
}

/// Largest torque, N m, and largest tangential over normal force of the nodes before the take-off.
pub(crate) fn peaks(nodes: &[Node], takeoff: f64) -> [f64; 2] {
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
pub(crate) fn node(time: f64, state: &State<f64, N>, interval: Option<&Interval>) -> Node {
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
