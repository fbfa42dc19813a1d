//! What is kept of a run: one sample per millisecond.

use super::{JOINTS, ROBOT};
use crate::log::Log;
use jump_control::Phase;
use nalgebra::{UnitQuaternion, Vector3};
use rbd_core::{Model, Motion};

/// One sample.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Of the jump, s: negative before the push-off.
    pub time: f64,
    /// Of the machine.
    pub phase: Phase,
    /// Of the base in the world, m.
    pub position: Vector3<f64>,
    /// Of the base in the world.
    pub orientation: UnitQuaternion<f64>,
    /// Linear and angular, base axes: m/s, rad/s.
    pub base_velocity: Motion<f64>,
    /// Centre of mass in the world, m.
    pub com: Vector3<f64>,
    /// Its velocity, world axes, m/s.
    pub com_velocity: Vector3<f64>,
    /// Height that the push-off's reference asks for.
    pub wanted_height: f64,
    /// Angular momentum about the centre of mass.
    pub momentum: Vector3<f64>,
    /// Angular velocity of the locked robot.
    pub locked: Vector3<f64>,
    /// Positions, rad.
    pub joints: [f64; JOINTS],
    /// Speeds, rad/s.
    pub joint_velocities: [f64; JOINTS],
    /// What the motors gave, N m.
    pub torques: [f64; JOINTS],
    /// Force on each sole.
    pub forces_w: [Vector3<f64>; 2],
    /// Height of the lowest corner of both soles.
    pub clearance: f64,
    /// By how much the floor has moved upwards, m.
    pub floor: f64,
}

impl Sample {
    /// Pitch of the base, degrees: positive when it leans forward.
    #[must_use]
    pub fn pitch_deg(&self) -> f64 {
        // The base's x axis points backwards: it rises when the robot leans forward.
        let back = self.orientation * Vector3::x();
        so3::math::atan2(back.z, so3::math::hypot(back.x, back.y)).to_degrees()
    }
}

/// The samples as a table.
pub fn table(samples: &[Sample]) -> Log {
    let own = [
        "x",
        "y",
        "z",
        "qx",
        "qy",
        "qz",
        "qw",
        "vx",
        "vy",
        "vz",
        "wx",
        "wy",
        "wz",
        "com_x",
        "com_y",
        "com_z",
        "com_vx",
        "com_vy",
        "com_vz",
        "com_z_plan",
        "h_x",
        "h_y",
        "h_z",
        "locked_x",
        "locked_y",
        "locked_z",
    ];
    let mut columns = own.map(str::to_owned).to_vec();
    for kind in ["q", "qd", "tau"] {
        let names = Model::<f64, JOINTS>::joint_names(&ROBOT);
        columns.extend(names.iter().map(|name| format!("{kind}_{name}")));
    }
    for foot in ["left", "right"] {
        columns.extend(["x", "y", "z"].map(|axis| format!("f_{foot}_{axis}")));
    }
    columns.push("clearance".to_owned());
    let rows = samples.iter().map(|s| {
        let base_velocity = s.base_velocity.to_array();
        let numbers = s
            .position
            .iter()
            .chain(s.orientation.coords.iter())
            .chain(&base_velocity)
            .chain(s.com.iter())
            .chain(s.com_velocity.iter())
            .chain(core::iter::once(&s.wanted_height))
            .chain(s.momentum.iter())
            .chain(s.locked.iter())
            .chain(&s.joints)
            .chain(&s.joint_velocities)
            .chain(&s.torques)
            .chain(s.forces_w.iter().flat_map(|f| f.iter()))
            .chain(core::iter::once(&s.clearance));
        (s.time, s.phase, numbers.copied().collect())
    });
    Log::new(columns, rows)
}
