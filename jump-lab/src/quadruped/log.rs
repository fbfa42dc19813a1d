//! What is kept of a run: one sample per millisecond.

use super::{FOOT_COUNT, JOINTS, OWNERS};
use crate::log::Log;
use jump_control::Phase;
use jump_planner::robot::Quadruped;
use jump_planner::stored::joint_name;
use nalgebra::{UnitQuaternion, Vector3};
use rbd_core::Transform;

/// One sample.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Of the plan, s: negative before the push-off.
    pub time: f64,
    /// Of the machine.
    pub phase: Phase,
    /// Of the base in the world, m.
    pub position: Vector3<f64>,
    /// Of the base in the world.
    pub orientation: UnitQuaternion<f64>,
    /// Of the base, world axes, m/s.
    pub velocity_w: Vector3<f64>,
    /// Of the base, base axes, rad/s.
    pub omega_b: Vector3<f64>,
    /// Centre of mass in the world, m.
    pub com: Vector3<f64>,
    /// Positions, rad.
    pub joints: [f64; JOINTS],
    /// Speeds, rad/s.
    pub joint_velocities: [f64; JOINTS],
    /// What the motors gave, N m.
    pub torques: [f64; JOINTS],
    /// Of the ground on feet and links, world axes, N.
    pub forces_w: [Vector3<f64>; OWNERS],
    /// By how much the floor has moved upwards, m.
    pub floor: f64,
    /// Of the base in the world, m.
    pub planned_position: Vector3<f64>,
    /// Positions, rad.
    pub planned_joints: [f64; JOINTS],
    /// Feed-forward of the plan, N m.
    pub planned_torques: [f64; JOINTS],
    /// On the feet, by the plan's last node.
    pub planned_forces_w: [Vector3<f64>; FOOT_COUNT],
    /// What the landing's quadratic program commanded in this millisecond; zero where there was none.
    pub commanded_forces_w: [Vector3<f64>; FOOT_COUNT],
}

impl Sample {
    /// The same, seen in a world in which the one that it was taken in has this pose; what was planned and commanded is the plan's already.
    pub(super) fn seen_in(mut self, world: &Transform<f64>) -> Self {
        let turned = &world.rotation;
        self.position = world.point(&self.position);
        self.com = world.point(&self.com);
        self.orientation = so3::quat::from_rotation(turned) * self.orientation;
        self.velocity_w = turned * self.velocity_w;
        self.forces_w = self.forces_w.map(|force| turned * force);
        self
    }
}

/// Short names of the feet: the places of their legs.
#[must_use]
pub fn foot_names(robot: &Quadruped) -> [&'static str; FOOT_COUNT] {
    core::array::from_fn(|leg| robot.place(leg))
}

/// Short joint names: `FL_hip` and so on.
#[must_use]
pub fn joint_names(robot: &Quadruped) -> [String; JOINTS] {
    core::array::from_fn(|i| joint_name(robot, i))
}

/// The samples as a table.
pub fn table(robot: &Quadruped, samples: &[Sample]) -> Log {
    let own = [
        "x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz", "com_x",
        "com_y", "com_z",
    ];
    let mut columns = own.map(str::to_owned).to_vec();
    let joints = joint_names(robot);
    for kind in ["q", "qd", "tau", "q_plan"] {
        columns.extend(joints.iter().map(|name| format!("{kind}_{name}")));
    }
    for kind in ["f", "f_plan", "f_command"] {
        for foot in foot_names(robot) {
            columns.extend(["x", "y", "z"].map(|axis| format!("{kind}_{foot}_{axis}")));
        }
    }
    let rows = samples.iter().map(|s| {
        let numbers = s
            .position
            .iter()
            .chain(s.orientation.coords.iter())
            .chain(s.velocity_w.iter())
            .chain(s.omega_b.iter())
            .chain(s.com.iter())
            .chain(&s.joints)
            .chain(&s.joint_velocities)
            .chain(&s.torques)
            .chain(&s.planned_joints)
            .chain(s.forces_w.iter().take(FOOT_COUNT).flat_map(|f| f.iter()))
            .chain(s.planned_forces_w.iter().flat_map(|f| f.iter()))
            .chain(s.commanded_forces_w.iter().flat_map(|f| f.iter()));
        (s.time, s.phase, numbers.copied().collect())
    });
    Log::new(columns, rows)
}
