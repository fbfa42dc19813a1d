//! A jump of a rigid body planned on 30 intervals, contact timings included, and planned again from the plan.

use core::ops::ControlFlow;

use ocp_solver::{Settings, Solution};
use srb_opt::onboard::{Workspace, example};

use crate::{Real, Recorder, Subject};

/// The numbers of a solution.
fn listed<T: Real>(solution: &Solution<T>) -> ((T, T), T) {
    (
        (solution.cost, solution.violation),
        T::of(solution.iterations as f64),
    )
}

pub(super) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    let mut problem = example::<T>();
    on.call("Problem::check", &problem, |p| p.check().is_ok());
    let settings = Settings::new();
    let mut workspace = Workspace::new();
    on.call("plan", (&problem, &mut workspace), |(p, ws)| {
        ws.plan(p, &settings, |_| ControlFlow::Continue(()))
            .map(|s| listed(&s))
            .ok()
    });
    // The goal has moved by 2 cm.
    problem.goal_w.y += T::of(0.02);
    let mut warm = settings;
    warm.warm_start = true;
    on.call("re-plan", (&problem, &mut workspace), |(p, ws)| {
        ws.replan(p, &warm, |_| ControlFlow::Continue(()))
            .map(|s| listed(&s))
            .ok()
    });
    let input = (&problem, &workspace);
    on.call("Problem::judge", input, |(p, ws)| {
        let nodes = ws.nodes(p).iter().map(|node| (&node.state, &node.control));
        let judged = p.judge(nodes);
        (judged.cost, judged.max_violation)
    });
    for (k, node) in workspace.nodes(&problem).iter().enumerate() {
        let input = (&problem, node);
        on.call("Problem::sample", input, |(p, node)| {
            let sample = p.sample(k, &node.state, &node.control);
            ((node.state.pos_w, node.state.rot_wb), sample.forces_w)
        });
    }
}
