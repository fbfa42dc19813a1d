//! What a run achieved, as numbers.

use super::execute::{Run, SETTLE};
use super::log::Sample;
use super::{GRAVITY, Task};
use crate::report::Line;
use crate::verdict;
use jump_control::{Phase, takeoff_speed};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Tilt of the base up to which the robot counts as upright, degrees: the squat itself leans by 17°.
const UPRIGHT: f64 = 30.0;

/// The verdict on one run.
pub(crate) struct Verdict {
    pub(crate) landed: bool,
    pub(crate) upright: bool,
    /// Apex of the centre of mass less its height at the loss of contact, m.
    pub(crate) com_gain: f64,
    /// The same less its height at the planned take-off.
    pub(crate) com_gain_nominal: f64,
    /// Largest height of the lowest corner of the soles, m.
    pub(crate) sole_clearance: f64,
    /// Integral of the locked angular velocity in flight, degrees.
    pub(crate) locked_rotation: f64,
    /// Change of the base's pitch from the loss of contact to the touchdown, degrees.
    pub(crate) pitch_change: f64,
    /// Vertical speed of the centre of mass at the loss of contact, m/s.
    pub(crate) takeoff_speed: f64,
    /// End of the run, s.
    pub(crate) time: f64,
    /// No joint beyond its position, speed or torque limit in the push-off.
    pub(crate) within_limits: bool,
}

impl Verdict {
    /// Judges a run.
    pub(crate) fn of(run: &Run) -> Self {
        let samples = &run.samples;
        let at = |time: f64| samples.iter().find(|s| s.time >= time - 1e-9);
        let loss = run.contact_loss.unwrap_or(f64::NAN);
        let end = run.touchdown.unwrap_or(loss);
        let flight: Vec<&Sample> = samples
            .iter()
            .filter(|s| s.time >= loss && s.time <= end)
            .collect();
        let highest = |f: &dyn Fn(&Sample) -> f64| flight.iter().map(|s| f(s)).fold(0.0, f64::max);
        let apex = highest(&|s| s.com.z);
        let height = |time| at(time).map_or(f64::NAN, |s: &Sample| s.com.z);
        let turned: Vector3<f64> = flight.iter().map(|s| s.locked * 1e-3).sum();
        let pitch = |time| at(time).map_or(f64::NAN, Sample::pitch_deg);
        let later = run.touchdown.and_then(|t| at(t + SETTLE));
        let upright = later.is_some_and(|s| {
            let up = s.orientation * Vector3::z();
            let tilt = so3::math::atan2(so3::math::hypot(up.x, up.y), up.z).to_degrees();
            tilt < UPRIGHT && s.forces_w.iter().all(|f| f.z > 20.0) && s.com_velocity.norm() < 0.1
        });
        Self {
            landed: run.touchdown.is_some()
                && matches!(run.final_phase, Phase::Landing | Phase::Stand),
            upright,
            com_gain: apex - height(loss),
            com_gain_nominal: apex - height(run.takeoff),
            sole_clearance: highest(&|s| s.clearance),
            locked_rotation: turned.norm().to_degrees(),
            pitch_change: pitch(end) - pitch(loss),
            takeoff_speed: at(loss).map_or(f64::NAN, |s| s.com_velocity.z),
            time: samples.last().map_or(0.0, |s| s.time),
            within_limits: run.launch.position <= 1.0
                && run.launch.speed <= 1.0
                && run.launch.torque <= 1.0 + 1e-9,
        }
    }

    /// Within half a centimetre of the height asked for (at 4 cm: 3.5 to 4.5), soles likewise up, upright, within limits.
    pub(crate) fn on_target(&self, task: &Task) -> bool {
        self.landed
            && self.upright
            && self.within_limits
            && (self.com_gain - task.height).abs() <= 0.005
            && self.sole_clearance >= task.height - 0.005
    }

    /// As the tables of all robots have it.
    pub(crate) fn common(&self, task: &Task) -> verdict::Verdict {
        let end = self.time;
        let height = (self.com_gain - task.height).abs();
        let checks = [
            (
                self.landed,
                "no_touchdown",
                "the ground did not come, or a fault".to_owned(),
            ),
            (
                self.within_limits,
                "launch.limits",
                "a joint left its limits".to_owned(),
            ),
            (
                height <= 0.005,
                "flight.com_gain_m",
                format!("{:.4} of {} m", self.com_gain, task.height),
            ),
            (
                self.sole_clearance >= task.height - 0.005,
                "flight.sole_clearance_m",
                format!("{:.4} of {} m", self.sole_clearance, task.height - 0.005),
            ),
            (self.upright, "stand.upright", "fell".to_owned()),
        ];
        let failed = checks.into_iter().filter(|(good, ..)| !good);
        let failures = failed.map(|(_, name, found)| verdict::Failure::new(end, name, found));
        verdict::Verdict::new(None, None, Default::default(), failures.collect())
    }

    /// The result for people.
    pub(crate) fn table(&self, task: &Task, run: &Run, sim: &str) -> Vec<Line> {
        let yes = |b: bool| if b { "yes" } else { "NO" }.to_owned();
        let cm = |x: f64| format!("{:.2} cm", 100.0 * x);
        // Paper B, II-D: v = sqrt(2 g (h_p - h_to)).
        let from_gain = takeoff_speed(self.com_gain.max(0.0), GRAVITY);
        let usage = run.launch.position.max(run.launch.speed);
        vec![
            ("task", format!("{}, {sim} simulator", task.name()), None),
            ("landed", yes(self.landed), Some(self.landed)),
            ("upright after 2 s", yes(self.upright), Some(self.upright)),
            (
                "gain of the CoM",
                format!(
                    "{} of {} asked for; paper B: 3.5 by velocity, 1.6 by torque, 3 on the robot (figure 4)",
                    cm(self.com_gain),
                    cm(task.height)
                ),
                Some((self.com_gain - task.height).abs() <= 0.005),
            ),
            (
                "clearance of the soles",
                cm(self.sole_clearance),
                Some(self.sole_clearance >= task.height - 0.005),
            ),
            (
                "take-off speed",
                format!(
                    "{:.3} m/s; from the flight √(2 g (h_p − h_to)) = {from_gain:.3}; wanted {:.3}",
                    self.takeoff_speed, run.wanted_speed
                ),
                Some((self.takeoff_speed - from_gain).abs() < 0.02),
            ),
            (
                "locked rotation in flight",
                format!(
                    "{:.2}°; the base pitches by {:.1}°",
                    self.locked_rotation, self.pitch_change
                ),
                Some(self.locked_rotation < 1.5),
            ),
            (
                "limits in the launch",
                format!(
                    "{:.2} of position or speed, {:.2} of torque",
                    usage, run.launch.torque
                ),
                Some(self.within_limits),
            ),
            (
                "landing",
                format!(
                    "asks for {:.2} of a torque limit at most, {:.1} ms beyond; ground {:.0} N",
                    run.landing_demand,
                    1e3 * run.landing_saturation,
                    run.peak_force
                ),
                None,
            ),
            (
                "programs",
                format!(
                    "{} solved, {} failed, {} ticks relaxed, {} iterations at most",
                    run.qp.solves, run.qp.failures, run.qp.relaxed_ticks, run.qp.max_iterations
                ),
                Some(run.qp.failures == 0),
            ),
        ]
    }

    /// The object of `--json`.
    pub(crate) fn json(&self, task: &Task, run: &Run, seed: u64, sim: &str) -> Value {
        json!({
            "task": task.name(),
            "sim": sim,
            "seed": seed,
            "momentum_control": task.momentum,
            "height_m": task.height,
            "landed": self.landed,
            "upright": self.upright,
            "com_gain_m": self.com_gain,
            "com_gain_nominal_m": self.com_gain_nominal,
            "sole_clearance_m": self.sole_clearance,
            "takeoff_speed_m_s": self.takeoff_speed,
            "takeoff_speed_wanted_m_s": run.wanted_speed,
            "locked_rotation_deg": self.locked_rotation,
            "pitch_change_deg": self.pitch_change,
            "planned_takeoff_s": run.takeoff,
            "contact_loss_s": run.contact_loss,
            "first_contact_s": run.touchdown,
            "within_limits_in_launch": self.within_limits,
            "launch_usage": {
                "position": run.launch.position,
                "speed": run.launch.speed,
                "torque": run.launch.torque,
            },
            "landing": {
                "controller": format!("{:?}", task.landing).to_lowercase(),
                "torque_usage": run.landing_torque,
                "torque_demand": run.landing_demand,
                "saturation_ms": 1e3 * run.landing_saturation,
            },
            "estimate_error": {
                "position_m": run.estimate_error[0],
                "orientation_deg": run.estimate_error[1].to_degrees(),
            },
            "peak_torque_nm": run.peak_torque,
            "peak_foot_force_n": run.peak_force,
            "qp": {
                "solves": run.qp.solves,
                "failures": run.qp.failures,
                "max_iterations": run.qp.max_iterations,
                "relaxed_ticks": run.qp.relaxed_ticks,
                "max_com_residual": run.qp.residuals.com,
                "max_momentum_residual": run.qp.residuals.momentum,
            },
        })
    }
}
