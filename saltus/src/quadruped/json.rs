//! A run of a quadruped as JSON.

use crate::plant;
use jump_lab::quadruped::execute::{Run, Trial};
use jump_lab::quadruped::judge::Judged;
use jump_planner::reference::Reference;
use jump_planner::task::{SrbPlan, Task};
use serde_json::{Value, json};

/// The object of `--json`; a stored plan comes without its single rigid body.
pub(crate) fn json(
    judged: &Judged,
    task: &Task,
    plan: Option<&SrbPlan>,
    reference: &Reference,
    run: &Run,
    trial: &Trial<'_>,
) -> Value {
    let verdict = &judged.verdict;
    let found = &verdict.hardware;
    let stand = verdict.stand;
    let mut out = json!({
        "task": task.name,
        "sim": trial.sim.name(),
        "seed": trial.seed,
        "interface": trial.interface.to_string(),
        "robot": task.robot.name,
        "placeholders": task.robot.placeholders(),
        "plant": plant::json(&trial.disturbance.on_ground(task.limits.friction)),
        "on_target": verdict.on_target(),
        "verdict": verdict.json(),
        "landed": judged.landed,
        "upright": verdict.stands(),
        "upright_after_s": judged.upright_after,
        "final_position_error_m": stand.map(|s| s.feet),
        "final_orientation_error_deg": stand.map(|s| s.rotation),
        "touchdown_orientation_error_deg": judged.touchdown_rotation,
        "apex_height_m": judged.apex,
        "first_contact_s": run.first_contact,
        "peak_torque_nm": run.peak_torque,
        "torque_saturation_ms": found.saturation[0] * 1e3,
        "landing_saturation_ms": found.saturation[2] * 1e3,
        "peak_foot_force_n": run.peak_foot_force,
        "trunk_contact": found.touched.contains(&"trunk"),
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
    });
    out["plan"] = plan_json(plan, reference);
    out["plan"]["crc32"] = json!(run.plan_checksum);
    out
}

/// What was planned.
fn plan_json(plan: Option<&SrbPlan>, reference: &Reference) -> Value {
    json!({
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
    })
}
