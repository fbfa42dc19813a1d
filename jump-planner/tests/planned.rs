//! Planners beside that of whole bodies.

use jump_planner::planned::{Planner, peaks};
use jump_planner::task::Task;

/// The planner of whole bodies is tested where it stands.
#[test]
fn the_other_planners_make_plans_that_can_be_followed() {
    let task = Task::load("a1/lateral").unwrap();
    let srb = task.solve().unwrap();
    for planner in [Planner::RigidBody, Planner::Kinematics] {
        let reference = planner.plan(&task, &srb).unwrap();
        let [torque, _] = peaks(&reference.nodes, reference.takeoff);
        assert!(torque > 5.0, "{torque}");
        let speeds = reference.nodes.iter().flat_map(|n| n.joint_velocities);
        let fastest = speeds.fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(fastest < 40.0, "{fastest} rad/s, {}", planner.name());
    }
}
