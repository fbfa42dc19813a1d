//! Free durations: derivatives against differences of the values, and a jump that finds its own timing.

use crate::common::differences::{entry, mixed, moved, reached};
use crate::common::{BASES, FEET, N, NI, NU, Node, anywhere, config, data, jump, robot, stage};
use a1_model::A1Geared;
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{
    Derivatives, Evaluated, Problem as Ocp, SparseStage, Status, Values, derivative_errors,
};
use proptest::prelude::*;
use wb_opt::{BaseCoordinates, FreeTiming, Problem, State, TimedState};

const PHASES: usize = 3;
const NX: usize = 2 * N + PHASES;
const DURATIONS: [f64; PHASES] = [0.13, 0.09, 0.08];

fn free<'a>(problem: Problem<'a, f64, N, FEET>) -> FreeTiming<'a, f64, N, FEET, PHASES> {
    FreeTiming {
        problem,
        durations: [[0.05, 0.5]; PHASES],
        total: [0.2, 0.8],
    }
}

/// In each of the base coordinates a node, and a state to go to.
fn pairs() -> impl Strategy<Value = [(Node, Node); 3]> {
    BASES.map(|base| (anywhere(base), anywhere(base)))
}

/// A node and the next.
fn nodes(
    timed: &FreeTiming<'_, f64, N, FEET, PHASES>,
    k: usize,
    (node, next): &(Node, Node),
) -> ([TimedState<f64, N, PHASES>; 2], [f64; NU]) {
    let base = timed.problem.robot.base;
    let phase = [0..12, 12..20, 20..34].iter().position(|p| p.contains(&k));
    let dt = phase.map_or(0.0, |phase| {
        DURATIONS[phase] / timed.problem.phases[phase].intervals as f64
    });
    let next = reached(base, dt, node, next.0);
    let at = |state| TimedState {
        state,
        durations: DURATIONS,
    };
    ([at(node.0), at(next)], node.1)
}

fn geared<'a>(
    data: &'a crate::common::Data,
    base: BaseCoordinates,
) -> FreeTiming<'a, f64, N, FEET, PHASES> {
    let mut problem = jump(data, base);
    problem.robot = robot(&A1Geared, base);
    problem.feet.iter_mut().for_each(|foot| foot.radius = 0.2);
    free(problem)
}

proptest! {
    #![proptest_config(config(5, 7))]
    #[test]
    fn first_derivatives(pairs in pairs(), k in prop_oneof![4 => stage(), 1 => Just(34)]) {
        let data = data();
        for (base, pair) in BASES.into_iter().zip(&pairs) {
            let timed = geared(&data, base);
            let ([x, next], u) = nodes(&timed, k, pair);
            let next = (k < 34).then_some(&next);
            let errors = derivative_errors::<f64, _, NX, NU, NI>(&timed, k, &x, &u, next, 1e-6);
            prop_assert!(errors.worst() < 3e-6, "{base:?} {k}: {errors:?}");
        }
    }
}

proptest! {
    #![proptest_config(config(4, 3))]
    /// The row of a duration in the Hessian, against second differences of the Lagrangian, its gap included.
    #[test]
    fn second_derivatives(
        pairs in pairs(), k in stage(), lambda in prop::array::uniform(-1.0..1.0_f64).boxed(), y in prop::array::uniform(-1.0..1.0_f64).boxed(),
    ) {
        let data = data();
        for (base, pair) in BASES.into_iter().zip(&pairs) {
            second_derivatives_at(&geared(&data, base), k, pair, &lambda, &y);
        }
    }
}

fn second_derivatives_at(
    timed: &FreeTiming<'_, f64, N, FEET, PHASES>,
    k: usize,
    pair: &(Node, Node),
    lambda: &[f64; NX],
    y: &[f64; NI],
) {
    let base = timed.problem.robot.base;
    let phase = usize::from(k >= 12) + usize::from(k >= 20);
    let ([x, next], control) = nodes(timed, k, pair);
    let dims = Ocp::<f64, NX, NU, NI>::dims(timed, k);
    let lagrangian = |steps: &[(usize, f64)]| {
        let (step, control) = moved(&control, steps);
        let x = Ocp::<f64, NX, NU, NI>::retract(timed, k, &x, &step, None);
        let mut values = Values::<f64, NX, NI>::new();
        timed.evaluate(k, &x, &control, Some(&next), &mut values);
        let rows = values.rows.iter().zip(y).take(dims.rows());
        let gap = values.gap.iter().zip(lambda);
        values.cost + rows.chain(gap).map(|(a, b)| a * b).sum::<f64>()
    };
    let mut d = Derivatives::<f64, NX, NU, NI>::new();
    let values = Values::<f64, NX, NI>::new();
    let at = Evaluated {
        values: &values,
        dynamics_multiplier: lambda,
        row_multipliers: y,
    };
    timed.differentiate(k, &x, &control, Some(&next), at, &mut d);
    let time = 2 * N + phase;
    let (h, short) = (1e-3, 1e-4);
    let mut size = 1.0f64;
    let mut worst = (0.0f64, 0, 0.0, 0.0);
    for j in 0..NX + dims.controls {
        let found = mixed(lagrangian, (time, short), (j, h));
        let wanted = entry(&d, time, j);
        if let Some(mirrored) = d.hessian_xx.get(j) {
            assert!((mirrored[time] - wanted).abs() < 1e-9 * (1.0 + wanted.abs()));
        }
        size = size.max(wanted.abs());
        if (found - wanted).abs() > worst.0 {
            worst = ((found - wanted).abs(), j, found, wanted);
        }
    }
    assert!(worst.0 < 2e-4 * size, "{base:?} {k}: {worst:?} of {size}");
}

type TimedStage = SparseStage<f64, TimedState<f64, N, PHASES>, NX, NU, NI>;

/// A robot that stands, for as long as the problem's intervals are.
fn standing(timed: &FreeTiming<'_, f64, N, FEET, PHASES>) -> Vec<TimedStage> {
    let problem = timed.problem;
    let nodes = vec![problem.start; problem.intervals() + 1];
    let start = State::at_rest(problem.start);
    let mut given =
        vec![SparseStage::<f64, State<f64, N>, { 2 * N }, NU, NI>::sparse(start); nodes.len()];
    let stand = Vector3::new(0.0, 0.0, 30.0);
    problem.write_guess(&mut given, &nodes, |_, _| stand, || 0.0);
    let start = TimedState {
        state: start,
        durations: timed.guessed(),
    };
    let mut guess = vec![SparseStage::sparse(start); given.len()];
    timed.write_guess(&given, &mut guess);
    guess
}

/// Feet let go in time, and rise in time, in the durations that were found and not in those of the guess.
#[test]
fn bounds_that_ask_for_time_are_kept_in_the_durations_found() {
    let data = data();
    for (release, swing_rise) in [(2e3, 0.0), (f64::INFINITY, 0.01), (2e3, 0.01)] {
        let timed = free(Problem {
            release,
            swing_rise,
            ..jump(&data, BaseCoordinates::Rotation)
        });
        let mut stages = standing(&timed);
        let go = |_: &_| ControlFlow::Continue(());
        let solution = timed.plan(&wb_opt::settings(), &mut stages, go).unwrap();
        assert_eq!(solution.status, Status::Solved, "{solution:?}");
        let judged = timed.judge(stages.iter().map(|s| (&s.state, &s.control)));
        assert!(
            judged.max_violation <= 1e-3,
            "{release} {swing_rise}: {judged:?}"
        );
    }
}

#[test]
fn a_jump_finds_its_timing() {
    let data = data();
    let mut timed = free(jump(&data, BaseCoordinates::Rotation));
    let guess = standing(&timed);
    let plan = |timed: &FreeTiming<'_, f64, N, FEET, PHASES>,
                guess: &[SparseStage<_, _, NX, NU, NI>]| {
        let mut stages = guess.to_vec();
        let go = |_: &_| ControlFlow::Continue(());
        let solution = timed.plan(&wb_opt::settings(), &mut stages, go).unwrap();
        assert_eq!(solution.status, Status::Solved, "{solution:?}");
        let judged = timed.judge(stages.iter().map(|s| (&s.state, &s.control)));
        assert!(judged.max_violation < 2e-6, "{judged:?}");
        (judged.cost, stages)
    };
    let (cost, found) = plan(&timed, &guess);
    let durations = found[0].state.durations;
    assert!(
        durations.iter().all(|t| (0.05..0.5).contains(t)),
        "{durations:?}"
    );
    // No timing nearby and within the bounds is cheaper: solved from the solution, since there are other minima.
    let mut tried = 0;
    for (phase, factor) in [
        (0, 0.99),
        (0, 1.01),
        (1, 0.99),
        (1, 1.01),
        (2, 0.99),
        (2, 1.01),
    ] {
        let moved = durations[phase] * factor;
        if !(0.05..=0.5).contains(&moved) {
            continue;
        }
        tried += 1;
        timed.durations = durations.map(|t| [t, t]);
        timed.durations[phase] = [moved; 2];
        let (other, _) = plan(&timed, &found);
        assert!(
            other >= cost * (1.0 - 1e-6),
            "{durations:?}, phase {phase} times {factor}: {other} {cost}"
        );
    }
    assert!(tried >= 3, "{durations:?}");
}
