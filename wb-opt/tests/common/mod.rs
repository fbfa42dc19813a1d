//! A small jump of the reference A1: stand on four feet, push off with two, fly.

pub(crate) mod differences;

use a1_model::{A1Reference, a1_reference::frame};
use nalgebra::Vector3;
use wb_opt::{
    BASE, BaseCoordinates, Clearance, EulerOrder, Foot, Friction, Phase, Point, Pose, Problem,
    Robot, State, Weights,
};

pub(crate) const N: usize = 18;
pub(crate) const FEET: usize = 4;
pub(crate) const NX: usize = 36;
pub(crate) const NU: usize = 30;
pub(crate) const NI: usize = 140;

/// Numbers from a small generator, uniform in ±1.
pub(crate) struct Noise(pub(crate) u32);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1 << 23) - 1.0
    }
}

/// What the problem borrows.
pub(crate) struct Data {
    pub(crate) clearances: [Clearance<f64>; 12],
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
    let phase = |contacts, intervals, dt| Phase {
        contacts,
        intervals,
        dt,
    };
    Data {
        clearances: core::array::from_fn(|i| if i < 8 { corner(i) } else { knee(i - 8) }),
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
        swing_height: -0.01,
        swing_rise: 0.0,
        edge: None,
        phases: &data.phases,
        reference: &data.reference,
        start: Pose::level(crouch()),
        goal: Pose::level(goal),
        goal_tolerance: [0.02, 0.02, 0.02, 0.05, 0.05, 0.05],
        least_force: 0.0,
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

/// A state and a control away from anything special.
pub(crate) fn anywhere(noise: &mut Noise, base: BaseCoordinates) -> (State<f64, N>, [f64; NU]) {
    let mut state = State::at_rest(Pose::level(crouch()));
    state.q.iter_mut().for_each(|q| *q += 0.7 * noise.next());
    state.v.iter_mut().for_each(|v| *v += 5.0 * noise.next());
    if base == BaseCoordinates::Rotation {
        state.q[3..BASE].fill(0.0);
        state.rot_wc = so3::exp(&Vector3::from_fn(|_, _| 2.0 * noise.next()));
    }
    (state, core::array::from_fn(|_| noise.next()))
}
