//! The whole way to a plan.

use core::ops::ControlFlow;
use jump_planner::audit::check_values;
use jump_planner::stored::open_for;
use jump_planner::task::{SrbPlan, Task};
use jump_planner::whole_body::WholeBodyPlan;
use jump_planner::{Options, Step, plan, replan, state};
use ocp_solver::{Progress, Status};
use rbd_core::{JointLimits, Model};

#[test]
fn a_task_near_another_is_planned_in_fewer_iterations_and_to_the_same_cost() {
    let go = |_, _: Option<&Progress<f64>>| ControlFlow::Continue(());
    let options = Options::default();
    let task = Task::load("a1/lateral").unwrap();
    let kept = plan(&task, &options, go).unwrap().kept.unwrap();
    let mut moved = task.clone();
    moved.goal.x += 0.1;
    moved.problem.goal_w.x += 0.1;
    let afar = plan(&moved, &options, go).unwrap();
    let near = replan(&moved, &kept, &options, go).unwrap();
    assert!(near.answer.is_none() && near.audit.unwrap().passes());
    assert_eq!(near.path.len(), 1);
    let cost = |out: &Option<WholeBodyPlan>| out.as_ref().unwrap().judged.cost;
    let (one, other) = (cost(&near.whole_body), cost(&afar.whole_body));
    assert!((one / other - 1.0).abs() < 1e-4, "{one} {other}");
    assert!(near.path[0].iterations < afar.path[0].iterations);
    let body = |out: Option<SrbPlan>| out.unwrap().iterations;
    assert!(2 * body(near.srb) < body(afar.srb));
    // What has other phases is planned as if there were nothing.
    assert!(!kept.is_of_phases(&Task::load("a1/diagonal").unwrap()));
}

/// With as little torque as the first try has there is no motion; on long intervals there is one with all of it, and with half of it
/// another is looked for: there the observer ends it.
#[test]
fn what_the_observer_ends_is_cancelled_whatever_was_found_before() {
    let mut task = Task::load("a1/lateral").unwrap();
    task.limits.torque_shares = [0.05, 0.8, 1.0];
    let mut solves = 0;
    let observe = |step, progress: Option<&Progress<f64>>| {
        let begins = progress.is_some_and(|progress| progress.iteration == 0);
        solves += usize::from(step == Step::WholeBody && begins);
        if solves < 3 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    // On one thread the search on long intervals begins after the first try and not beside it.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1);
    let out = alone
        .build()
        .unwrap()
        .install(|| plan(&task, &Options::default(), observe))
        .unwrap();
    let ended: Vec<_> = out.path.iter().map(|solve| solve.status).collect();
    assert_eq!(ended, [Status::Stalled, Status::Solved, Status::Cancelled]);
    assert_eq!(out.answer.unwrap().status, "Cancelled");
    assert!(out.bytes.is_empty());
}

/// What the planner calls solved is not damaged for who opens it, and its knees, which go to their stops without a margin, leave what a lab takes.
#[test]
fn what_passes_the_audit_is_opened_again_and_its_joints_keep_away_from_their_stops() {
    let task = Task::load("a1/double-barrel-roll").unwrap();
    let out = plan(&task, &Options::default(), |_, _| ControlFlow::Continue(())).unwrap();
    assert!(out.audit.unwrap().is_a_motion());
    let stored = open_for(&out.bytes, &task.robot).unwrap();
    let limits = task.robot.limits();
    let beyond = |(limit, q): (&JointLimits<f64>, f32)| {
        let q = f64::from(q);
        (limit.lower - q).max(q - limit.upper)
    };
    let joints = stored
        .nodes()
        .flat_map(|node| limits.iter().zip(node.joints));
    let most = joints.map(beyond).fold(f64::NEG_INFINITY, f64::max);
    // Nodes are between the middles of intervals, where margins are kept: 0.1 rad.
    assert!(most < -0.08, "a joint is near its stop: {most}");
    check_values(&task.robot, &stored).unwrap();
}

/// What hovers a millimetre over the ground when it should be away is caught by ground that gives way, and turns the robot: feet go up at half a metre a
/// second at least, until they are a centimetre high.
#[test]
fn feet_leave_the_ground_at_once() {
    let go = |_, _: Option<&Progress<f64>>| ControlFlow::Continue(());
    let task = Task::load("a1/lateral-down").unwrap();
    let found = plan(&task, &Options::default(), go).unwrap();
    let stored = open_for(&found.bytes, &task.robot).unwrap();
    let takeoff = f64::from(stored.header().takeoff);
    let nodes = stored.nodes().map(|node| node.node());
    let leaving: Vec<_> = nodes
        .filter(|node| node.time > takeoff + 1e-6 && node.time < takeoff + 0.03)
        .collect();
    assert!(leaving.len() > 4);
    for node in leaving {
        let (q, _) = state(&node);
        let poses = task.robot.poses(&q);
        for foot in &task.robot.feet {
            let height = poses.frame(foot).translation.z - task.robot.foot_radius;
            let least = (0.5 * (node.time - takeoff)).min(0.01);
            // Rows hold in the middle of intervals.
            assert!(
                height > least - 1e-3,
                "{:.4} s: {height}",
                node.time - takeoff
            );
        }
    }
}
