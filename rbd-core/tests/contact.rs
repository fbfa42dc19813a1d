//! Contact dynamics and impacts obey their equations, also where rows depend on each other.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, Model, masked, model, state, vector};
use proptest::prelude::*;
use rbd_core::{
    AbaWorkspace, Axes, BaseKind, BodyMotions, ContactRow, ContactWorkspace, Effort, Frame,
    FrameJacobian, Kinematics, Link, MassFactors, MassMatrix, Posture, Tangent, Tree, aba,
    bias_accelerations, contact_dynamics, crba, forward_kinematics, frame_jacobian, impact,
    nonlinear_effects,
};

const ROWS: usize = 12;
const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The leaf that ends the chain of the first joint, as far from the base as the table goes.
fn last_leaf(model: &Model) -> usize {
    model.joint_count() - 1
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn contact_obeys_both_equations(
        model in model(), (q, [v, _]) in state(), tau in crate::common::joints(20.0), arm in vector(0.3),
    ) {
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &posture, &mut kinematics);
        let mut motions = BodyMotions::ZERO;
        bias_accelerations(&model, &posture, &v, &mut motions);
        let mut mass = MassMatrix::ZERO;
        crba(&model, &posture, &mut mass);
        let mut factors = MassFactors::new();
        factors.factor(&model, &mass);

        let frame = Frame { link: Link::Joint(last_leaf(&model)), offset: arm.into(), rotation: IDENTITY };
        let pose = kinematics.frame(&frame);
        let mut jacobian = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::LocalWorldAligned, &mut jacobian);
        let bias = pose.rotation * motions.frame_classical_acceleration(&frame).linear;
        let once = ContactRow::point(&jacobian, &bias);
        // The same point twice: every row depends on another.
        let rows = [once, once].concat();

        let mut joints = tau;
        joints[model.joint_count()..].fill(0.0);
        let effort = Effort { base: Effort::<f64, CAP>::ZERO.base, joints };
        let free = aba(&model, &posture, &v, &effort, &mut AbaWorkspace::new());
        let mut ws = ContactWorkspace::<f64, CAP, ROWS>::new();
        let solution = contact_dynamics(&factors, &free, &rows, &mut ws);
        let scale = bias.norm().max(rows.iter().map(|r| free.dot(&r.gradient).abs()).fold(1.0, f64::max));

        // A fixed-base robot with fewer than three joints cannot hold three rows.
        if model.base_kind() == BaseKind::Floating {
            prop_assert!(solution.residual <= 1e-6 * scale, "residual {}", solution.residual);
        }
        // M ν̇ + h = τ + Jᵀ λ, whatever the rows.
        let mut push = effort;
        for (row, &force) in rows.iter().zip(&solution.forces) {
            push = push + row.gradient * force;
        }
        let left = mass.mul(&solution.motion) + nonlinear_effects(&model, &posture, &v);
        let size = (0..6 + CAP).map(|i| push.coordinate(i).abs()).fold(1.0, f64::max);
        let first = if model.base_kind() == BaseKind::Floating { 0 } else { 6 };
        for i in first..6 + CAP {
            let (x, y) = (left.coordinate(i), push.coordinate(i));
            prop_assert!((x - y).abs() <= 1e-7 * size, "row {i}: {x} {y}");
        }
        // Least norm: the twin rows share the load.
        for i in 0..3 {
            let (x, y) = (solution.forces[i], solution.forces[i + 3]);
            prop_assert!((x - y).abs() <= 1e-6 * size, "{x} {y}");
        }
    }

    /// The unit in which a row is written, metres or millimetres, changes the number of its force and nothing else: neither the
    /// motion nor the load.
    #[test]
    fn the_unit_of_a_row_changes_neither_motion_nor_load(
        robot in model(), (q, [v, free]) in state(), arm in vector(0.3), units in prop::array::uniform3(0.02..1.0f64),
    ) {
        let bodies = &robot.bodies()[..robot.joint_count()];
        let model = Model::new(BaseKind::Floating, *robot.base(), bodies).unwrap();
        let [v, free] = [v, free].map(|x| masked(&model, x));
        let posture = Posture::new(&model, &q);
        let (mut kinematics, mut motions) = (Kinematics::IDENTITY, BodyMotions::ZERO);
        forward_kinematics(&model, &posture, &mut kinematics);
        bias_accelerations(&model, &posture, &v, &mut motions);
        let (mut mass, mut factors) = (MassMatrix::ZERO, MassFactors::new());
        crba(&model, &posture, &mut mass);
        factors.factor(&model, &mass);
        let frame = Frame { link: Link::Base, offset: arm.into(), rotation: IDENTITY };
        let mut jacobian = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::Local, &mut jacobian);
        let bias = motions.frame_classical_acceleration(&frame).linear;
        let rows = ContactRow::point(&jacobian, &bias);
        let scaled: [_; 3] = core::array::from_fn(|i| ContactRow {
            gradient: rows[i].gradient * units[i],
            bias: rows[i].bias * units[i],
        });
        let mut ws = ContactWorkspace::<f64, CAP, 3>::new();
        let plain = contact_dynamics(&factors, &free, &rows, &mut ws);
        let other = contact_dynamics(&factors, &free, &scaled, &mut ws);
        let wanted = rows.iter().map(|row| (free.dot(&row.gradient) + row.bias).abs()).fold(1.0, f64::max);
        let load = plain.forces.iter().map(|f| f.abs()).fold(1.0, f64::max);
        for i in 0..3 {
            let left = other.motion.dot(&rows[i].gradient) + rows[i].bias;
            prop_assert!(left.abs() <= 1e-10 * wanted, "row {i}: {left}");
            prop_assert!((other.forces[i] * units[i] - plain.forces[i]).abs() <= 1e-10 * load);
        }
    }

    #[test]
    fn an_impact_stops_the_point_and_costs_energy(
        model in model(), (q, [v, _]) in state(), arm in vector(0.3), restitution in 0.0..1.0f64,
    ) {
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &posture, &mut kinematics);
        let mut mass = MassMatrix::ZERO;
        crba(&model, &posture, &mut mass);
        let mut factors = MassFactors::new();
        factors.factor(&model, &mass);
        let frame = Frame { link: Link::Joint(last_leaf(&model)), offset: arm.into(), rotation: IDENTITY };
        let mut jacobian = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::LocalWorldAligned, &mut jacobian);
        let rows = ContactRow::point(&jacobian, &nalgebra::Vector3::zeros());
        let mut ws = ContactWorkspace::<f64, CAP, ROWS>::new();
        let after = impact(&factors, &v, restitution, &rows, &mut ws);
        let before = jacobian.mul(&v).linear;
        if model.base_kind() == BaseKind::Floating {
            let rebound = jacobian.mul(&after.motion).linear + before * restitution;
            prop_assert!(rebound.norm() <= 1e-6 * before.norm().max(1.0), "{rebound}");
        }
        let (e0, e1) = (mass.kinetic_energy(&v), mass.kinetic_energy(&after.motion));
        prop_assert!(e1 <= e0 * (1.0 + 1e-9) + 1e-9, "{e0} -> {e1}");
    }
}

#[test]
fn no_rows_change_nothing() {
    let factors = MassFactors::<f64, 3>::new();
    let free = Tangent {
        joints: [1.0, 2.0, 3.0],
        ..Tangent::ZERO
    };
    let mut ws = ContactWorkspace::<f64, 3, 4>::new();
    let solution = contact_dynamics(&factors, &free, &[], &mut ws);
    assert_eq!((solution.motion, solution.residual), (free, 0.0));
}
