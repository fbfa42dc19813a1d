//! From a task to what the controller follows: which planner, and its plan node by node.

use super::reference::{self, Legs, Reference, standing};
use super::task::{SrbPlan, Task};
use super::whole_body::{self, Interval, N, Timing, WholeBodyPlan};
use super::{FOOT_COUNT, JOINTS, Node};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::Status;
use rbd_core::{Motion, Transform};
use wb_opt::{BASE, Phase, State};

/// How the legs are planned along the single rigid body's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Planner {
    /// Whole-body trajectory optimisation, paper A, III-B.
    WholeBody,
    /// Leg kinematics along the rigid body's angular momentum, and inverse dynamics.
    Kinematics,
    /// Leg kinematics under the rigid body's attitude, and torques of its forces alone: the baseline of paper A, V-A.
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
    Kinematics(Legs),
    /// Whole-body optimisation, just now.
    WholeBody(Solved),
    /// A container that was stored before.
    Stored,
}

impl Origin {
    /// Its name in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Kinematics(Legs::Heavy) => "srb+kinematics",
            Self::Kinematics(Legs::Massless) => "srb+massless-legs",
            Self::WholeBody(_) => "whole-body",
            Self::Stored => "stored",
        }
    }

    /// How the whole-body problem was solved, where that is known.
    pub(crate) fn solved(self) -> Option<Solved> {
        match self {
            Self::WholeBody(solved) => Some(solved),
            Self::Kinematics(_) | Self::Stored => None,
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
        let legs = match self {
            Self::WholeBody => None,
            Self::Kinematics => Some(Legs::Heavy),
            Self::RigidBody => Some(Legs::Massless),
        };
        if let Some(legs) = legs {
            return reference::build(task, srb, legs);
        }
        let whole = whole_body::audited(task, srb, Timing::Given, false, |_| {
            ControlFlow::Continue(())
        })?;
        let plan = whole.plan;
        if plan.outcome.status != Status::Solved {
            return Err(format!(
                "task {}: the whole-body planner ended with {:?} after {} iterations, violation {:.1e}: \
                 ask for less, or try --planner kinematics",
                task.name, plan.outcome.status, plan.outcome.iterations, plan.judged.max_violation
            ));
        }
        if let Some(audit) = whole.audit.filter(|audit| !audit.is_a_motion()) {
            return Err(format!(
                "task {}: the plan failed its audit: {}",
                task.name,
                audit.complaint()
            ));
        }
        follow(task, &plan, whole.wall_ms)
    }
}

/// A whole-body plan as the controller follows it.
fn follow(task: &Task, plan: &WholeBodyPlan, wall_ms: f64) -> Result<Reference, String> {
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
        origin: Origin::WholeBody(Solved {
            wall_ms,
            iterations: plan.outcome.iterations,
            cost: plan.judged.cost,
            max_violation: plan.judged.max_violation,
            torque_limit: plan.torque_limit,
        }),
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
