//! Analytic derivatives against central differences on the manifold, on random trees, and the inverse of
//! the mass matrix against the matrix.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, Model, joints, masked, model, motion, rotation, state, vector};
use nalgebra::{Rotation3, SMatrix};
use proptest::prelude::*;
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AbaWorkspace, AccelerationKind, Axes, BaseKind,
    BlockMatrix, BodyMotions, CentroidalDerivatives, Configuration, DerivativesWorkspace, Effort,
    Force, ForceColumns, Frame, FrameDerivatives, FrameJacobian, Kinematics, Link, MassFactors,
    MassMatrix, Motion, Posture, RneaDerivatives, Tangent, Transform, Tree, aba,
    aba_derivatives_with_forces, aba_with_forces, centroidal_derivatives, centroidal_momentum_rate,
    centroidal_state, crba, forward_accelerations, forward_kinematics, frame_derivatives, rnea,
    rnea_derivatives, rnea_derivatives_with_forces, rnea_with_forces,
};

const V: usize = 6 + CAP;
type Dense = SMatrix<f64, V, V>;

/// The configuration a small displacement away, in base axes.
fn displaced(q: &Configuration<f64, CAP>, d: &Tangent<f64, CAP>) -> Configuration<f64, CAP> {
    let base = &q.base;
    let mut out = *q;
    out.base = Transform::new(
        base.rotation * Rotation3::from_scaled_axis(d.base.angular),
        base.translation + base.rotation * d.base.linear,
    );
    for (x, y) in out.joints.iter_mut().zip(d.joints) {
        *x += y;
    }
    out
}

/// Derivative of a vector of V entries along every coordinate, by central differences with Richardson's
/// extrapolation: error of order h⁴.
fn differences(count: usize, f: impl Fn(&Tangent<f64, CAP>) -> [f64; V]) -> Dense {
    let h = 2e-3;
    let mut out = Dense::zeros();
    for j in 0..6 + count {
        let unit = Tangent::unit(j);
        let slope = |h: f64| {
            let (plus, minus) = (f(&(unit * h)), f(&(unit * -h)));
            core::array::from_fn::<f64, V, _>(|i| (plus[i] - minus[i]) / (2.0 * h))
        };
        let (coarse, fine) = (slope(h), slope(h / 2.0));
        for i in 0..V {
            out[(i, j)] = (4.0 * fine[i] - coarse[i]) / 3.0;
        }
    }
    out
}

fn entries(e: &Effort<f64, CAP>) -> [f64; V] {
    core::array::from_fn(|i| e.coordinate(i))
}

fn coordinates(t: &Tangent<f64, CAP>) -> [f64; V] {
    core::array::from_fn(|i| t.coordinate(i))
}

/// Largest difference relative to the largest entry (at least 1).
fn distance(a: &Dense, b: &Dense) -> f64 {
    (a - b).amax() / a.amax().max(b.amax()).max(1.0)
}

fn blocks(m: &Dense) -> BlockMatrix<f64, CAP> {
    let mut out = BlockMatrix::ZERO;
    for i in 0..V {
        for j in 0..V {
            let slot = match (i.checked_sub(6), j.checked_sub(6)) {
                (None, None) => &mut out.base[i][j],
                (None, Some(j)) => &mut out.base_joints[i][j],
                (Some(i), None) => &mut out.joints_base[i][j],
                (Some(i), Some(j)) => &mut out.joints[i][j],
            };
            *slot = m[(i, j)];
        }
    }
    out
}

fn forces() -> impl Strategy<Value = [Force<f64>; CAP]> {
    prop::collection::vec(
        motion(5.0).prop_map(|m| Force::new(m.linear, m.angular)),
        CAP,
    )
    .prop_map(|x| x.try_into().unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn rnea_derivatives_are_differences(model in model(), (q, [v, a]) in state(), f in forces()) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let n = model.joint_count();
        let posture = Posture::new(&model, &q);
        let (mut ws, mut d) = (DerivativesWorkspace::new(), RneaDerivatives::ZERO);
        rnea_derivatives(&model, &posture, &v, &a, &mut ws, &mut d);

        let tau = |p: &Posture<f64, CAP>, v: &Tangent<f64, CAP>, a: &Tangent<f64, CAP>| {
            entries(&rnea(&model, p, v, a))
        };
        let by_q = differences(n, |d| tau(&Posture::new(&model, &displaced(&q, d)), &v, &a));
        let by_v = differences(n, |d| tau(&posture, &(v + *d), &a));
        prop_assert!(distance(&d.by_position.to_dense(), &by_q) < 1e-8);
        prop_assert!(distance(&d.by_velocity.to_dense(), &by_v) < 1e-8);
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        prop_assert!(distance(&d.by_acceleration.to_dense(), &m.to_dense()) < 1e-12);

        rnea_derivatives_with_forces(&model, &posture, &v, &a, &f, &mut ws, &mut d);
        let by_q = differences(n, |d| {
            let p = Posture::new(&model, &displaced(&q, d));
            entries(&rnea_with_forces(&model, &p, &v, &a, &Force::ZERO, &f))
        });
        prop_assert!(distance(&d.by_position.to_dense(), &by_q) < 1e-8);
        prop_assert!(distance(&d.by_velocity.to_dense(), &by_v) < 1e-8);
    }

    #[test]
    fn aba_derivatives_are_differences(model in model(), (q, [v, t]) in state(), f in forces()) {
        let (v, t) = (masked(&model, v), masked(&model, t));
        let n = model.joint_count();
        let posture = Posture::new(&model, &q);
        let tau = Effort {
            base: Force::new(t.base.linear, t.base.angular),
            joints: t.joints,
        };
        let mut ws = AbaDerivativesWorkspace::new();
        let (mut d, mut pushed) = (AbaDerivatives::ZERO, AbaDerivatives::ZERO);
        rbd_core::aba_derivatives(&model, &posture, &v, &tau, &mut ws, &mut d);

        let qdd = |p: &Posture<f64, CAP>, v: &Tangent<f64, CAP>, tau: &Effort<f64, CAP>| {
            coordinates(&aba(&model, p, v, tau, &mut AbaWorkspace::new()))
        };
        let value = qdd(&posture, &v, &tau);
        let size = value.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        for (x, y) in coordinates(&d.acceleration).into_iter().zip(value) {
            prop_assert!((x - y).abs() < 1e-8 * size);
        }
        let by_q = differences(n, |d| qdd(&Posture::new(&model, &displaced(&q, d)), &v, &tau));
        let mut by_v = differences(n, |d| qdd(&posture, &(v + *d), &tau));
        if model.base_kind() == BaseKind::Fixed {
            prop_assert!(d.by_position.base.as_flattened().iter().all(|&x| x == 0.0));
            prop_assert!(by_v.rows(0, 6).amax() == 0.0);
        }
        // M⁻¹ amplifies rounding by the condition of M: judge relative to the largest entry.
        prop_assert!(distance(&d.by_position.to_dense(), &by_q) < 1e-6, "{}", distance(&d.by_position.to_dense(), &by_q));
        aba_derivatives_with_forces(&model, &posture, &v, &tau, &f, &mut ws, &mut pushed);
        let by_q = differences(n, |d| {
            let p = Posture::new(&model, &displaced(&q, d));
            coordinates(&aba_with_forces(&model, &p, &v, &tau, &f, &mut AbaWorkspace::new()))
        });
        prop_assert!(distance(&pushed.by_position.to_dense(), &by_q) < 1e-6);

        by_v -= d.by_velocity.to_dense();
        prop_assert!(by_v.amax() < 1e-6 * d.by_velocity.to_dense::<V>().amax().max(1.0));
    }

    #[test]
    fn the_inverse_inverts(model in model(), (q, [x, _]) in state()) {
        let n = model.joint_count();
        let posture = Posture::new(&model, &q);
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        let (mut factors, mut inverse) = (MassFactors::new(), BlockMatrix::ZERO);
        rbd_core::mass_matrix_inverse(&model, &m, &mut factors, &mut inverse);
        let (m, w): (Dense, Dense) = (m.to_dense(), inverse.to_dense());
        let first = if model.base_kind() == BaseKind::Fixed { 6 } else { 0 };
        // Outside of the coordinates that the robot has, the product shall be zero.
        let mut identity = Dense::zeros();
        for i in first..6 + n {
            identity[(i, i)] = 1.0;
        }
        let product = identity * m * w;
        let condition = m.amax() * w.amax();
        let off = (product - identity).amax();
        prop_assert!(off < 1e-13 * condition.max(10.0), "{off} at condition {condition}");
        prop_assert!((w - w.transpose()).amax() <= 1e-13 * w.amax() * condition);

        // M⁻¹ M, column by column.
        let mut columns = blocks(&m);
        factors.solve_columns(&mut columns);
        let off = (identity * columns.to_dense::<V>() * identity - identity).amax();
        prop_assert!(off < 1e-13 * condition.max(10.0), "{off} at condition {condition}");

        // solve(x) is the product with the inverse.
        let x = masked(&model, x);
        let effort = Effort { base: Force::new(x.base.linear, x.base.angular), joints: x.joints };
        let y = coordinates(&factors.solve(&effort));
        let (base, joints) = inverse.mul(effort.base.to_array(), &effort.joints);
        for (a, b) in base.into_iter().chain(joints).zip(y) {
            prop_assert!((a - b).abs() < 1e-12 * condition * w.amax());
        }
    }

    #[test]
    fn frame_derivatives_are_differences(
        model in model(), (q, [v, a]) in state(), link in 0..2 * CAP, rot in rotation(), arm in vector(0.3),
        axes in prop::sample::select(vec![Axes::Local, Axes::LocalWorldAligned, Axes::World]),
        kind in prop::sample::select(vec![AccelerationKind::Spatial, AccelerationKind::Classical]),
    ) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let n = model.joint_count();
        let r = rot.matrix();
        let frame = Frame {
            link: if link < n { Link::Joint(link) } else if link % 8 == 0 { Link::Base } else { Link::Joint(n - 1) },
            offset: arm.into(),
            rotation: core::array::from_fn(|i| core::array::from_fn(|j| r[(i, j)])),
        };
        // Velocity, then acceleration, in the first 12 of V entries.
        let look = |q: &Configuration<f64, CAP>, v: &Tangent<f64, CAP>, a: &Tangent<f64, CAP>| {
            let (mut k, mut m) = (Kinematics::IDENTITY, BodyMotions::ZERO);
            let posture = Posture::new(&model, q);
            forward_kinematics(&model, &posture, &mut k);
            forward_accelerations(&model, &posture, v, a, &mut m);
            let acceleration = match kind {
                AccelerationKind::Spatial => m.frame_acceleration(&frame),
                AccelerationKind::Classical => m.frame_classical_acceleration(&frame),
            };
            let xf = k.frame(&frame);
            let pair = [m.frame_velocity(&frame), acceleration].map(|x| axes.motion(&xf, &x).to_array());
            let flat = core::array::from_fn(|i| pair.as_flattened().get(i).copied().unwrap_or(0.0));
            (flat, k, m)
        };
        let (_, k, m) = look(&q, &v, &a);
        let mut d = FrameDerivatives::ZERO;
        frame_derivatives(&model, &k, &m, &frame, kind, axes, &mut d);
        let by_q = differences(n, |d| look(&displaced(&q, d), &v, &a).0);
        let by_v = differences(n, |d| look(&q, &(v + *d), &a).0);
        let by_a = differences(n, |d| look(&q, &v, &(a + *d)).0);
        let six = |m: &Dense, row: usize| m.fixed_view::<6, V>(row, 0).into_owned();
        let off = |ours: &FrameJacobian<f64, CAP>, theirs: SMatrix<f64, 6, V>| {
            (ours.to_dense() - theirs).amax() / theirs.amax().max(1.0)
        };
        prop_assert!(off(&d.velocity_by_position, six(&by_q, 0)) < 1e-8);
        prop_assert!(off(&d.jacobian, six(&by_v, 0)) < 1e-8);
        prop_assert!(off(&d.acceleration_by_position, six(&by_q, 6)) < 1e-8);
        prop_assert!(off(&d.acceleration_by_velocity, six(&by_v, 6)) < 1e-8);
        prop_assert!(off(&d.jacobian, six(&by_a, 6)) < 1e-8);
    }

    #[test]
    fn centroidal_derivatives_are_differences(model in model(), (q, [v, a]) in state()) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let n = model.joint_count();
        let posture = Posture::new(&model, &q);
        let look = |p: &Posture<f64, CAP>, v: &Tangent<f64, CAP>, a: &Tangent<f64, CAP>| {
            let momentum = centroidal_state(&model, p, v).momentum_w;
            let pair = [momentum, centroidal_momentum_rate(&model, p, v, a)].map(Force::to_array);
            core::array::from_fn(|i| pair.as_flattened().get(i).copied().unwrap_or(0.0))
        };
        let mut d = CentroidalDerivatives::ZERO;
        let mut ws = DerivativesWorkspace::new();
        centroidal_derivatives(&model, &posture, &v, &a, &mut ws, &mut d);
        let values: [f64; V] = look(&posture, &v, &a);
        for (x, y) in [d.momentum, d.rate].map(Force::to_array).as_flattened().iter().zip(values) {
            prop_assert!((x - y).abs() < 1e-10 * values.iter().fold(1.0, |m: f64, x| m.max(x.abs())));
        }
        let by_q = differences(n, |d| look(&Posture::new(&model, &displaced(&q, d)), &v, &a));
        let by_v = differences(n, |d| look(&posture, &(v + *d), &a));
        let by_a = differences(n, |d| look(&posture, &v, &(a + *d)));
        let six = |m: &Dense, row: usize| m.fixed_view::<6, V>(row, 0).into_owned();
        let off = |ours: &ForceColumns<f64, CAP>, theirs: SMatrix<f64, 6, V>| {
            (ours.to_dense() - theirs).amax() / theirs.amax().max(1.0)
        };
        prop_assert!(off(&d.momentum_by_position, six(&by_q, 0)) < 1e-8);
        prop_assert!(off(&d.map, six(&by_v, 0)) < 1e-8);
        prop_assert!(off(&d.rate_by_position, six(&by_q, 6)) < 1e-8);
        prop_assert!(off(&d.rate_by_velocity, six(&by_v, 6)) < 1e-8);
        prop_assert!(off(&d.map, six(&by_a, 6)) < 1e-8);
    }

    #[test]
    fn first_order_change(model in model(), (q, [v, a]) in state(), dq in joints(1.0)) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let d = masked(&model, Tangent { base: Motion::ZERO, joints: dq });
        let mut out = RneaDerivatives::ZERO;
        let posture = Posture::new(&model, &q);
        rnea_derivatives(&model, &posture, &v, &a, &mut DerivativesWorkspace::new(), &mut out);
        // What is left is of second order in h: 1e-4 of the change itself.
        let h = 1e-6;
        let d = d * h;
        let before = rnea(&model, &posture, &v, &a);
        let after = rnea(&model, &Posture::new(&model, &displaced(&q, &d)), &(v + d), &(a + d));
        let error = entries(&(after - before - out.change(&d, &d, &d)));
        let size = entries(&before).into_iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        prop_assert!(error.into_iter().all(|e| e.abs() < 1e-10 * size));
    }
}

#[test]
fn massless_joints_do_not_answer() {
    use rbd_core::{BaseBody, Body};
    let base = BaseBody {
        mass: 2.0,
        first: [0.0; 3],
        second: [0.01, 0.02, 0.03, 0.0, 0.0, 0.0],
    };
    let model = Model::new(BaseKind::Floating, base, &[Body::EMPTY]).unwrap();
    let posture = Posture::new(&model, &Configuration::NEUTRAL);
    let mut m = MassMatrix::ZERO;
    crba(&model, &posture, &mut m);
    let mut factors = MassFactors::new();
    let mut inverse = BlockMatrix::ZERO;
    rbd_core::mass_matrix_inverse(&model, &m, &mut factors, &mut inverse);
    assert!(inverse.joints.as_flattened().iter().all(|&x| x == 0.0));
    assert!((inverse.base[0][0] - 0.5).abs() < 1e-15);
    let a = factors.solve(&Effort::unit(6));
    assert_eq!(a, Tangent::ZERO);
}
