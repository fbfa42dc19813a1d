//! A jump in one picture: poses side by side, seen along the axis about which the body turns.

use super::report::{moment, scene};
use crate::strip;
use jump_lab::lab::Disturbance;
use jump_lab::quadruped::execute::Run;
use jump_planner::task::Task;
use nalgebra::Vector3;

/// The picture as SVG.
pub(crate) fn svg(task: &Task, run: &Run, disturbance: &Disturbance, takeoff: f64) -> String {
    let touched = run.first_contact.unwrap_or(takeoff + 0.5);
    let shown = strip::spread(&run.samples, |s| s.time, [takeoff, touched]);
    let moments: Vec<_> = shown.iter().map(|s| moment(&task.robot, s)).collect();
    strip::svg(&scene(task, disturbance), &moments, &across(task))
}

/// The horizontal direction of the picture: across the axis of the turn, else along the jump.
fn across(task: &Task) -> Vector3<f64> {
    let axis = task.problem.axis;
    let is_turn = task.problem.angle != 0.0;
    let sideways = if is_turn && axis.z.abs() < 0.5 {
        axis.x.abs() > axis.y.abs()
    } else {
        task.goal.y.abs() > task.goal.x.abs()
    };
    if sideways { Vector3::y() } else { Vector3::x() }
}
