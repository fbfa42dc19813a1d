//! Coupled joints: the reduced equations are those of the coupled robot.

use crate::common::{CAP, Model, masked, model, state};
use proptest::prelude::*;
use rbd_core::{
    BaseBody, BaseKind, Body, Configuration, CoupledWorkspace, Coupling, Effort, Force, Frame,
    FrameJacobian, Kinematics, Link, Motion, Posture, Reduction, ReductionError, Tangent, Tree,
    centroidal_state, coupled_dynamics, forward_kinematics, frame_jacobian, rnea,
};

const R: usize = 8;
type Coupled = Reduction<f64, CAP, R>;

/// The joints of a random robot follow up to `R` coordinates, each moved by one joint at least.
fn reduction(joints: usize) -> impl Strategy<Value = Coupled> {
    let row = (0..R, -2.0..2.0f64, -0.5..0.5f64);
    prop::collection::vec(row, CAP).prop_map(move |rows| Reduction {
        rows: core::array::from_fn(|i| {
            let (coordinate, ratio, offset) = rows[i];
            match i {
                i if i >= joints => Coupling::STILL,
                i if i < R => Coupling::independent(i),
                _ => Coupling {
                    coordinate,
                    ratio,
                    offset,
                },
            }
        }),
    })
}

fn coupled_robot() -> impl Strategy<Value = (Model, Coupled)> {
    model().prop_flat_map(|robot| {
        let joints = robot.joint_count();
        (Just(robot), reduction(joints))
    })
}

fn first<const K: usize>(x: &[f64; CAP], count: usize) -> [f64; K] {
    core::array::from_fn(|i| if i < count { x[i] } else { 0.0 })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// The acceleration needs, joint by joint, an effort whose work on every allowed motion is the given one's.
    #[test]
    fn the_motion_obeys_the_principle_of_virtual_work((robot, coupled) in coupled_robot(), (q, [v, f]) in state()) {
        let n = robot.joint_count();
        let q = Configuration { base: q.base, joints: first::<R>(&q.joints, n) };
        let v = masked(&robot, v);
        let v = Tangent { base: v.base, joints: first::<R>(&v.joints, n) };
        let effort = Effort {
            base: Force::new(f.base.linear, f.base.angular),
            joints: first::<R>(&f.joints, n),
        };
        let posture = Posture::new(&robot, &coupled.configuration(&q));
        let mut ws = Box::new(CoupledWorkspace::new());
        let a = coupled_dynamics(&robot, &coupled, &posture, &v, &effort, &mut ws);
        let tau = rnea(&robot, &posture, &coupled.tangent(&v), &coupled.tangent(&a));
        let worst = (0..6 + CAP).map(|i| tau.coordinate(i).abs()).fold(1.0, f64::max);
        let back = coupled.effort(&tau);
        let start = if robot.base_kind() == BaseKind::Fixed { 6 } else { 0 };
        for i in start..6 + R.min(n) {
            let (x, y) = (back.coordinate(i), effort.coordinate(i));
            prop_assert!((x - y).abs() < 1e-8 * worst, "row {i}: {x} {y}");
        }
        // M_r is the kinetic energy's, rotors included, and symmetric.
        let energy = centroidal_state(&robot, &posture, &coupled.tangent(&v)).kinetic_energy;
        prop_assert!((ws.reduced.kinetic_energy(&v) - energy).abs() <= 1e-10 * energy.max(1.0));
        for i in 0..R {
            for j in 0..i {
                let (x, y) = (ws.reduced.joints[i][j], ws.reduced.joints[j][i]);
                prop_assert!((x - y).abs() <= 1e-10 * worst.max(x.abs()));
            }
        }
    }

    /// Gathered columns times reduced rates are the columns times the spread rates.
    #[test]
    fn jacobians_gather((robot, coupled) in coupled_robot(), (q, [v, _]) in state()) {
        let q = Configuration { base: q.base, joints: first::<R>(&q.joints, R) };
        let posture = Posture::new(&robot, &coupled.configuration(&q));
        let mut poses = Kinematics::IDENTITY;
        forward_kinematics(&robot, &posture, &mut poses);
        let frame = Frame { link: Link::Joint(robot.joint_count() - 1), ..Frame::IDENTITY };
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&robot, &poses, &frame, rbd_core::Axes::Local, &mut jac);
        let v = Tangent { base: Motion::ZERO, joints: first::<R>(&v.joints, R) };
        let reduced = FrameJacobian { base: jac.base, joints: coupled.gather(&jac.joints, Motion::ZERO) };
        let (x, y) = (jac.mul(&coupled.tangent(&v)), reduced.mul(&v));
        prop_assert!((x.linear - y.linear).norm() < 1e-10 && (x.angular - y.angular).norm() < 1e-10);
    }
}

/// Two equal pendulums, the second geared to swing the other way at twice the speed: by hand.
#[test]
fn a_geared_pair() {
    let swing = Body {
        mass: 2.0,
        first: [0.0, 0.0, -1.0],
        second: [0.0, 0.0, 0.7, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let robot = Model::new(BaseKind::Fixed, BaseBody::EMPTY, &[swing, swing]).unwrap();
    let mut rows = [Coupling::STILL; CAP];
    rows[0] = Coupling::independent(0);
    rows[1] = Coupling {
        coordinate: 0,
        ratio: -2.0,
        offset: 0.3,
    };
    let gear = Reduction::<f64, CAP, 1> { rows };
    assert_eq!(gear.validate(2), Ok(()));
    let q = Configuration {
        joints: [0.4],
        ..Configuration::NEUTRAL
    };
    let posture = Posture::new(&robot, &gear.configuration(&q));
    let mut ws = Box::new(CoupledWorkspace::new());
    let still = Tangent::ZERO;
    let a = coupled_dynamics(&robot, &gear, &posture, &still, &Effort::ZERO, &mut ws);
    // J (1 + 4) a = −m g l (sin q − 2 sin(0.3 − 2 q))
    let torque = -9.81 * (so3::math::sin(0.4) - 2.0 * so3::math::sin(0.3 - 0.8));
    assert!((a.joints[0] - torque / (5.0 * 0.7)).abs() < 1e-12);
}

#[test]
fn rows_that_are_no_reduction() {
    let good = Reduction::<f64, 2, 1> {
        rows: [Coupling::independent(0); 2],
    };
    assert_eq!(good.validate(2), Ok(()));
    let with = |row| Reduction::<f64, 2, 1> {
        rows: [Coupling::independent(0), row],
    };
    let far = with(Coupling::independent(1));
    assert_eq!(
        far.validate(2),
        Err(ReductionError::NoSuchCoordinate { joint: 1 })
    );
    assert_eq!(
        far.configuration(&Configuration {
            joints: [3.0],
            ..Configuration::NEUTRAL
        })
        .joints,
        [3.0, 0.0]
    );
    let nan = with(Coupling {
        coordinate: 0,
        ratio: f64::NAN,
        offset: 0.0,
    });
    assert_eq!(nan.validate(2), Err(ReductionError::NotFinite { joint: 1 }));
    let idle = Reduction::<f64, 2, 1> {
        rows: [Coupling::STILL; 2],
    };
    assert_eq!(
        idle.validate(2),
        Err(ReductionError::MovesNothing { coordinate: 0 })
    );
    assert_eq!(good.to_f32().rows[1].ratio, 1.0_f32);
}
