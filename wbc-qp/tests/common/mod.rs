//! States of iCub that proptest draws, and the Clarabel oracle.
#![allow(unreachable_pub, reason = "tests")]
#![allow(clippy::panic, clippy::unwrap_used, missing_docs, reason = "tests")]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use core::f64::consts::PI;
use icub_model::{Icub23, LIMITS, SOLES};
use nalgebra::Vector3;
use proptest::array::{uniform, uniform3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use rbd_core::{Configuration, Motion, Tangent, Transform};
use wbc_qp::{Snapshot, TorqueAnswer, anchored};

pub const N: usize = 23;
/// Rows of iCub's programs on two soles, where a test does not need others: a solver is compiled for each size. Those of the soles, their
/// cones and the torques, and six more; in the velocity program those of the soles, and six more.
pub const M: usize = 61;
pub const VELOCITY_ROWS: usize = 18;

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// Runs a property that counts its outcomes outside of its cases.
pub fn each<S: Strategy>(config: Config, cases: &S, body: impl Fn(S::Value)) {
    let outcome = TestRunner::new(config).run(cases, |case| {
        body(case);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

pub type State = (Configuration<f64, N>, Tangent<f64, N>);

/// Turns up to one radian about each axis, and one in eight of no, next to no, next to half a turn, and half a turn.
fn turn() -> impl Strategy<Value = Vector3<f64>> {
    let axis = uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
    let angles = vec![0.0, 1e-9, PI - 1e-9, PI];
    let special = (axis.clone(), prop::sample::select(angles)).prop_map(|(axis, angle)| {
        let axis = axis.try_normalize(1e-3);
        axis.unwrap_or_else(Vector3::z) * angle
    });
    prop_oneof![7 => axis, 1 => special]
}

/// A state: joints in the middle of their ranges, one in eight at a limit.
pub fn state() -> impl Strategy<Value = State> {
    let share = prop_oneof![7 => -0.4..0.4_f64, 1 => prop::sample::select(vec![-0.5, 0.5])];
    let place = (-1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(x, y)| Vector3::new(x, y, 0.5));
    let joints = uniform(share).prop_map(|shares: [f64; N]| {
        core::array::from_fn(|i| {
            let limits = &LIMITS[i];
            0.5 * (limits.lower + limits.upper) + shares[i] * (limits.upper - limits.lower)
        })
    });
    let speeds = (uniform(-1.0..1.0_f64), uniform(-1.0..1.0_f64));
    (turn(), place, joints, speeds).prop_map(|(turn, place, joints, (base, speeds))| {
        let q = Configuration {
            base: Transform::new(so3::exp(&turn), place),
            joints,
        };
        let v = Tangent {
            base: Motion::from_array(base),
            joints: speeds,
        };
        (q, v)
    })
}

/// A crouch on both soles, the left one at the world's origin, with these displacements and speeds: both legs alike, so that both soles
/// stay on the ground.
pub fn crouched(shifts: &[f64; N], speeds: &[f64; N]) -> State {
    let mut q = [0.0; N];
    for leg in [0, 6] {
        (q[leg], q[leg + 3], q[leg + 4]) = (1.2, -1.7, -0.7);
    }
    for arm in [15, 19] {
        (q[arm], q[arm + 1], q[arm + 3]) = (-0.5, 0.4, 0.8);
    }
    for bend in [0, 3, 4] {
        q[bend] += shifts[bend];
        q[bend + 6] += shifts[bend];
    }
    for (q, shift) in q.iter_mut().zip(shifts).skip(12) {
        *q += shift;
    }
    anchored(&Icub23, &q, speeds, &SOLES[0].frame, &Transform::IDENTITY)
}

/// Crouches with every joint displaced by up to `spread` and moving with up to `speed`, one in eight at rest.
pub fn crouch(spread: f64, speed: f64) -> impl Strategy<Value = State> {
    let speeds = prop_oneof![7 => uniform(-1.0..1.0_f64), 1 => Just([0.0; N])];
    (uniform(-1.0..1.0_f64), speeds).prop_map(move |(shifts, speeds)| {
        crouched(&shifts.map(|x| spread * x), &speeds.map(|x| speed * x))
    })
}

pub fn snapshot(q: &Configuration<f64, N>, v: &Tangent<f64, N>) -> Snapshot<f64, N> {
    let mut s = Snapshot::ZERO;
    s.update(&Icub23, q, v);
    s
}

/// What Clarabel says of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The optimal cost.
    Least(f64),
    /// A cost that it could not show to be optimal to its last digits: the least one may be a little lower.
    Nearly(f64),
    Infeasible,
    Unsure,
}

impl Verdict {
    pub fn cost(self) -> Option<f64> {
        match self {
            Self::Least(cost) | Self::Nearly(cost) => Some(cost),
            Self::Infeasible | Self::Unsure => None,
        }
    }
}

/// Optimal cost of the program as it stands, by Clarabel.
pub fn oracle<const V: usize, const M: usize>(
    problem: &dense_qp::Problem<'_, f64, V, M>,
) -> Verdict {
    let h: Vec<Vec<f64>> = problem.hessian.iter().map(|r| r.to_vec()).collect();
    let p = CscMatrix::from(&h).to_triu();
    // Equalities are a cone of their own: as two opposite inequalities they would leave an interior-point method no interior.
    let (mut equal, mut equal_to) = (Vec::new(), Vec::new());
    let (mut rows, mut b) = (Vec::new(), Vec::new());
    let mut add = |row: Vec<f64>, low: f64, high: f64| {
        if low == high {
            equal.push(row);
            equal_to.push(high);
            return;
        }
        if high < f64::INFINITY {
            rows.push(row.clone());
            b.push(high);
        }
        if low > f64::NEG_INFINITY {
            rows.push(row.iter().map(|x| -x).collect());
            b.push(-low);
        }
    };
    for i in 0..M {
        add(
            problem.rows[i].to_vec(),
            problem.row_lower[i],
            problem.row_upper[i],
        );
    }
    for i in 0..V {
        let mut row = vec![0.0; V];
        row[i] = 1.0;
        add(row, problem.lower.unwrap()[i], problem.upper.unwrap()[i]);
    }
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .unwrap();
    let cones = [
        SupportedConeT::ZeroConeT(equal_to.len()),
        SupportedConeT::NonnegativeConeT(b.len()),
    ];
    equal.append(&mut rows);
    equal_to.append(&mut b);
    let a = CscMatrix::from(&equal);
    let mut solver =
        DefaultSolver::new(&p, problem.gradient, &a, &equal_to, &cones, settings).unwrap();
    solver.solve();
    let x: [f64; V] = core::array::from_fn(|i| solver.solution.x[i]);
    match solver.solution.status {
        SolverStatus::Solved => Verdict::Least(problem.cost(&x)),
        SolverStatus::AlmostSolved => Verdict::Nearly(problem.cost(&x)),
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            Verdict::Infeasible
        }
        _ => Verdict::Unsure,
    }
}

/// The unknowns of a torque program at an answer, without slack.
pub fn unknowns<const K: usize, const V: usize>(
    s: &Snapshot<f64, N>,
    answer: &TorqueAnswer<f64, N, K>,
) -> [f64; V] {
    let unit = s.centroidal.mass * 0.981;
    core::array::from_fn(|i| match i {
        0..N => answer.acceleration.joints[i],
        _ => answer.forces[i - N] / unit,
    })
}

/// The least cost that a program would have without its limits, by Clarabel.
pub fn least_without_limits<const V: usize, const M: usize>(
    problem: &dense_qp::Problem<'_, f64, V, M>,
) -> f64 {
    let (mut lower, mut upper) = ([f64::NEG_INFINITY; M], [f64::INFINITY; M]);
    for i in (0..M).filter(|i| problem.row_lower[*i] == problem.row_upper[*i]) {
        (lower[i], upper[i]) = (problem.row_lower[i], problem.row_upper[i]);
    }
    let (low, high) = ([f64::NEG_INFINITY; V], [f64::INFINITY; V]);
    let free = dense_qp::Problem {
        row_lower: &lower,
        row_upper: &upper,
        lower: Some(&low),
        upper: Some(&high),
        ..*problem
    };
    oracle(&free).cost().unwrap()
}
