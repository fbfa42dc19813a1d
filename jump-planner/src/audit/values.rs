//! Whether the numbers of a stored plan are those of this robot, node by node: what a container cannot know of itself.

use super::state;
use crate::robot::{JOINTS, Quadruped};
use crate::stored::{Stored, joint_name};
use jump_control::container::PlanNode;
use rbd_core::{JointLimits, Model, Tangent};

/// How far a joint may be beyond a limit, as a share of it or rad: solvers stop within their tolerance, and plans are in single precision.
const BEYOND: f64 = 0.01;
/// How far a stored foot may be from where the joints put it, m, and its velocity from theirs, m/s.
const FEET: [f64; 2] = [1e-4, 1e-3];

/// Fails with the first node that is none of this robot's.
///
/// # Errors
/// A sentence that names the first node and what is wrong there.
pub fn check(robot: &Quadruped, plan: &Stored<'_>) -> Result<(), String> {
    plan.check().map_err(|error| error.to_string())?;
    let share = f64::from(plan.header().margins.torque_share);
    for (i, node) in plan.nodes().enumerate() {
        let wrong = joints(robot, &node, share).or_else(|| feet(robot, &node));
        if let Some(what) = wrong {
            return Err(format!(
                "damaged, though its checksum fits: node {i}: {what}; plan again"
            ));
        }
    }
    Ok(())
}

/// What is wrong with the joints of a node.
fn joints(robot: &Quadruped, node: &PlanNode<JOINTS, 4>, share: f64) -> Option<String> {
    let limits: &[JointLimits<f64>; JOINTS] = Model::limits(robot);
    limits.iter().enumerate().find_map(|(i, limit)| {
        let [q, v, torque] = [node.joints[i], node.joint_velocities[i], node.torques[i]];
        let [q, v, torque] = [q, v, torque].map(f64::from);
        let checks = [
            (
                limit.lower - BEYOND <= q && q <= limit.upper + BEYOND,
                "position",
                q,
            ),
            (v.abs() <= (1.0 + BEYOND) * limit.speed, "speed", v),
            (
                torque.abs() <= (share + BEYOND) * limit.effort,
                "torque",
                torque,
            ),
        ];
        let (_, what, value) = checks.into_iter().find(|(ok, ..)| !ok)?;
        Some(format!(
            "{what} of {} is {value}, beyond its limit",
            joint_name(robot, i)
        ))
    })
}

/// What is wrong with the feet of a node: they hang on its joints.
fn feet(robot: &Quadruped, node: &PlanNode<JOINTS, 4>) -> Option<String> {
    let (q, v) = state(node);
    let legs_only = Tangent {
        joints: v.joints,
        ..Tangent::ZERO
    };
    let kinematics = robot.poses(&q);
    let to_base = q.base.rotation.inverse();
    robot.feet.iter().enumerate().find_map(|(leg, frame)| {
        let foot_w = kinematics.frame(frame).translation - q.base.translation;
        let velocity_w = robot.jacobian(&kinematics, frame).mul(&legs_only).linear;
        let place = to_base * foot_w - robot.hips[leg];
        let told = [node.feet_b[leg], node.foot_velocities_b[leg]];
        let [told, told_velocity] = told.map(|x| nalgebra::Vector3::from(x.map(f64::from)));
        let near = (told - place).amax() <= FEET[0];
        let moves = (told_velocity - to_base * velocity_w).amax() <= FEET[1];
        let what = if near { "velocity" } else { "place" };
        (!(near && moves))
            .then(|| format!("{what} of foot {} is not that of its leg", robot.place(leg)))
    })
}
