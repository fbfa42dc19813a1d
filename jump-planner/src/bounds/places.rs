//! Where body and feet are at the start and at the goal.

use super::facts::Facts;
use super::{Body, Impossible, SLACK, Task};
use crate::FOOT_COUNT;
use crate::robot::State;
use crate::whole_body::GOAL_TOLERANCE;
use nalgebra::{Matrix3, Vector3};
use rbd_core::Transform;
use srb_opt::Foot;

/// How much farther beyond an edge a goal is sought that has room, m.
const FAR: f64 = 2.0;

pub(super) fn feet<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    let edge = problem.edge.filter(|edge| edge.drop != 0.0)?;
    let stands = |i: usize| problem.used_phases().iter().any(|phase| phase.contacts[i]);
    let beyond = (0..FOOT_COUNT).filter(|i| stands(*i)).map(|i| {
        let across = edge.sign * problem.feet[i].pos_wf[edge.axis] - edge.distance;
        (across, i)
    });
    let (most, foot) = beyond.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most > 0.0).then(|| Impossible {
        bound: "feet",
        because: format!(
            "foot {} stands {most:.3} m beyond the edge of the box, {}",
            facts.places[foot],
            if edge.drop > 0.0 {
                "in the air"
            } else {
                "inside it"
            }
        ),
        relaxation: format!("the edge would have to be at least {most:.3} m farther"),
    })
}

/// How far the trunk is below what it must keep over the ground, in one pose.
fn trunk_below<const P: usize>(
    problem: &Body<P>,
    pos_w: &Vector3<f64>,
    rot_wb: &Matrix3<f64>,
) -> f64 {
    let below = problem.corners.iter().map(|corner| {
        let point = pos_w + rot_wb * corner;
        let ground = problem.edge.map_or(0.0, |edge| edge.ground(&point).height);
        ground + problem.clearance - point.z
    });
    below.fold(f64::NEG_INFINITY, f64::max)
}

/// Farthest that the centre of mass comes along an axis in the first interval, in which the body does not turn, m.
fn first_move<const P: usize>(problem: &Body<P>, facts: &Facts) -> f64 {
    let Some(first) = problem.used_phases().first() else {
        return 0.0;
    };
    let dt = first.max_duration / first.intervals as f64;
    let push = facts.feet * problem.max_force / problem.mass * problem.friction.max(1.0);
    0.5 * (push + problem.gravity) * dt * dt
}

/// Legs that cannot reach their feet where the robot stands. The first node whose rows count is the second.
pub(super) fn reach<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    let (_, phase) = problem.phase_of(1)?;
    let stands = (0..FOOT_COUNT).filter(|i| phase.contacts[*i] && problem.intervals() > 1);
    let missing = stands.flat_map(|foot| {
        let Foot { pos_wf, nominal_b } = problem.feet[foot];
        let seen = pos_wf - problem.start_w - nominal_b;
        (0..3).map(move |axis| {
            let beyond = f64::max(
                seen[axis] - problem.reach_upper[axis],
                problem.reach_lower[axis] - seen[axis],
            );
            (beyond, foot, axis)
        })
    });
    let (most, foot, axis) = missing.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most > first_move(problem, facts) + SLACK).then(|| Impossible {
        bound: "reach",
        because: format!(
            "at the start foot {} is {most:.3} m out of reach of its leg along {}",
            facts.places[foot],
            ["x", "y", "z"][axis]
        ),
        relaxation: format!(
            "the leg would have to reach {most:.3} m farther, or the robot to stand that much nearer"
        ),
    })
}

pub(super) fn start<const P: usize>(problem: &Body<P>, facts: &Facts) -> Option<Impossible> {
    let moved = first_move(problem, facts);
    // Sideways motion of a corner near a smoothed edge changes the ground under it by slope times way.
    let slope = problem
        .edge
        .map_or(0.0, |edge| 0.5 * edge.drop.abs() / edge.width);
    let below = trunk_below(problem, &problem.start_w, &Matrix3::identity());
    (below > moved * (1.0 + slope) + SLACK).then(|| Impossible {
        bound: "start",
        because: format!(
            "at the start the trunk is {below:.3} m lower than the ground and the clearance allow"
        ),
        relaxation: match problem.edge {
            Some(_) => {
                format!("the box would have to be at least {below:.3} m lower, or its edge farther")
            }
            None => format!("the clearance would have to be at least {below:.3} m less"),
        },
    })
}

pub(super) fn goal<const P: usize>(problem: &Body<P>, _: &Facts) -> Option<Impossible> {
    let turn = so3::rotation_about(&nalgebra::Unit::new_unchecked(problem.axis), problem.angle);
    let below = trunk_below(problem, &problem.goal_w, turn.matrix());
    (below > SLACK).then(|| Impossible {
        bound: "goal",
        because: format!(
            "at the goal the trunk is {below:.3} m lower than the ground and the clearance allow"
        ),
        relaxation: match beyond_edge(problem, turn.matrix()) {
            Some(missing) => {
                format!("the goal would have to be {missing:.3} m farther beyond the edge")
            }
            None => format!(
                "the goal would have to be at least {below:.3} m higher, or the clearance that much less"
            ),
        },
    })
}

/// How much farther beyond the edge of its box the goal has room for the trunk, m; none without a box, or where there is none within
/// [`FAR`].
fn beyond_edge<const P: usize>(problem: &Body<P>, rot_wb: &Matrix3<f64>) -> Option<f64> {
    let edge = problem.edge?;
    let has_room = |farther: f64| {
        let mut goal_w = problem.goal_w;
        goal_w[edge.axis] += edge.sign * farther;
        trunk_below(problem, &goal_w, rot_wb) <= SLACK
    };
    let (mut low, mut high) = (0.0, FAR);
    if !has_room(high) {
        return None;
    }
    while high - low > 1e-3 {
        let middle = 0.5 * (low + high);
        if has_room(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}

/// Feet that come down before the edge of a box, in the posture in which the legs land: beyond what the goal's tolerance forgives.
pub(super) fn landing(task: &Task) -> Option<Impossible> {
    let edge = task.problem.edge.filter(|edge| edge.drop != 0.0)?;
    let robot = &task.robot;
    let moved = task.problem.goal_w - task.problem.start_w;
    let base = Transform::new(task.rot_goal, task.start.base.translation + moved);
    let joints = *task.landing_joints();
    let poses = robot.poses(&State { base, joints });
    let short = robot.feet.iter().enumerate().map(|(i, frame)| {
        let foot = poses.frame(frame).translation;
        (edge.distance - edge.sign * foot[edge.axis], i)
    });
    let (short, foot) = short.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let forgiven = GOAL_TOLERANCE[0] + GOAL_TOLERANCE[3] * robot.leg_length;
    (short > forgiven).then(|| Impossible {
        bound: "landing",
        because: format!(
            "at the goal foot {} comes down {short:.3} m before the edge of the box, {}",
            robot.place(foot),
            if edge.drop > 0.0 {
                "inside it"
            } else {
                "in the air"
            }
        ),
        relaxation: format!(
            "the goal would have to be {short:.3} m farther, or the edge that much nearer"
        ),
    })
}
