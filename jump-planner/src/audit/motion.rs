//! Whether the nodes of a stored plan are those of one motion under its torques and forces, by the planner's own rule: accelerations
//! are constant over an interval, and the dynamics hold half-way. This is far finer than the audit, which moves the robot by a rule of
//! its own: a number that was changed shows in the interval where it stands.

use super::state;
use crate::robot::{JOINTS, LEGS, Quadruped, State};
use crate::whole_body::FRICTION_SMOOTHING;
use jump_control::container::PlanNode;
use nalgebra::Vector3;
use rbd_core::{Effort, Force, Model, Posture, Tangent, integrate, joint_friction, rnea};

/// How far mean speeds of two nodes may be from what lies between the nodes, m/s or rad/s: single precision leaves 5e-4.
const RATE: f64 = 0.01;
/// How far the wrench on the base may be from that of the motion, in weights of the robot and times a metre: single precision leaves 6e-5.
const WRENCH: f64 = 1e-3;
/// The same of a joint's torque: single precision leaves 4e-6.
const TORQUE: f64 = 2e-4;

/// The robot half-way between two nodes: where it is, how it moves, and how that changes.
struct Middle {
    q: State,
    v: Tangent<f64, JOINTS>,
    a: Tangent<f64, JOINTS>,
}

/// What is wrong between a node and the next one, of a robot of this weight, N.
pub(super) fn check(
    robot: &Quadruped,
    weight: f64,
    [from, to]: [&PlanNode<JOINTS, LEGS>; 2],
) -> Option<String> {
    let (middle, slips) = middle(from, to);
    // Not `>`: what is not a number is no motion either.
    let near = |by: f64, most: f64| by <= most;
    if let Some((what, by)) = slips.into_iter().find(|(_, by)| !near(*by, RATE)) {
        return Some(format!(
            "{what} does not move at the speeds of the nodes, by {by:.1e} m/s or rad/s"
        ));
    }
    let [wrench, torque] = missing(robot, from, &middle);
    if !near(wrench, WRENCH * weight) {
        return Some(format!(
            "the forces on the feet are not those of the motion, by {wrench:.1e} N or N m"
        ));
    }
    if !near(torque, TORQUE * weight) {
        return Some(format!(
            "the torques are not those of the motion, by {torque:.1e} N m"
        ));
    }
    None
}

/// The middle, and by how much the mean speeds of both nodes differ from what lies between them.
fn middle(
    from: &PlanNode<JOINTS, LEGS>,
    to: &PlanNode<JOINTS, LEGS>,
) -> (Middle, [(&'static str, f64); 3]) {
    let dt = f64::from(to.time - from.time);
    let ((begin, v), (end, end_v)) = (state(from), state(to));
    let turned = so3::log(&(begin.base.rotation.inverse() * end.base.rotation));
    let moved = end.base.translation - begin.base.translation;
    // The base's linear acceleration is constant in world axes.
    let speed_w = begin.base.rotation * v.base.linear;
    let end_speed_w = end.base.rotation * end_v.base.linear;
    let mean_w = (speed_w + end_speed_w) * 0.5;
    let mut mean = (v + end_v) * 0.5;
    let mut rate = (end_v + v * -1.0) * (1.0 / dt);
    let slips = [
        ("the base", (moved / dt - mean_w).amax()),
        ("the base's turn", (turned / dt - mean.base.angular).amax()),
        (
            "a joint",
            (0..JOINTS).fold(0.0, |most, i| {
                let slip = (end.joints[i] - begin.joints[i]) / dt - mean.joints[i];
                f64::max(most, slip.abs())
            }),
        ),
    ];
    let mut half = Tangent::ZERO;
    half.base.angular = turned * 0.5;
    half.joints = core::array::from_fn(|i| 0.5 * (end.joints[i] - begin.joints[i]));
    let mut q = integrate(&begin, &half);
    q.base.translation = begin.base.translation + moved * 0.5;
    let to_base = q.base.rotation.inverse();
    mean.base.linear = to_base * mean_w;
    rate.base.linear =
        to_base * ((end_speed_w - speed_w) / dt) - mean.base.angular.cross(&mean.base.linear);
    let middle = Middle {
        q,
        v: mean,
        a: rate,
    };
    (middle, slips)
}

/// By how much the wrench on the base, N or N m, and the torques of the joints, N m, differ from those of the motion.
fn missing(robot: &Quadruped, held: &PlanNode<JOINTS, LEGS>, middle: &Middle) -> [f64; 2] {
    let effort = rnea(robot, &Posture::new(robot, &middle.q), &middle.v, &middle.a);
    let kinematics = robot.poses(&middle.q);
    let mut pushed = Effort::ZERO;
    for (leg, f) in held.forces_w.iter().enumerate() {
        let jacobian = robot.jacobian(&kinematics, &robot.contact_frame(&kinematics, leg));
        let force_w = Vector3::from(f.map(f64::from));
        pushed = pushed + jacobian.tr_mul(&Force::new(force_w, Vector3::zeros()));
    }
    let lost = joint_friction(Model::limits(robot), &middle.v.joints, FRICTION_SMOOTHING);
    let joints = (0..JOINTS).map(|i| {
        let needed = effort.joints[i] - pushed.joints[i] - lost[i];
        needed - f64::from(held.torques[i])
    });
    let wrench = (effort.base - pushed.base).to_array();
    // Not `max`, which loses what is not a number.
    let largest = |most: f64, x: f64| if x.abs() <= most { most } else { x.abs() };
    [
        wrench.into_iter().fold(0.0, largest),
        joints.fold(0.0, largest),
    ]
}
