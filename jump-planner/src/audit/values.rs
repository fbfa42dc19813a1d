//! Whether the numbers of a stored plan are those of this robot, node by node: what a container cannot know of itself.

use super::{BEYOND, motion, state};
use crate::robot::{JOINTS, LEGS, Quadruped};
use crate::stored::{Stored, joint_name};
use crate::whole_body::POSED;
use jump_control::Torques;
use jump_control::container::{Header, PlanNode, PlanPhase, write};
use nalgebra::Vector3;
use rbd_core::{JointLimits, Model, Tangent};

/// How far a stored foot may be from where the joints put it, m, and its velocity from theirs, m/s.
const FEET: [f64; 2] = [1e-4, 1e-3];
/// Times that differ by less are the same, s: sums of single-precision durations.
const SAME_TIME: f64 = 1e-3;
/// Weights that differ by less are the same, as a share.
const SAME_WEIGHT: f64 = 1e-4;

/// Fails with the first node that is none of this robot's.
///
/// # Errors
/// A sentence that names the first node and what is wrong there.
pub fn check(robot: &Quadruped, plan: &Stored<'_>) -> Result<(), String> {
    plan.check().map_err(|error| error.to_string())?;
    let damaged = |at: String, what: &str| {
        format!("damaged, though its checksum fits: {at}{what}; plan again")
    };
    let nodes: Vec<_> = plan.nodes().collect();
    let weight = robot.weight();
    header(robot, plan.header(), weight).map_err(|what| damaged(String::new(), what))?;
    let share = f64::from(plan.header().margins.torque_share);
    for (i, node) in nodes.iter().enumerate() {
        let wrong = joints(robot, node, share)
            .or_else(|| feet(robot, node))
            .or_else(|| moment(plan.header(), node))
            .or_else(|| match nodes.get(i + 1) {
                Some(next) => motion::check(robot, weight, [node, next]),
                None => end(plan.header(), node),
            });
        if let Some(what) = wrong {
            return Err(damaged(format!("node {i}: "), &what));
        }
    }
    let mut bytes = vec![0; plan.bytes().len()];
    let written = write(&mut bytes, plan.robot(), plan.header(), &nodes);
    if written.is_err() || bytes != plan.bytes() {
        return Err(damaged(String::new(), "bytes without a meaning are not 0"));
    }
    Ok(())
}

/// Fails where the header is none of a plan that this planner makes for this robot.
fn header(robot: &Quadruped, header: &Header<'_, JOINTS>, weight: f64) -> Result<(), &'static str> {
    let must = |ok: bool, what| if ok { Ok(()) } else { Err(what) };
    must(header.robot == robot.name, "name of the robot")?;
    must(header.torques == Torques::Hold, "torques between nodes")?;
    let told = f64::from(header.margins.weight);
    must((told - weight).abs() <= SAME_WEIGHT * weight, "weight")?;
    let near = |time: f32, x: f64| (f64::from(time) - x).abs() <= SAME_TIME;
    let (phases, others) = header
        .phases
        .split_at_checked(header.phase_count.into())
        .ok_or("number of phases")?;
    let unused = PlanPhase::default();
    must(others.iter().all(|x| *x == unused), "phases that are none")?;
    let pushing = phases.iter().take_while(|phase| phase.contacts != 0);
    let takeoff = pushing.map(|phase| f64::from(phase.duration)).sum();
    must(near(header.takeoff, takeoff), "takeoff")?;
    let posing = f64::from(header.touchdown) - POSED;
    must(near(header.posing, posing), "posing")?;
    let limits: &[JointLimits<f64>; JOINTS] = Model::limits(robot);
    let inside = limits
        .iter()
        .zip(header.landing_joints)
        .all(|(limit, q)| in_range(limit, f64::from(q)));
    must(inside, "landing posture")
}

/// Whether a joint's position is one that the audit lets pass: plans keep limits in the middle of an interval, and a node is between two of those.
fn in_range(limit: &JointLimits<f64>, q: f64) -> bool {
    let beyond = BEYOND * (limit.upper - limit.lower);
    limit.lower - beyond <= q && q <= limit.upper + beyond
}

/// What is wrong with the phase of a node: it must be the one that lasts then.
fn moment(header: &Header<'_, JOINTS>, node: &PlanNode<JOINTS, LEGS>) -> Option<String> {
    let lasts = |phase: usize| {
        header
            .phases
            .get(phase)
            .map_or(0.0, |p| f64::from(p.duration))
    };
    let phase = usize::from(node.phase);
    let begin: f64 = (0..phase).map(lasts).sum();
    let (time, end) = (f64::from(node.time), begin + lasts(phase));
    let is_first = phase == 0 && time < 0.0;
    let inside = begin - SAME_TIME <= time && time <= end + SAME_TIME;
    (!(is_first || inside)).then(|| "it is in a phase that does not last then".to_owned())
}

/// What is wrong with the last node, which is in the last phase, and from which on nothing is held.
fn end(header: &Header<'_, JOINTS>, node: &PlanNode<JOINTS, LEGS>) -> Option<String> {
    if node.phase.saturating_add(1) != header.phase_count {
        return Some("it is not in the last phase".to_owned());
    }
    let held = node.torques.iter().chain(node.forces_w.as_flattened());
    let mut held = held.filter(|x| **x != 0.0);
    held.next().map(|x| format!("{x} is held after the end"))
}

/// What is wrong with the joints of a node.
fn joints(robot: &Quadruped, node: &PlanNode<JOINTS, LEGS>, share: f64) -> Option<String> {
    let limits: &[JointLimits<f64>; JOINTS] = Model::limits(robot);
    limits.iter().enumerate().find_map(|(i, limit)| {
        let [q, v, torque] = [node.joints[i], node.joint_velocities[i], node.torques[i]];
        let [q, v, torque] = [q, v, torque].map(f64::from);
        let checks = [
            (in_range(limit, q), "position", q),
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
fn feet(robot: &Quadruped, node: &PlanNode<JOINTS, LEGS>) -> Option<String> {
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
        let [told, told_velocity] = told.map(|x| Vector3::from(x.map(f64::from)));
        let near = (told - place).amax() <= FEET[0];
        let moves = (told_velocity - to_base * velocity_w).amax() <= FEET[1];
        let what = if near { "velocity" } else { "place" };
        (!(near && moves))
            .then(|| format!("{what} of foot {} is not that of its leg", robot.place(leg)))
    })
}

#[cfg(test)]
mod tests {
    use super::{BEYOND, in_range};
    use rbd_core::JointLimits;

    #[test]
    fn joints_may_be_as_far_beyond_their_limits_as_the_audit_allows() {
        let (lower, upper) = (-2.7, -0.9);
        let limit = JointLimits {
            lower,
            upper,
            ..JointLimits::NONE
        };
        let beyond = BEYOND * (upper - lower);
        for (share, passes) in [(0.0, true), (0.9, true), (1.1, false)] {
            assert_eq!(in_range(&limit, upper + share * beyond), passes, "{share}");
            assert_eq!(in_range(&limit, lower - share * beyond), passes, "{share}");
        }
        assert!(!in_range(&limit, f64::NAN));
    }
}
