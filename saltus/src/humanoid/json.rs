//! A run of a humanoid as JSON.

use crate::plant;
use jump_lab::humanoid::Task;
use jump_lab::humanoid::execute::Run;
use jump_lab::humanoid::judge::Judged;
use jump_lab::lab::{Disturbance, Interface};
use serde_json::{Value, json};

/// The object of `--json`.
pub(crate) fn json(
    judged: &Judged,
    task: &Task,
    run: &Run,
    (sim, seed): (&str, u64),
    disturbance: &Disturbance,
) -> Value {
    json!({
        "task": task.name(),
        "sim": sim,
        "seed": seed,
        "interface": Interface::Torque.to_string(),
        "plant": plant::json(disturbance),
        "on_target": judged.verdict.on_target(),
        "verdict": judged.verdict.json(),
        "momentum_control": task.momentum,
        "height_m": task.height,
        "landed": judged.landed,
        "upright": judged.upright,
        "com_gain_m": judged.com_gain,
        "com_gain_nominal_m": judged.com_gain_nominal,
        "sole_clearance_m": judged.sole_clearance,
        "takeoff_speed_m_s": judged.takeoff_speed,
        "takeoff_speed_wanted_m_s": run.wanted_speed,
        "locked_rotation_deg": judged.locked_rotation,
        "pitch_change_deg": judged.pitch_change,
        "planned_takeoff_s": run.takeoff,
        "contact_loss_s": run.contact_loss,
        "first_contact_s": run.touchdown,
        "within_limits_in_launch": judged.within_limits,
        "launch_usage": {
            "position": run.launch.position,
            "speed": run.launch.speed,
            "torque": run.launch.torque,
        },
        "landing": {
            "controller": task.landing.name(),
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
