//! A run of a humanoid for people.

use crate::report::Line;
use crate::verdict;
use jump_control::takeoff_speed;
use jump_lab::humanoid::execute::Run;
use jump_lab::humanoid::judge::{GAIN, Judged};
use jump_lab::humanoid::{GRAVITY, Task};
use jump_lab::lab::Disturbance;

/// The result for people.
pub(crate) fn table(
    judged: &Judged,
    task: &Task,
    run: &Run,
    sim: &str,
    disturbance: &Disturbance,
) -> Vec<Line> {
    let cm = |x: f64| format!("{:.2} cm", 100.0 * x);
    // Paper B, II-D: v = sqrt(2 g (h_p - h_to)).
    let from_gain = takeoff_speed(judged.com_gain.max(0.0), GRAVITY);
    let nominal = *disturbance == Disturbance::NOMINAL;
    let plant = if nominal {
        "nominal".to_owned()
    } else {
        disturbance.to_string()
    };
    let mut lines = vec![("task", format!("{}, {sim} simulator", task.name()), None)];
    lines.extend(verdict::lines(&judged.verdict));
    lines.push(("plant", plant, None));
    lines.push((
        "gain of the CoM",
        format!(
            "{} of {} asked for; paper B: 3.5 by velocity, 1.6 by torque, 3 on the robot (figure 4)",
            cm(judged.com_gain),
            cm(task.height)
        ),
        Some((judged.com_gain - task.height).abs() <= GAIN),
    ));
    lines.push((
        "clearance of the soles",
        cm(judged.sole_clearance),
        Some(judged.sole_clearance >= task.height - GAIN),
    ));
    lines.push((
        "take-off speed",
        format!(
            "{:.3} m/s; from the flight √(2 g (h_p − h_to)) = {from_gain:.3}; wanted {:.3}",
            judged.takeoff_speed, run.wanted_speed
        ),
        Some((judged.takeoff_speed - from_gain).abs() < 0.02),
    ));
    lines.extend(details(judged, run));
    lines
}

/// What else is told of a run.
fn details(judged: &Judged, run: &Run) -> [Line; 4] {
    let usage = run.launch.position.max(run.launch.speed);
    [
        (
            "locked rotation in flight",
            format!(
                "{:.2}°; the base pitches by {:.1}°",
                judged.locked_rotation, judged.pitch_change
            ),
            Some(judged.locked_rotation < 1.5),
        ),
        (
            "limits in the launch",
            format!(
                "{:.2} of position or speed, {:.2} of torque",
                usage, run.launch.torque
            ),
            Some(judged.within_limits),
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
