//! A jump of a humanoid, measured for its verdict.
//!
//! The plan is paper B's: the centre of mass rises from the squat on a vertical line, flies up by the height asked for, and falls until the
//! legs of the landing posture reach the ground; without angular momentum (II-C) the base keeps the orientation that puts its soles
//! flat. The goal is to stand where the jump began, in the landing posture ("during the landing phase the robot configuration is not
//! changed", III-C). Limits were fixed before anything was measured by them.

use super::execute::{Run, SETTLE};
use super::log::Sample;
use super::{
    State, Task, com, flight_time, landing_posture, middle_of_soles, on_the_floor, poses, squat,
};
use crate::verdict::{Failure, Flight, Limits, Stand, Verdict};
use jump_control::Phase;
use nalgebra::{Rotation3, Vector3};
use rbd_core::Transform;

/// How far a jump on the spot may be off, which is less than a jump to another place may.
///
/// Position: a fifth of the sole's length, 0.16 m; a fall that is farther off ends at the soles' edge. Feet: a third of it. Height and
/// angles: as for every robot.
const LIMITS: Limits = Limits {
    position: 0.03,
    feet: 0.05,
    ..Limits::GENERAL
};
/// Largest error of the height gained, and largest lack of clearance under the soles, m: an eighth of paper B's 4 cm.
pub const GAIN: f64 = 0.005;
/// Tilt of the base up to which the robot counts as upright, degrees: the squat itself leans by 17°.
const UPRIGHT: f64 = 30.0;
/// Least force on each sole of a robot that stands on both, N.
const STANDING: f64 = 20.0;
/// Largest speed of the centre of mass of a robot that stands, m/s.
const RESTING: f64 = 0.1;

/// A run with its verdict and what else is told of it.
pub struct Judged {
    /// The verdict.
    pub verdict: Verdict,
    /// Touched down, and the machine says that the robot is on its feet.
    pub landed: bool,
    /// Stands in the end.
    pub upright: bool,
    /// Apex of the centre of mass less its height at the loss of contact, m.
    pub com_gain: f64,
    /// The same less its height at the planned take-off.
    pub com_gain_nominal: f64,
    /// Largest height of the lowest corner of the soles, m.
    pub sole_clearance: f64,
    /// Integral of the locked angular velocity in flight, degrees.
    pub locked_rotation: f64,
    /// Change of the base's pitch from the loss of contact to the touchdown, degrees.
    pub pitch_change: f64,
    /// Vertical speed of the centre of mass at the loss of contact, m/s.
    pub takeoff_speed: f64,
    /// No joint beyond its position, speed or torque limit in the push-off.
    pub within_limits: bool,
}

/// Angle between two rotations, degrees.
fn between(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    so3::log(&(a.inverse() * b)).norm().to_degrees()
}

/// Beside the plan at its touchdown; `None` for a run that ended before.
fn flight(task: &Task, samples: &[Sample]) -> Option<Flight> {
    let profile = task.profile().ok()?;
    let (start, landing) = (on_the_floor(squat()), on_the_floor(landing_posture()));
    let first = com(&start);
    let touchdown = profile.duration + flight_time(&profile, first.z);
    let sample = samples.iter().find(|s| s.time >= touchdown)?;
    // After its end the profile goes on as a throw.
    let planned = first + Vector3::z() * profile.at(touchdown).rise;
    let pairs = sample.joints.iter().zip(&landing.joints);
    let joints = pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
    Some(Flight {
        time: sample.time,
        position: (sample.com - planned).norm(),
        rotation: between(
            &landing.base.rotation,
            &sample.orientation.to_rotation_matrix(),
        ),
        joints: joints.to_degrees(),
    })
}

/// Beside the landing posture on the spot of the start, at `time`.
fn stand(run: &Run, time: f64) -> Option<Stand> {
    let sample = run.samples.iter().find(|s| s.time >= time)?;
    let (start, goal) = (on_the_floor(squat()), on_the_floor(landing_posture()));
    let rotation = sample.orientation.to_rotation_matrix();
    let here = State {
        base: Transform::new(rotation, sample.position),
        joints: sample.joints,
    };
    let feet = middle_of_soles(&poses(&here)) - middle_of_soles(&poses(&start));
    let turned = goal.base.rotation.inverse() * rotation;
    let ahead = rotation * goal.base.rotation.inverse() * Vector3::x();
    Some(Stand {
        time: sample.time,
        feet: so3::math::hypot(feet.x, feet.y),
        heading: so3::math::atan2(ahead.y, ahead.x).abs().to_degrees(),
        // Over the ground that is there, which may be another than the plan's.
        height: (sample.position.z - goal.base.translation.z - run.ground_height).abs(),
        rotation: so3::log(&turned).norm().to_degrees(),
        upright: stands(sample) && on_feet(run.final_phase),
    })
}

/// Upright, on both soles and at rest.
fn stands(s: &Sample) -> bool {
    let up = s.orientation * Vector3::z();
    let tilt = so3::math::atan2(so3::math::hypot(up.x, up.y), up.z).to_degrees();
    let loaded = s.forces_w.iter().all(|f| f.z > STANDING);
    tilt < UPRIGHT && loaded && s.com_velocity.norm() < RESTING
}

/// The controller says that the robot is on its feet.
const fn on_feet(phase: Phase) -> bool {
    matches!(phase, Phase::Landing | Phase::Stand)
}

impl Judged {
    /// Measures and judges a run.
    #[must_use]
    pub fn of(task: &Task, run: &Run) -> Self {
        let samples = &run.samples;
        let at = |time: f64| samples.iter().find(|s| s.time >= time - 1e-9);
        let loss = run.contact_loss.unwrap_or(f64::NAN);
        let end = run.touchdown.unwrap_or(loss);
        let flying: Vec<&Sample> = samples
            .iter()
            .filter(|s| s.time >= loss && s.time <= end)
            .collect();
        let highest = |f: &dyn Fn(&Sample) -> f64| flying.iter().map(|s| f(s)).fold(0.0, f64::max);
        let apex = highest(&|s| s.com.z);
        let height = |time| at(time).map_or(f64::NAN, |s: &Sample| s.com.z);
        let turned: Vector3<f64> = flying.iter().map(|s| s.locked * 1e-3).sum();
        let pitch = |time| at(time).map_or(f64::NAN, Sample::pitch_deg);
        let com_gain = apex - height(loss);
        let sole_clearance = highest(&|s| s.clearance);
        let stand = run.touchdown.and_then(|t| stand(run, t + SETTLE));
        let gravest = failures(task, run, com_gain, sole_clearance);
        let found = run.hardware.found(&[]);
        Self {
            upright: stand.is_some_and(|s| s.upright),
            verdict: Verdict::within(&LIMITS, flight(task, samples), stand, found, gravest),
            landed: run.touchdown.is_some() && on_feet(run.final_phase),
            com_gain,
            com_gain_nominal: apex - height(run.takeoff),
            sole_clearance,
            locked_rotation: turned.norm().to_degrees(),
            pitch_change: pitch(end) - pitch(loss),
            takeoff_speed: at(loss).map_or(f64::NAN, |s| s.com_velocity.z),
            within_limits: run.launch.position <= 1.0
                && run.launch.speed <= 1.0
                && run.launch.torque <= 1.0 + 1e-9,
        }
    }
}

/// What fails beside the common measures.
fn failures(task: &Task, run: &Run, com_gain: f64, sole_clearance: f64) -> Vec<Failure> {
    let end = run.samples.last().map_or(0.0, |s| s.time);
    let Some(touchdown) = run.touchdown else {
        let (name, found) = match run.contact_loss {
            None => ("no_takeoff", "the soles did not leave the ground"),
            Some(_) => ("no_touchdown", "the ground did not come"),
        };
        return vec![Failure::new(end, name, found)];
    };
    let mut out = Vec::new();
    let error = (com_gain - task.height).abs();
    if error > GAIN || error.is_nan() {
        let found = format!("{com_gain:.4} of {} m", task.height);
        out.push(Failure::new(touchdown, "flight.com_gain_m", found));
    }
    let least = task.height - GAIN;
    if sole_clearance < least {
        let found = format!("{sole_clearance:.4} of {least:.4} m");
        out.push(Failure::new(touchdown, "flight.sole_clearance_m", found));
    }
    out
}
