//! A small jump of the reference A1: stand on four feet, push off with two, fly.

pub(crate) mod differences;

use a1_model::{A1Reference, a1_reference::frame};
use core::f64::consts::PI;
use nalgebra::Vector3;
use proptest::array::{uniform, uniform3, uniform4};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use wb_opt::{
    Apart, BASE, BaseCoordinates, Clearance, EulerOrder, Foot, Friction, Phase, Point, Pose,
    Problem, Robot, Segment, State, Weights,
};

pub(crate) const N: usize = 18;
pub(crate) const FEET: usize = 4;
pub(crate) const NX: usize = 36;
pub(crate) const NU: usize = 30;
pub(crate) const NI: usize = 140;

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub(crate) fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// What the problem borrows.
pub(crate) struct Data {
    pub(crate) clearances: [Clearance<f64>; 12],
    pub(crate) apart: [Apart<f64>; 2],
    pub(crate) phases: [Phase<f64, FEET>; 3],
    pub(crate) reference: Vec<Pose<f64, N>>,
}

pub(crate) fn crouch() -> [f64; N] {
    core::array::from_fn(|i| match (i, (i.wrapping_sub(BASE)) % 3) {
        (2, _) => 0.25,
        (0..BASE, _) | (_, 0) => 0.0,
        (_, 1) => 0.8957,
        _ => -1.7914,
    })
}

pub(crate) fn data() -> Data {
    let knee = |leg: usize| Clearance {
        point: Point {
            link: BASE + 3 * leg + 2,
            offset_l: Vector3::zeros(),
        },
        height: 0.02,
    };
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { 1.0 } else { -1.0 };
        Clearance {
            point: Point {
                link: BASE - 1,
                offset_l: Vector3::new(0.1805 * sign(4), 0.097 * sign(2), 0.057 * sign(1)),
            },
            height: 0.03,
        }
    };
    // Shanks, and a shank and a foot.
    let shank = |leg: usize, from: f64| Segment {
        ends: [from, -0.2].map(|along| Point {
            link: BASE + 3 * leg + 2,
            offset_l: Vector3::new(0.01, 0.0, along),
        }),
    };
    let apart = |leg: usize, other: usize, from: f64| Apart {
        segments: [shank(leg, 0.0), shank(other, from)],
        distance: 0.04,
    };
    let phase = |contacts, intervals, dt| Phase {
        contacts,
        intervals,
        dt,
        weight: 100.0 * dt,
    };
    Data {
        clearances: core::array::from_fn(|i| if i < 8 { corner(i) } else { knee(i - 8) }),
        apart: [apart(0, 1, -0.02), apart(2, 0, -0.2)],
        phases: [
            phase([true; 4], 12, 0.01),
            phase([false, false, true, true], 8, 0.012),
            phase([false; 4], 14, 0.005),
        ],
        reference: vec![Pose::level(crouch()); 34],
    }
}

/// All base coordinates.
pub(crate) const BASES: [BaseCoordinates; 3] = [
    BaseCoordinates::Angles(EulerOrder::Zyx),
    BaseCoordinates::Angles(EulerOrder::Zxy),
    BaseCoordinates::Rotation,
];

/// A model with base coordinates.
pub(crate) fn robot<M: rbd_core::Model<f64, 12>>(
    model: &M,
    base: BaseCoordinates,
) -> Robot<f64, N> {
    match base {
        BaseCoordinates::Rotation => Robot::on_free_base(model),
        BaseCoordinates::Angles(order) => Robot::on_euler_base(model, order),
    }
}

pub(crate) fn jump(data: &Data, base: BaseCoordinates) -> Problem<'_, f64, N, FEET> {
    let feet = [
        frame::FL_FOOT,
        frame::FR_FOOT,
        frame::RL_FOOT,
        frame::RR_FOOT,
    ];
    let mut goal = crouch();
    goal[0] = 0.1;
    Problem {
        robot: robot(&A1Reference, base),
        feet: core::array::from_fn(|i| Foot {
            point: Robot::<f64, N>::point(&feet[i]),
            pos_wf: Vector3::new(
                if i < 2 { 0.1805 } else { -0.1805 },
                if i % 2 == 0 { 0.1308 } else { -0.1308 },
                0.0,
            ),
            radius: 0.0,
        }),
        clearances: &data.clearances,
        apart: &data.apart,
        swing_height: -0.01,
        swing_rise: 0.0,
        edge: None,
        phases: &data.phases,
        reference: &data.reference,
        start: Pose::level(crouch()),
        goal: Pose::level(goal),
        goal_tolerance: [0.02, 0.02, 0.02, 0.05, 0.05, 0.05],
        least_force: 0.0,
        release: f64::INFINITY,
        max_force: f64::INFINITY,
        landing_intervals: 5,
        friction_smoothing: 0.5,
        friction: Friction::pyramid(0.6),
        drift: 0.01,
        weights: Weights {
            position: 1.0,
            effort: 1e-4,
            goal: 10.0,
        },
    }
}

pub(crate) type Node = (State<f64, N>, [f64; NU]);

/// Displacements in ±1, most of them free, some at an end or none.
fn share() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![14 => -1.0..1.0_f64, 1 => prop::sample::select(vec![-1.0, 0.0, 1.0])]
}

/// Turns of a base: any, and one in eight of no, next to no, next to half a turn, and half a turn.
fn turn() -> impl Strategy<Value = Vector3<f64>> {
    let free = uniform3(-2.0..2.0_f64).prop_map(Vector3::from);
    let angles = vec![0.0, 1e-9, PI - 1e-9, PI];
    let special = (free.clone(), prop::sample::select(angles)).prop_map(|(axis, angle)| {
        let axis = axis.try_normalize(1e-3);
        axis.unwrap_or_else(Vector3::z) * angle
    });
    prop_oneof![7 => free, 1 => special]
}

/// Any state and control with these base coordinates, at rest and with straight knees included. Boxed, for it is much for a stack.
pub(crate) fn anywhere(base: BaseCoordinates) -> BoxedStrategy<Node> {
    let knees = prop_oneof![5 => Just([false; 4]), 1 => uniform4(any::<bool>())];
    let speeds = prop_oneof![7 => uniform(share()), 1 => Just([0.0; N])];
    let state = (uniform(share()), speeds, knees, turn());
    let state = state.prop_map(
        move |(shifts, speeds, straight, turn): ([f64; N], _, _, _)| {
            let mut state = State::at_rest(Pose::level(crouch()));
            for (q, shift) in state.q.iter_mut().zip(shifts) {
                *q += 0.7 * shift;
            }
            for (leg, straight) in straight.into_iter().enumerate() {
                if straight {
                    state.q[BASE + 3 * leg + 2] = 0.0;
                }
            }
            state.v = speeds.map(|v| 5.0 * v);
            if base == BaseCoordinates::Rotation {
                state.q[3..BASE].fill(0.0);
                state.rot_wc = so3::exp(&turn);
            }
            state
        },
    );
    (state, uniform(share())).boxed()
}

/// Any stage of the jump but its last node: of each phase as often, and often the first.
pub(crate) fn stage() -> impl Strategy<Value = usize> {
    prop_oneof![1 => Just(0), 3 => 0..12_usize, 3 => 12..20_usize, 3 => 20..34_usize]
}

/// One of the base coordinates, and any state and control with it.
pub(crate) fn based() -> impl Strategy<Value = (BaseCoordinates, Node)> {
    let each = BASES.map(|base| anywhere(base).prop_map(move |node| (base, node)).boxed());
    prop::strategy::Union::new(each)
}
