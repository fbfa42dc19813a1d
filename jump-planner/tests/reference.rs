//! The kinematic reference along a plan of the rigid body.

use jump_planner::reference::build;
use jump_planner::state;
use jump_planner::task::Task;

/// The reference meets the plan's centre of mass and its feet stay where they roll.
#[test]
fn the_lateral_reference_follows_its_plan() {
    let task = Task::load("a1/lateral").unwrap();
    let plan = task.solve().unwrap();
    let reference = build(&task, &plan).unwrap();
    assert!(
        reference.base_residual < 1e-3,
        "{}",
        reference.base_residual
    );
    // Between its nodes it goes from one to the next, and at its ends it stays.
    let pose = |time: f64| reference.pose(time).unwrap();
    for pair in reference.nodes.windows(2) {
        let [(a, _), (b, _)] = [state(&pair[0]), state(&pair[1])];
        let middle = pose(0.5 * (pair[0].time + pair[1].time));
        let both = [&a, &b].map(|q| (middle.base.translation - q.base.translation).norm());
        let way = (b.base.translation - a.base.translation).norm();
        assert!((both[0] - both[1]).abs() < 1e-3 * way.max(1e-3), "{both:?}");
        assert!((pose(pair[1].time).joints[0] - b.joints[0]).abs() < 1e-12);
    }
    let ends = [reference.nodes.first(), reference.nodes.last()];
    let ends = ends.map(|node| state(node.unwrap()).0);
    assert!((pose(-9.0).base.translation - ends[0].base.translation).norm() < 1e-12);
    assert!((pose(9.0).base.translation - ends[1].base.translation).norm() < 1e-12);
    let stance = reference
        .nodes
        .iter()
        .filter(|n| n.time >= 0.0 && n.time < reference.takeoff);
    for (node, stage) in stance.zip(&plan.stages) {
        let (q, _) = state(node);
        assert!((task.robot.com(&q) - stage.state.pos_w).norm() < 2e-3);
        let kinematics = task.robot.poses(&q);
        for leg in 0..4 {
            let point = kinematics
                .frame(&task.robot.contact_frame(&kinematics, leg))
                .translation;
            assert!(
                point.z.abs() < 1e-3,
                "foot {leg} leaves the ground: {point}"
            );
        }
    }
    assert!(reference.peak_torque < 33.5);
}
