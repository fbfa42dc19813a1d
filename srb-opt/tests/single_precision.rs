//! Problem (2) in `f32`, judged in `f64`.

use crate::common::{NI, NU, NX, jump, jump_in};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{Settings, Stage, Status};
use srb_opt::State;

#[test]
fn single_precision_plans_the_same_jump_within_five_millimetres() {
    let mut wide = jump();
    (wide.edge, wide.goal_w) = (None, Vector3::new(0.3, -0.1, 0.25));
    let mut stages = vec![Stage::<_, _, NX, NU, NI>::new(State::new()); wide.intervals() + 1];
    wide.write_guess(&mut stages, || 0.0);
    let go = |_: &_| ControlFlow::Continue(());
    let reference = wide.plan(&Settings::new(), &mut stages, go).unwrap();
    assert_eq!(
        reference.status,
        Status::Solved,
        "{reference:?} {:?}",
        ocp_solver::blocking_rows::<4, _, _, _, _, _, _>(&stages)
    );

    let mut narrow = jump_in::<f32>();
    (narrow.edge, narrow.goal_w) = (None, Vector3::new(0.3, -0.1, 0.25));
    let mut single = vec![Stage::<_, _, NX, NU, NI>::new(State::new()); narrow.intervals() + 1];
    narrow.write_guess(&mut single, || 0.0);
    let go = |_: &_| ControlFlow::Continue(());
    let solution = narrow.plan(&Settings::new(), &mut single, go).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");

    let widened: Vec<_> = single
        .iter()
        .map(|stage| {
            let from = &stage.state;
            let mut state = State::<f64, 4>::new();
            state.pos_w = from.pos_w.map(f64::from);
            state.vel_w = from.vel_w.map(f64::from);
            state.rot_wb = from.rot_wb.map(f64::from);
            state.omega_b = from.omega_b.map(f64::from);
            state.durations = from.durations.map(f64::from);
            (state, stage.control.map(f64::from))
        })
        .collect();
    let judged = wide.judge(widened.iter().map(|(state, control)| (state, control)));
    let exact = wide.judge(stages.iter().map(|s| (&s.state, &s.control)));
    let share = (judged.cost / exact.cost - 1.0).abs();
    assert!(share < 5e-4, "{} {}", judged.cost, exact.cost);
    assert!(judged.max_violation < 1e-4, "{judged:?}");
    for (a, b) in widened.iter().zip(&stages) {
        let apart = (a.0.pos_w - b.state.pos_w).amax();
        assert!(apart < 5e-3, "{apart}");
    }
}
