//! What is kept of a run: one sample per millisecond.

use super::{FOOT_COUNT, JOINTS, OWNERS};
use crate::log::Log;
use jump_control::Phase;
use jump_planner::robot::Quadruped;
use jump_planner::stored::joint_name;
use nalgebra::{UnitQuaternion, Vector3};

/// One sample.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) time: f64,
    pub(crate) phase: Phase,
    pub(crate) position: Vector3<f64>,
    pub(crate) orientation: UnitQuaternion<f64>,
    pub(crate) velocity_w: Vector3<f64>,
    pub(crate) omega_b: Vector3<f64>,
    pub(crate) com: Vector3<f64>,
    pub(crate) joints: [f64; JOINTS],
    pub(crate) joint_velocities: [f64; JOINTS],
    pub(crate) torques: [f64; JOINTS],
    pub(crate) forces_w: [Vector3<f64>; OWNERS],
    pub(crate) planned_position: Vector3<f64>,
    pub(crate) planned_joints: [f64; JOINTS],
    pub(crate) planned_forces_w: [Vector3<f64>; FOOT_COUNT],
    /// What the landing's quadratic program commanded in this millisecond; zero where there was none.
    pub(crate) commanded_forces_w: [Vector3<f64>; FOOT_COUNT],
}

/// Short names of the feet: the places of their legs.
pub(crate) fn foot_names(robot: &Quadruped) -> [&'static str; FOOT_COUNT] {
    core::array::from_fn(|leg| robot.place(leg))
}

/// Short joint names: `FL_hip` and so on.
pub(crate) fn joint_names(robot: &Quadruped) -> [String; JOINTS] {
    core::array::from_fn(|i| joint_name(robot, i))
}

/// The samples as a table.
pub(crate) fn table(robot: &Quadruped, samples: &[Sample]) -> Log {
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
