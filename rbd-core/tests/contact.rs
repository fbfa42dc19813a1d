//! Contact dynamics and impacts obey their equations, also where rows depend on each other.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, masked, model, state, vector};
use proptest::prelude::*;
use rbd_core::{
    AbaWorkspace, Axes, BodyMotions, ContactRow, ContactWorkspace, Effort, Frame, FrameJacobian,
    Kinematics, Link, MassFactors, MassMatrix, Posture, Tangent, Tree, aba, bias_accelerations,
    contact_dynamics, crba, forward_kinematics, frame_jacobian, impact, nonlinear_effects,
};

const ROWS: usize = 12;
const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The leaf that ends the chain of the first joint, as far from the base as the table goes.
fn last_leaf(model: &crate::common::Model) -> usize {
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
        if model.base_kind() == rbd_core::BaseKind::Floating {
            prop_assert!(solution.residual <= 1e-6 * scale, "residual {}", solution.residual);
        }
        // M ν̇ + h = τ + Jᵀ λ, whatever the rows.
        let mut push = effort;
        for (row, &force) in rows.iter().zip(&solution.forces) {
            push = push + row.gradient * force;
        }
        let left = mass.mul(&solution.motion) + nonlinear_effects(&model, &posture, &v);
        let size = (0..6 + CAP).map(|i| push.coordinate(i).abs()).fold(1.0, f64::max);
        let first = if model.base_kind() == rbd_core::BaseKind::Floating { 0 } else { 6 };
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
        if model.base_kind() == rbd_core::BaseKind::Floating {
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
