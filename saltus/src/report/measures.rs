//! Curves that all robots have, in units that can be compared: a curve per run, and its plan.

use super::data::Plot;
use super::{COLORS, curve, plot};
use nalgebra::{UnitQuaternion, Vector3};

/// What is measured of a sample.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    /// Centre of mass in the world, m.
    pub(crate) com: Vector3<f64>,
    /// Of the base in the world.
    pub(crate) orientation: UnitQuaternion<f64>,
    /// Largest share of a joint's torque limit.
    pub(crate) torque: f64,
    /// Largest share of a joint's fastest speed.
    pub(crate) speed: f64,
    /// Normal force of the ground on all feet, in weights of the robot.
    pub(crate) force: f64,
}

/// The plan of it, not a number where nothing is planned.
#[derive(Clone, Copy)]
pub(crate) struct Planned {
    /// Centre of mass in the world, m.
    pub(crate) com: [f64; 3],
    /// Roll, pitch and yaw of the base, rad.
    pub(crate) angles: [f64; 3],
    /// Largest share of a joint's torque limit.
    pub(crate) torque: f64,
    /// Normal force of the ground on all feet, in weights of the robot.
    pub(crate) force: f64,
}

impl Planned {
    /// Nothing is planned.
    pub(crate) const NOTHING: Self = Self {
        com: [f64::NAN; 3],
        angles: [f64::NAN; 3],
        torque: f64::NAN,
        force: f64::NAN,
    };
}

/// Roll, pitch and yaw, rad.
pub(crate) fn angles(turn: &UnitQuaternion<f64>) -> [f64; 3] {
    let (roll, pitch, yaw) = turn.euler_angles();
    [roll, pitch, yaw]
}

/// The plots of the samples' measures; a plan that is nowhere has no curve.
pub(crate) fn measures(samples: &[(Measured, Planned)]) -> Vec<Plot> {
    type Of<'a> = &'a dyn Fn(&(Measured, Planned)) -> f64;
    let made = |title: &str, unit: &str, run: Of<'_>, plan: Of<'_>| {
        let mut series = vec![curve("run", COLORS[0], false, samples, run)];
        if samples.iter().any(|s| plan(s).is_finite()) {
            series.push(curve("plan", COLORS[0], true, samples, plan));
        }
        plot(title, unit, series)
    };
    let mut out = vec![made(
        "Height of the centre of mass",
        "m",
        &|s| s.0.com.z,
        &|s| s.1.com[2],
    )];
    for (i, title) in ["Centre of mass, x", "Centre of mass, y"]
        .iter()
        .enumerate()
    {
        out.push(made(title, "m", &|s| s.0.com[i], &|s| s.1.com[i]));
    }
    for (i, title) in ["Roll of the base", "Pitch of the base", "Yaw of the base"]
        .iter()
        .enumerate()
    {
        let run: Of<'_> = &|s| angles(&s.0.orientation)[i].to_degrees();
        out.push(made(title, "degrees", run, &|s| s.1.angles[i].to_degrees()));
    }
    out.push(made(
        "Largest torque of a joint, over its limit",
        "share",
        &|s| s.0.torque,
        &|s| s.1.torque,
    ));
    let speed = "Largest speed of a joint, over its limit";
    out.push(made(speed, "share", &|s| s.0.speed, &|_| f64::NAN));
    out.push(made(
        "Contact force on all feet, normal",
        "weights",
        &|s| s.0.force,
        &|s| s.1.force,
    ));
    out
}
