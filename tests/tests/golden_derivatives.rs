//! Derivatives of rbd-core, and the inverse of the mass matrix, against Pinocchio's values.
//!
//! Errors are relative to the largest entry of the quantity: at most 1e-10 in f64.

#![allow(clippy::unwrap_used, reason = "tests")]

use nalgebra::{Quaternion, SMatrix, UnitQuaternion, Vector3};
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AccelerationKind, Axes, BodyMotions,
    CentroidalDerivatives, Configuration, DerivativesWorkspace, Effort, Force, Frame,
    FrameDerivatives, FrameJacobian, Kinematics, Motion, Posture, RneaDerivatives, Tangent,
    Transform, Tree,
};
use saltus_tests::golden::{Golden, Record};
use saltus_tests::tables::{A1, A1_FRAMES, ICUB_FRAMES, Icub23};

/// States for which the golden file has derivatives, and the worst error.
#[derive(Default)]
struct Seen {
    states: usize,
    worst: f64,
}

impl Seen {
    fn see<const R: usize, const C: usize>(
        &mut self,
        state: &Record,
        key: &str,
        ours: &SMatrix<f64, R, C>,
    ) {
        let theirs = state.get(key);
        assert_eq!((theirs.rows, theirs.cols), (R, C), "{key}");
        let theirs = SMatrix::<f64, R, C>::from_row_slice(&theirs.values);
        let error = (ours - theirs).amax() / theirs.amax();
        println!("{key}: {error:.1e}");
        assert!(error <= 1e-10, "{key}: relative error {error:e}");
        self.worst = self.worst.max(error);
    }
}

fn tangent<const N: usize>(x: &[f64]) -> Tangent<f64, N> {
    Tangent {
        base: Motion::from_array(core::array::from_fn(|i| x[i])),
        joints: core::array::from_fn(|i| x[6 + i]),
    }
}

fn configuration<const N: usize>(x: &[f64]) -> Configuration<f64, N> {
    let quat = UnitQuaternion::new_unchecked(Quaternion::new(x[6], x[3], x[4], x[5]));
    Configuration {
        base: Transform::new(quat.to_rotation_matrix(), Vector3::new(x[0], x[1], x[2])),
        joints: core::array::from_fn(|i| x[7 + i]),
    }
}

type Frames = [(&'static str, Frame<f64>)];

fn compare<M: Tree<f64, N>, const N: usize, const V: usize>(
    model: &M,
    robot: &str,
    frames: &Frames,
) {
    let golden = Golden::load(robot);
    let mut seen = Seen::default();
    let mut ws = AbaDerivativesWorkspace::new();
    for state in &golden.states {
        let Some(inverse) = state.find("mass_matrix_inverse_lower") else {
            continue;
        };
        seen.states += 1;
        let posture = Posture::new(model, &configuration(state.values("q")));
        let (v, a) = (tangent(state.values("v")), tangent(state.values("a")));
        let mut id = RneaDerivatives::ZERO;
        rbd_core::rnea_derivatives(
            model,
            &posture,
            &v,
            &a,
            &mut DerivativesWorkspace::new(),
            &mut id,
        );
        seen.see::<V, V>(state, "rnea_derivatives.dq", &id.by_position.to_dense());
        seen.see::<V, V>(state, "rnea_derivatives.dv", &id.by_velocity.to_dense());

        let mut cd = CentroidalDerivatives::ZERO;
        let mut scratch = DerivativesWorkspace::new();
        rbd_core::centroidal_derivatives(model, &posture, &v, &a, &mut scratch, &mut cd);
        let key = |name: &str| format!("centroidal_derivatives.{name}");
        seen.see::<6, V>(
            state,
            &key("momentum_dq"),
            &cd.momentum_by_position.to_dense(),
        );
        seen.see::<6, V>(state, &key("rate_dq"), &cd.rate_by_position.to_dense());
        seen.see::<6, V>(state, &key("rate_dv"), &cd.rate_by_velocity.to_dense());
        seen.see::<6, V>(state, "centroidal.map", &cd.map.to_dense());

        let (mut kinematics, mut motions) = (Kinematics::IDENTITY, BodyMotions::ZERO);
        rbd_core::forward_kinematics(model, &posture, &mut kinematics);
        rbd_core::forward_accelerations(model, &posture, &v, &a, &mut motions);
        let mut compared = 0;
        for (name, frame) in frames {
            let key = |what: &str| format!("{name}.{what}");
            if state.find(&key("velocity_dq_l")).is_none() {
                continue;
            }
            compared += 1;
            let mut d = FrameDerivatives::ZERO;
            let mut at = |kind, axes| {
                rbd_core::frame_derivatives(
                    model,
                    &kinematics,
                    &motions,
                    frame,
                    kind,
                    axes,
                    &mut d,
                );
                d
            };
            let d = at(AccelerationKind::Spatial, Axes::Local);
            seen.see::<6, V>(
                state,
                &key("velocity_dq_l"),
                &d.velocity_by_position.to_dense(),
            );
            seen.see::<6, V>(
                state,
                &key("spatial_acceleration_dq_l"),
                &d.acceleration_by_position.to_dense(),
            );
            seen.see::<6, V>(
                state,
                &key("spatial_acceleration_dv_l"),
                &d.acceleration_by_velocity.to_dense(),
            );
            let d = at(AccelerationKind::Classical, Axes::LocalWorldAligned);
            let linear =
                |j: &FrameJacobian<f64, N>| j.to_dense::<V>().fixed_rows::<3>(0).into_owned();
            seen.see::<3, V>(
                state,
                &key("point_acceleration_dq_a"),
                &linear(&d.acceleration_by_position),
            );
            seen.see::<3, V>(
                state,
                &key("point_acceleration_dv_a"),
                &linear(&d.acceleration_by_velocity),
            );
        }
        assert_eq!(compared, 2, "{robot}: frames with derivatives");

        let tau: Tangent<f64, N> = tangent(state.values("tau"));
        let tau = Effort {
            base: Force::new(tau.base.linear, tau.base.angular),
            joints: tau.joints,
        };
        let mut fd = AbaDerivatives::ZERO;
        rbd_core::aba_derivatives(model, &posture, &v, &tau, &mut ws, &mut fd);
        seen.see::<V, V>(state, "aba_derivatives.dq", &fd.by_position.to_dense());
        seen.see::<V, V>(state, "aba_derivatives.dv", &fd.by_velocity.to_dense());
        let inverse = SMatrix::<f64, V, V>::from_row_slice(&inverse.symmetric(V).values);
        let error = (fd.by_effort.to_dense() - inverse).amax() / inverse.amax();
        assert!(
            error <= 1e-10,
            "inverse mass matrix: relative error {error:e}"
        );
    }
    assert!(
        seen.states >= 6,
        "{robot}: the golden file has too few derivatives"
    );
    println!(
        "{robot}: {} states, worst relative error {:.1e}",
        seen.states, seen.worst
    );
}

#[test]
fn a1_agrees_with_pinocchio() {
    compare::<_, 12, 18>(&A1, "a1", &A1_FRAMES);
}

#[test]
fn icub_agrees_with_pinocchio() {
    compare::<_, 23, 29>(&Icub23, "icub23", &ICUB_FRAMES);
}
