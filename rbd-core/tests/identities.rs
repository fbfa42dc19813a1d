//! Laws that hold for every robot, on random trees of every joint kind.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use rbd_core::joint::Kind;
use rbd_core::{
    AbaWorkspace, Axes, BaseBody, BaseKind, Body, BodyMotions, CentroidalMap, ComJacobian,
    Configuration, Effort, Force, Frame, FrameJacobian, Inertia, Kinematics, Link, MassMatrix,
    Motion, Posture, Symmetric3, TableModel, Tangent, Transform, aba, bias_accelerations,
    centroidal_bias, centroidal_map, centroidal_momentum_rate, centroidal_state, com_jacobian,
    crba, forward_accelerations, forward_kinematics, frame_jacobian, rnea,
};

const CAP: usize = 24;
type Model = TableModel<f64, CAP>;

fn rotation() -> impl Strategy<Value = Rotation3<f64>> {
    prop::array::uniform4(-1.0..1.0f64).prop_filter_map("degenerate quaternion", |[x, y, z, w]| {
        let n = x * x + y * y + z * z + w * w;
        (n > 1e-2).then(|| {
            let q = nalgebra::Quaternion::new(w, x, y, z);
            nalgebra::UnitQuaternion::from_quaternion(q).to_rotation_matrix()
        })
    })
}

fn vector(scale: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-scale..scale).prop_map(Vector3::from)
}

fn inertia() -> impl Strategy<Value = Inertia<f64>> {
    (
        0.1..3.0f64,
        vector(0.2),
        prop::array::uniform3(1e-3..0.1f64),
        rotation(),
    )
        .prop_map(|(mass, com, moments, rot)| {
            let principal = Matrix3::from_diagonal(&Vector3::from(moments));
            let second = rot.matrix() * principal * rot.matrix().transpose();
            Inertia::from_com(mass, com, Symmetric3::of(&second).trace_complement())
        })
}

fn body() -> impl Strategy<Value = (Body<f64>, usize)> {
    let kind = prop::sample::select(Kind::ALL.to_vec());
    (
        kind,
        rotation(),
        vector(0.5),
        inertia(),
        any::<bool>(),
        0.0..0.05f64,
        0..1000usize,
    )
        .prop_map(
            |(kind, rot, offset, inertia, flip, rotor_inertia, branch)| {
                let tilt = if kind.is_tilted() {
                    *rot.matrix()
                } else {
                    Matrix3::identity()
                };
                let row = |i: usize| [tilt[(i, 0)], tilt[(i, 1)], tilt[(i, 2)]];
                let body = Body {
                    kind,
                    sign: if flip { -1.0 } else { 1.0 },
                    offset: offset.into(),
                    tilt: [row(0), row(1), row(2)],
                    mass: inertia.mass,
                    first: inertia.first.into(),
                    second: inertia.second.to_array(),
                    rotor_inertia,
                    ..Body::EMPTY
                };
                (body, branch)
            },
        )
}

fn model() -> impl Strategy<Value = Model> {
    (
        prop::collection::vec(body(), 1..CAP),
        inertia(),
        any::<bool>(),
    )
        .prop_map(|(rows, base, floating)| {
            // Each body hangs from an ancestor-or-self of the one before it: depth-first order.
            let mut path: Vec<usize> = vec![];
            let mut bodies = vec![];
            for (i, (mut body, branch)) in rows.into_iter().enumerate() {
                path.truncate(path.len() - branch % 3 % (path.len() + 1));
                body.parent = path.last().map_or(Link::Base, |&p| Link::Joint(p));
                path.push(i);
                bodies.push(body);
            }
            let base = BaseBody {
                mass: base.mass,
                first: base.first.into(),
                second: base.second.to_array(),
            };
            let kind = if floating {
                BaseKind::Floating
            } else {
                BaseKind::Fixed
            };
            TableModel::new(kind, base, &bodies).unwrap()
        })
}

fn joints(scale: f64) -> impl Strategy<Value = [f64; CAP]> {
    prop::array::uniform24(-scale..scale)
}

fn motion(scale: f64) -> impl Strategy<Value = Motion<f64>> {
    (vector(scale), vector(scale)).prop_map(|(l, a)| Motion::new(l, a))
}

/// A state: configuration, velocity, acceleration; what the robot does not have is zero.
fn state() -> impl Strategy<Value = (Configuration<f64, CAP>, [Tangent<f64, CAP>; 2])> {
    let tangent = || (motion(2.0), joints(3.0)).prop_map(|(base, joints)| Tangent { base, joints });
    (rotation(), vector(2.0), joints(3.1), tangent(), tangent()).prop_map(|(r, p, q, v, a)| {
        (
            Configuration {
                base: Transform::new(r, p),
                joints: q,
            },
            [v, a],
        )
    })
}

fn masked(model: &Model, mut t: Tangent<f64, CAP>) -> Tangent<f64, CAP> {
    use rbd_core::Tree;
    for x in t.joints.iter_mut().skip(model.joint_count()) {
        *x = 0.0;
    }
    if model.base_kind() == BaseKind::Fixed {
        t.base = Motion::ZERO;
    }
    t
}

fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-10 * scale.max(1.0)
}

fn size(e: &Effort<f64, CAP>) -> f64 {
    (0..6 + CAP)
        .map(|i| e.coordinate(i).abs())
        .fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn mass_matrix_is_made_of_rnea_columns(model in model(), (q, [v, a]) in state()) {
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        let bias = rnea(&model, &posture, &v, &Tangent::ZERO);
        let full = rnea(&model, &posture, &v, &a);
        let product = m.mul(&a) + bias;
        for i in 0..6 + CAP {
            prop_assert!(close(product.coordinate(i), full.coordinate(i), size(&full)), "row {i}");
        }
    }

    #[test]
    fn aba_inverts_rnea(model in model(), (q, [v, a]) in state()) {
        use rbd_core::Tree;
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let tau = rnea(&model, &posture, &v, &a);
        let mut ws = AbaWorkspace::new();
        let mut back = aba(&model, &posture, &v, &tau, &mut ws);
        if model.base_kind() == BaseKind::Fixed {
            back.base = Motion::ZERO;
        }
        // The acceleration is only as good as the condition of M allows: judge it by its effort.
        let again = rnea(&model, &posture, &v, &back);
        for i in 0..6 + CAP {
            let (x, y) = (again.coordinate(i), tau.coordinate(i));
            prop_assert!((x - y).abs() <= 1e-9 * size(&tau).max(1.0), "row {i}: {x} {y}");
        }
    }

    #[test]
    fn jacobians_carry_velocity_and_force(
        model in model(), (q, [v, a]) in state(), link in 0..2 * CAP, rot in rotation(), arm in vector(0.3),
    ) {
        use rbd_core::Tree;
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &posture, &mut kinematics);
        let mut motions = BodyMotions::ZERO;
        forward_accelerations(&model, &posture, &v, &masked(&model, a), &mut motions);
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let row = |i: usize| [rot.matrix()[(i, 0)], rot.matrix()[(i, 1)], rot.matrix()[(i, 2)]];
        let frame = Frame { link, offset: arm.into(), rotation: [row(0), row(1), row(2)] };
        let pose = kinematics.frame(&frame);
        for axes in [Axes::Local, Axes::LocalWorldAligned, Axes::World] {
            let mut jac = FrameJacobian::ZERO;
            frame_jacobian(&model, &kinematics, &frame, axes, &mut jac);
            let direct = axes.motion(&pose, &motions.frame_velocity(&frame));
            let through = jac.mul(&v);
            for (x, y) in direct.to_array().into_iter().zip(through.to_array()) {
                prop_assert!(close(x, y, 30.0), "{axes:?}: {x} {y}");
            }
            // Power of a wrench is the same on both sides.
            let wrench = Force::new(arm, pose.translation);
            prop_assert!(close(through.dot(&wrench), v.dot(&jac.tr_mul(&wrench)), 100.0));
        }
        // J ν̇ + J̇ν is the acceleration.
        let mut bias = BodyMotions::ZERO;
        bias_accelerations(&model, &posture, &v, &mut bias);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::Local, &mut jac);
        let sum = jac.mul(&masked(&model, a)) + bias.frame_acceleration(&frame);
        for (x, y) in motions.frame_acceleration(&frame).to_array().into_iter().zip(sum.to_array()) {
            prop_assert!(close(x, y, 1e3), "{x} {y}");
        }
    }

    #[test]
    fn centroidal_quantities_agree(model in model(), (q, [v, a]) in state()) {
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut map = CentroidalMap::ZERO;
        centroidal_map(&model, &posture, &mut map);
        let state = centroidal_state(&model, &posture, &v);
        let scale = size(&Effort { base: state.momentum_w, joints: [0.0; CAP] });
        for (x, y) in map.momentum(&v).to_array().into_iter().zip(state.momentum_w.to_array()) {
            prop_assert!(close(x, y, scale), "momentum {x} {y}");
        }
        let mut jac = ComJacobian::ZERO;
        let com = com_jacobian(&model, &posture, &mut jac);
        prop_assert!((com.position_w - state.com_w).norm() < 1e-12);
        prop_assert!((map.com_w - state.com_w).norm() < 1e-12);
        prop_assert!((jac.mul(&v) - state.com_velocity_w).norm() < 1e-10);
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        prop_assert!(close(m.kinetic_energy(&v), state.kinetic_energy, state.kinetic_energy));
        // The rate of momentum is the sum of external forces but gravity.
        let rate = centroidal_momentum_rate(&model, &posture, &v, &a);
        let bias = centroidal_bias(&model, &posture, &v) + map.momentum(&a);
        let tau = rnea(&model, &posture, &v, &a);
        let weight = map.mass * 9.81;
        let force_w = posture.base().rotation * tau.base.linear;
        for (x, y) in rate.to_array().into_iter().zip(bias.to_array()) {
            prop_assert!(close(x, y, size(&tau)), "rate {x} {y}");
        }
        prop_assert!(close(rate.linear.z, force_w.z - weight, size(&tau)));
        prop_assert!(close(rate.linear.x, force_w.x, size(&tau)));
    }
}

#[test]
fn a_force_on_a_lone_base_obeys_newton() {
    let base = BaseBody {
        mass: 2.0,
        first: [0.0; 3],
        second: [0.01, 0.02, 0.03, 0.0, 0.0, 0.0],
    };
    let row = Body {
        mass: 1e-3,
        second: [1e-9, 1e-9, 1e-9, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let model = Model::new(BaseKind::Floating, base, &[row]).unwrap();
    let posture = Posture::new(&model, &Configuration::NEUTRAL);
    let effort = Effort {
        base: Force::from_array([0.0, 0.0, 4.0, 0.0, 0.0, 0.0]),
        joints: [0.0; CAP],
    };
    let a = aba(
        &model,
        &posture,
        &Tangent::ZERO,
        &effort,
        &mut AbaWorkspace::new(),
    );
    assert!((a.base.linear.z - (4.0 / 2.001 - 9.81)).abs() < 1e-12);
}
