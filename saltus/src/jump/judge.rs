//! What a run achieved, as numbers.

use super::execute::{Run, SETTLE};
use super::plant::Sim;
use super::reference::{Reference, heading_matrix};
use super::task::{SrbPlan, Task};
use jump_control::Phase;
use serde_json::{Value, json};

/// Tilt up to which the robot counts as upright, rad.
const UPRIGHT: f64 = 10.0 * core::f64::consts::PI / 180.0;

/// Largest angle between the base and its goal on target, degrees.
pub(crate) const ALLOWED_TURN: f64 = 10.0;

/// The verdict on one run.
pub(crate) struct Verdict {
    /// Touched down on its feet and never lost them to a fault.
    pub(crate) landed: bool,
    /// The trunk touched nothing, or the task allows that it does.
    pub(crate) trunk_is_right: bool,
    /// Tilt below 10° two seconds after touchdown.
    pub(crate) upright: bool,
    /// Time from touchdown until the tilt stays below 10°, s.
    pub(crate) upright_after: Option<f64>,
    /// Horizontal distance of the base from its goal at the end, m.
    pub(crate) position_error: f64,
    /// Angle between the base and its goal at the end, degrees.
    pub(crate) orientation_error: f64,
    /// The same angle at touchdown: what the jump itself missed, before the landing turns the robot on its feet.
    pub(crate) touchdown_orientation_error: Option<f64>,
    /// Largest height of the centre of mass, m.
    pub(crate) apex: f64,
}

impl Verdict {
    /// Judges a run.
    pub(crate) fn of(task: &Task, run: &Run) -> Self {
        let tilt = |s: &super::log::Sample| {
            let up = s.orientation * nalgebra::Vector3::z();
            so3::math::atan2(so3::math::hypot(up.x, up.y), up.z)
        };
        let landed_at = run.first_contact;
        let after = |time: f64| {
            run.samples
                .iter()
                .filter(move |s: &&super::log::Sample| s.time >= time)
        };
        let upright_after = landed_at.and_then(|t0| {
            let tilted = after(t0).rfind(|s| tilt(s) >= UPRIGHT);
            match tilted {
                None => Some(0.0),
                Some(s) => (s.time < run.samples.last()?.time - 0.2).then_some(s.time - t0),
            }
        });
        let last = landed_at
            .and_then(|t0| after(t0 + SETTLE).next())
            .or(run.samples.last());
        let turned = |s: &super::log::Sample| {
            let turn = heading_matrix(task.heading).inverse() * s.orientation.to_rotation_matrix();
            so3::log(&turn).norm().to_degrees()
        };
        let goal = task.start.base.translation + task.goal;
        let (position_error, orientation_error, upright) =
            last.map_or((f64::NAN, f64::NAN, false), |s| {
                let missed = s.position - goal;
                (
                    so3::math::hypot(missed.x, missed.y),
                    turned(s),
                    tilt(s) < UPRIGHT,
                )
            });
        Self {
            landed: landed_at.is_some() && matches!(run.final_phase, Phase::Landing | Phase::Stand),
            trunk_is_right: task.trunk_may_touch || !run.trunk_contact,
            upright,
            upright_after,
            position_error,
            orientation_error,
            touchdown_orientation_error: landed_at.and_then(|t| after(t).next()).map(turned),
            apex: run
                .samples
                .iter()
                .map(|s| s.com.z)
                .fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Landed, upright, trunk untouched where the task wants that, within 0.10 m and 10°.
    pub(crate) fn on_target(&self) -> bool {
        self.landed
            && self.trunk_is_right
            && self.upright
            && self.position_error <= 0.10
            && self.orientation_error <= ALLOWED_TURN
    }

    /// The object of `--json`; a stored plan comes without its single rigid body.
    pub(crate) fn json(
        &self,
        task: &Task,
        plan: Option<&SrbPlan>,
        reference: &Reference,
        run: &Run,
        sim: Sim,
        seed: u64,
    ) -> Value {
        json!({
            "task": task.name,
            "sim": sim.name(),
            "seed": seed,
            "landed": self.landed,
            "upright": self.upright,
            "upright_after_s": self.upright_after,
            "final_position_error_m": self.position_error,
            "final_orientation_error_deg": self.orientation_error,
            "touchdown_orientation_error_deg": self.touchdown_orientation_error,
            "apex_height_m": self.apex,
            "first_contact_s": run.first_contact,
            "peak_torque_nm": run.peak_torque,
            "torque_saturation_ms": run.push_off_saturation * 1e3,
            "landing_saturation_ms": run.landing_saturation * 1e3,
            "peak_foot_force_n": run.peak_foot_force,
            "trunk_contact": run.trunk_contact,
            "fault": run.fault.map(|fault| fault.to_string()),
            "estimate": {
                "max_position_error_m": run.estimate_errors[0],
                "max_rotation_error_deg": run.estimate_errors[1].to_degrees(),
            },
            "ticks": { "joint": run.ticks[0], "cartesian": run.ticks[1], "landing": run.ticks[2] },
            "qp": {
                "solves": run.qp_solves,
                "failures": run.qp_failures,
                "max_iterations": run.qp_max_iterations,
            },
            "plan": {
                "reference": reference.origin.name(),
                "durations_s": reference.durations,
                "whole_body": reference.origin.solved().map(|solved| json!({
                    "wall_ms": solved.wall_ms,
                    "iterations": solved.iterations,
                    "cost": solved.cost,
                    "max_violation": solved.max_violation,
                    "torque_limit_nm": solved.torque_limit,
                })),
                "solver_ms": plan.map(|plan| plan.wall_ms),
                "iterations": plan.map(|plan| plan.iterations),
                "violation": plan.map(|plan| plan.max_violation),
                "peak_torque_nm": reference.peak_torque,
                "peak_friction": reference.peak_friction,
                "base_residual": reference.base_residual,
            },
        })
    }
}
