//! States of A1 that proptest draws, and the landing controller in both precisions.
#![allow(clippy::panic, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET};
use core::f64::consts::PI;
use landing::{Command, Landing, Program, Settings, Target, Workspace};
use nalgebra::{Rotation3, Vector3};
use proptest::array::{uniform, uniform3, uniform4};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use rbd_core::{Configuration, Frame, Motion, Tangent, Transform, Tree};
use so3::Scalar;

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub(crate) fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// Runs a property that counts its outcomes outside of its cases.
pub(crate) fn each<S: Strategy>(config: Config, cases: &S, body: impl Fn(S::Value)) {
    let outcome = TestRunner::new(config).run(cases, |case| {
        body(case);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

/// A state with any subset of feet on the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) q: Configuration<f64, 12>,
    pub(crate) v: Tangent<f64, 12>,
    pub(crate) on: [bool; 4],
}

fn vector(half: f64) -> impl Strategy<Value = Vector3<f64>> {
    uniform3(-half..half).prop_map(Vector3::from)
}

/// Turns of no, next to no, next to half a turn, and half a turn about any axis.
fn special_turn() -> impl Strategy<Value = Vector3<f64>> {
    let angles = vec![0.0, 1e-9, 1e-4, PI - 1e-4, PI - 1e-9, PI];
    (vector(1.0), prop::sample::select(angles)).prop_map(|(axis, angle)| {
        let axis = axis.try_normalize(1e-3);
        axis.unwrap_or_else(Vector3::z) * angle
    })
}

/// From nearly standing (`wild` = 0.1) to far from any jump (1).
pub(crate) fn smooth(wild: f64) -> impl Strategy<Value = Case> {
    let joints = uniform(-wild..wild).prop_map(|x: [f64; 12]| {
        let nominal = [0.0, 0.8, -1.6];
        core::array::from_fn(|i| nominal[i % 3] + x[i])
    });
    let base = (vector(1.5 * wild), vector(0.3));
    let base = base.prop_map(|(turn, place)| Transform::new(so3::exp(&turn), place));
    let rates = uniform(-6.0 * wild..6.0 * wild).prop_map(Motion::from_array);
    let speeds = uniform(-20.0 * wild..20.0 * wild);
    let velocity = (rates, speeds).prop_map(|(base, joints)| Tangent { base, joints });
    let on = uniform4(any::<bool>());
    let state = (base, joints).prop_map(|(base, joints)| Configuration { base, joints });
    (state, velocity, on).prop_map(|(q, v, on)| Case { q, v, on })
}

/// Likewise, and one in six each: turned by an angle where logarithms are delicate, with a straight knee on some legs, at rest.
pub(crate) fn case(wild: f64) -> impl Strategy<Value = Case> {
    let some = || prop::bool::weighted(1.0 / 6.0);
    let straight = prop_oneof![5 => Just([false; 4]), 1 => uniform4(any::<bool>())];
    let turn = prop::option::weighted(1.0 / 6.0, special_turn());
    (smooth(wild), straight, turn, some()).prop_map(|(mut case, straight, turn, rests)| {
        for (leg, straight) in case.q.joints.chunks_mut(3).zip(straight) {
            if straight {
                leg[2] = 0.0;
            }
        }
        if let Some(turn) = turn {
            case.q.base.rotation = so3::exp(&turn);
        }
        if rests {
            case.v = Tangent::ZERO;
        }
        case
    })
}

pub(crate) struct Controller<T: Scalar> {
    pub(crate) landing: Landing<T, 12, 4>,
    pub(crate) workspace: Workspace<T, 12, 4>,
    pub(crate) target: Target<T>,
}

impl<T: Scalar> Controller<T>
where
    A1Geared: Tree<T, 12>,
{
    pub(crate) fn new() -> Self {
        let feet = FEET.map(|foot| Frame {
            link: foot.frame.link,
            offset: foot.frame.offset.map(T::of),
            ..Frame::IDENTITY
        });
        Self {
            landing: Landing::new(feet, Settings::new(&BUILD.cast()), [T::of(33.5); 12]),
            workspace: Workspace::new(),
            target: Target {
                height: T::of(0.25),
                ..Target::LEVEL
            },
        }
    }

    pub(crate) fn step(&mut self, case: &Case) -> Command<T, 12, 4> {
        let of = |v: &Vector3<f64>| v.map(T::of);
        let base = Transform::new(
            Rotation3::from_matrix_unchecked(case.q.base.rotation.matrix().map(T::of)),
            of(&case.q.base.translation),
        );
        let q = Configuration {
            base,
            joints: case.q.joints.map(T::of),
        };
        let v = Tangent {
            base: Motion::new(of(&case.v.base.linear), of(&case.v.base.angular)),
            joints: case.v.joints.map(T::of),
        };
        let (landing, workspace) = (&self.landing, &mut self.workspace);
        let waiting = &q.joints;
        landing.step(
            &A1Geared,
            &q,
            &v,
            &case.on,
            &self.target,
            waiting,
            workspace,
        )
    }
}

/// How far the optimum of a tick can move, N, where H and g of its program are off by one unit of round-off of their largest entries: the cost
/// curves by at least w_e, so a change of the gradient at the optimum moves it by no more than 1/w_e times as much. To some of these units
/// forces can be known in T, whoever solves for them.
pub(crate) fn round_off<T: Scalar>(
    controller: &Controller<f64>,
    forces_w: &[Vector3<f64>; 4],
) -> f64 {
    let program = Program::<f64, 12, 28>::of(&controller.workspace);
    let problem = program.problem();
    let (lower, upper) = (problem.lower, problem.upper);
    // Feet in the air have no force to move.
    let moves = |i: usize| {
        lower
            .zip(upper)
            .is_none_or(|(l, u)| l[3 * (i / 3) + 2] < u[3 * (i / 3) + 2])
    };
    let moving = || (0..12).filter(|i| moves(*i));
    let row = |i: usize| moving().map(|j| problem.hessian[i][j].abs()).sum();
    let hessian = moving().map(row).fold(0.0, f64::max);
    let gradient = moving().map(|i| problem.gradient[i].abs());
    let force = forces_w.iter().fold(0.0, |most: f64, f| most.max(f.amax()));
    let effort = controller.landing.settings.effort_weight;
    T::EPSILON.to_f64() * (hessian * force + gradient.fold(0.0, f64::max)) / effort
}
