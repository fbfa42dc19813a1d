//! Two solvers that share nothing but the problem end in the same point with the same multipliers.

use crate::reference::{TASKS, Task};
use core::ops::ControlFlow;
use ocp_solver::{Settings, Stage, Status};
use srb_opt::onboard::PHASES;
use srb_opt::{SqpNode, State};

const NX: usize = 15;
const NU: usize = 12;
const NI: usize = 40;

/// Solves a task with both, each from the plain guess.
fn agree(task: &Task) {
    let jump = task.problem(1.0);
    let mut stages =
        vec![Stage::<f64, _, NX, NU, NI>::new(State::<f64, PHASES>::new()); jump.intervals() + 1];
    jump.write_guess(&mut stages, || 0.0);
    let mut nodes: Vec<SqpNode<PHASES, NX, NU, NI>> = stages
        .iter()
        .map(|stage| SqpNode {
            state: stage.state,
            control: stage.control,
            dynamics_multiplier: [0.0; NX],
            row_multipliers: [0.0; NI],
        })
        .collect();
    let mut settings = Settings::new();
    (settings.primal_tolerance, settings.dual_tolerance) = (1e-9, 1e-8);
    settings.complementarity_tolerance = 1e-8;
    let go = |_: &_| ControlFlow::Continue(());
    let found = jump.plan(&settings, &mut stages, go).unwrap();
    assert_eq!(found.status, Status::Solved, "{}", task.name);
    let other = jump.plan_by_sqp(&mut nodes, 300).unwrap();
    println!("{}: {found:?} {other:?}", task.name);
    assert!(other.is_solved, "{}: {other:?}", task.name);
    let apart = (other.cost / found.cost - 1.0).abs();
    assert!(apart < 1e-7, "{}: {} {}", task.name, other.cost, found.cost);
    let (mut state, mut multiplier, mut size) = (0.0f64, 0.0f64, 1.0f64);
    for (k, (a, b)) in stages.iter().zip(&nodes).enumerate() {
        state = state
            .max((a.state.pos_w - b.state.pos_w).amax())
            .max((a.state.rot_wb - b.state.rot_wb).amax());
        for (x, y) in a.state.durations.iter().zip(&b.state.durations) {
            state = state.max((x - y).abs());
        }
        if let Some(next) = stages.get(k + 1) {
            for (x, y) in next.costate().iter().zip(&b.dynamics_multiplier).take(12) {
                (multiplier, size) = (multiplier.max((x - y).abs()), size.max(x.abs()));
            }
        }
    }
    println!(
        "{}: states {state:.1e}, costates {multiplier:.1e} of {size:.1e}",
        task.name
    );
    assert!(state < 1e-5, "{}: {state}", task.name);
    assert!(
        multiplier < 1e-4 * size,
        "{}: {multiplier} of {size}",
        task.name
    );
}

fn named(name: &str) {
    agree(TASKS.iter().find(|task| task.name == name).unwrap());
}

#[test]
fn two_reference_problems() {
    ["lateral", "spin"].into_iter().for_each(named);
}

/// `cargo test --release -p srb-opt sqp_oracle -- --ignored`
#[test]
#[ignore = "a minute"]
fn all_reference_problems() {
    TASKS.iter().for_each(agree);
}
