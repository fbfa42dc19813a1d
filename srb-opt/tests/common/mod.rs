//! A jump to test with: a quarter turn of an A1-like body, four feet, flight.

use nalgebra::{Matrix3, Vector3};
use ocp_solver::Stage;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use so3::Scalar;
use srb_opt::{Edge, Exponential, Foot, Phase, Problem, Reference, State, Weights};

pub(crate) const NX: usize = 16;
pub(crate) const NU: usize = 12;
pub(crate) const NI: usize = 40;

pub(crate) fn jump() -> Problem<f64, 4, 4> {
    jump_in()
}

pub(crate) fn jump_in<T: Scalar>() -> Problem<T, 4, 4> {
    let s = T::of;
    let v = |x: f64, y: f64, z: f64| Vector3::new(s(x), s(y), s(z));
    let phase = |contacts, intervals, duration_guess: f64| Phase {
        contacts,
        intervals,
        duration_guess: s(duration_guess),
        min_duration: s(0.1),
        max_duration: s(1.0),
        reference_angle: s(0.0),
    };
    let feet = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| Foot {
        pos_wf: v(0.18 * x, 0.13 * y, 0.0),
        nominal_b: v(0.18 * x, 0.13 * y, 0.0),
    });
    let mut corners = [Vector3::zeros(); 8];
    for (i, corner) in corners.iter_mut().enumerate() {
        let side = |bit: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
        *corner = v(0.18 * side(0), 0.097 * side(1), 0.057 * side(2));
    }
    Problem {
        mass: s(12.0),
        inertia_b: Matrix3::new(0.017, 0.001, 0.0, 0.001, 0.056, 0.002, 0.0, 0.002, 0.065).map(s),
        gravity: s(9.81),
        feet,
        reach_lower: v(-0.12, -0.10, -0.33),
        reach_upper: v(0.12, 0.10, -0.10),
        friction: s(0.6),
        max_force: s(160.0),
        corners,
        clearance: s(0.03),
        edge: Some(Edge {
            drop: s(0.2),
            axis: 0,
            sign: s(1.0),
            distance: s(0.25),
            width: s(0.03),
        }),
        phases: [
            phase([true; 4], 10, 0.4),
            phase([false, false, true, true], 6, 0.2),
            phase([false; 4], 8, 0.3),
            phase([false; 4], 0, 0.0),
        ],
        phase_count: 3,
        min_total: s(0.5),
        max_total: s(1.2),
        start_w: v(0.0, 0.0, 0.25),
        goal_w: v(0.4, -0.1, 0.05),
        axis: Vector3::z(),
        angle: s(0.6),
        min_final_trace: s(2.5),
        reference: Reference::Linear,
        weights: Weights {
            omega: s(1e-2),
            force: s(1e-5),
            rotation: s(1.0),
        },
        exponential: Exponential::Taylor4,
        log_epsilon: s(1e-6),
    }
}

pub(crate) type Node = Stage<f64, State<f64, 4>, NX, NU, NI>;

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub(crate) fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// The guess, each of its numbers displaced by up to `noise`; or, one in eight, as it is.
pub(crate) fn nodes(noise: f64) -> impl Strategy<Value = Vec<Node>> {
    // As many as the guess asks for.
    let many = prop::collection::vec(-1.0..1.0_f64, 640);
    prop_oneof![7 => many, 1 => Just(vec![0.0])].prop_map(move |numbers| {
        let problem = jump();
        let mut stages = vec![Node::new(State::new()); problem.intervals() + 1];
        let mut numbers = numbers.iter().cycle();
        problem.write_guess(&mut stages, || {
            noise * numbers.next().copied().unwrap_or_default()
        });
        stages
    })
}
