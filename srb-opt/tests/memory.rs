//! What a plan costs in memory, and that the smaller storage plans the same.

use crate::common::{NI, NU, NX, jump};
use core::mem::size_of;
use core::ops::ControlFlow;
use ocp_solver::{LeanStage, Settings, SparseStage, Stage, Status};
use srb_opt::onboard::{self, Workspace};
use srb_opt::{Error, State};

/// The sizes that the README states.
#[test]
fn a_plan_of_thirty_intervals_leaves_room_for_its_stack_in_512_kilobytes() {
    assert_eq!(size_of::<Workspace<f64>>(), 383_656);
    assert_eq!(
        31 * size_of::<Stage<f64, State<f64, 4>, NX, NU, NI>>(),
        947_608
    );
}

#[test]
fn a_jump_is_planned_and_replanned_in_a_workspace() {
    let go = |_: &_| ControlFlow::Continue(());
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut problem = onboard::example();
    let mut settings = Settings::new();
    let plan = workspace.plan(&problem, &settings, go).unwrap();
    assert_eq!(plan.status, Status::Solved);
    let nodes = workspace.nodes(&problem).iter();
    let judged = problem.judge(nodes.map(|node| (&node.state, &node.control)));
    assert!(judged.max_violation < 1e-6, "{judged:?}");

    problem.goal_w.y += 0.02;
    (settings.warm_start, settings.initial_mu) = (true, 1e-3);
    let again = workspace.replan(&problem, &settings, go).unwrap();
    assert_eq!(again.status, Status::Solved);
    assert!(again.iterations < plan.iterations, "{again:?}");

    problem.phases[0].intervals = 25;
    let refused = workspace.plan(&problem, &settings, go);
    assert_eq!(refused, Err(Error::Intervals));
}

#[test]
fn stages_without_derivatives_or_their_zeros_plan_the_same_jump_bit_for_bit() {
    let mut problem = jump();
    (problem.edge, problem.goal_w) = (None, nalgebra::Vector3::new(0.3, -0.1, 0.25));
    let go = |_: &_| ControlFlow::Continue(());
    let mut full = vec![Stage::<_, _, NX, NU, NI>::new(State::new()); problem.intervals() + 1];
    problem.write_guess(&mut full, || 0.0);
    let kept = problem.plan(&Settings::new(), &mut full, go).unwrap();
    assert_eq!(kept.status, Status::Solved);

    let mut sparse =
        vec![SparseStage::<_, _, NX, NU, NI>::sparse(State::new()); problem.intervals() + 1];
    problem.write_guess(&mut sparse, || 0.0);
    assert_eq!(
        kept,
        problem.plan(&Settings::new(), &mut sparse, go).unwrap()
    );

    let mut lean = vec![LeanStage::<_, _, NX, NU, NI>::lean(State::new()); problem.intervals() + 1];
    problem.write_guess(&mut lean, || 0.0);
    let recomputed = problem.plan(&Settings::new(), &mut lean, go).unwrap();
    assert_eq!(kept, recomputed);
    for ((a, b), c) in full.iter().zip(&lean).zip(&sparse) {
        assert_eq!((a.state, a.control), (b.state, b.control));
        assert_eq!((a.state, a.control), (c.state, c.control));
    }
}
