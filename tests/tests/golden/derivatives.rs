//! Derivatives of dynamics, frames and centroidal momentum, and the inverse mass matrix.

use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AccelerationKind, Axes, BlockMatrix, BodyMotions,
    CentroidalDerivatives, DerivativesWorkspace, Effort, Frame, FrameDerivatives, FrameJacobian,
    Kinematics, MassFactors, MassMatrix, Posture, RneaDerivatives, Tangent, Tree,
};
use saltus_tests::golden::Record;
use so3::Scalar;

use crate::{Entries as _, Worst, lower};

pub(crate) fn derivatives<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
    tau: &Effort<T, N>,
) {
    let mut mass = MassMatrix::ZERO;
    rbd_core::crba(model, posture, &mut mass);
    let (mut factors, mut inverse) = (MassFactors::new(), BlockMatrix::ZERO);
    rbd_core::mass_matrix_inverse(model, &mass, &mut factors, &mut inverse);
    w.see(
        state,
        "mass_matrix_inverse_lower",
        lower(&inverse.to_dense::<V>()),
    );
    let mut ws = DerivativesWorkspace::new();
    let mut of = RneaDerivatives::ZERO;
    rbd_core::rnea_derivatives(model, posture, v, a, &mut ws, &mut of);
    w.see(
        state,
        "rnea_derivatives.dq",
        of.by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "rnea_derivatives.dv",
        of.by_velocity.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "mass_matrix_lower",
        lower(&of.by_acceleration.to_dense::<V>()),
    );
    let mut ws = AbaDerivativesWorkspace::new();
    let mut of = AbaDerivatives::ZERO;
    rbd_core::aba_derivatives(model, posture, v, tau, &mut ws, &mut of);
    w.see(state, "aba", of.acceleration.entries());
    w.see(
        state,
        "aba_derivatives.dq",
        of.by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "aba_derivatives.dv",
        of.by_velocity.to_dense::<V>().entries(),
    );
    w.see(
        state,
        "mass_matrix_inverse_lower",
        lower(&of.by_effort.to_dense::<V>()),
    );
}

pub(crate) fn frame_derivatives<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    frames: &[(&str, Frame<T>)],
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
) {
    let mut kinematics = Kinematics::IDENTITY;
    rbd_core::forward_kinematics(model, posture, &mut kinematics);
    let mut motions = BodyMotions::ZERO;
    rbd_core::forward_accelerations(model, posture, v, a, &mut motions);
    for (name, frame) in frames.iter().take(2) {
        let derive = |kind, axes| {
            let mut of = FrameDerivatives::ZERO;
            rbd_core::frame_derivatives(model, &kinematics, &motions, frame, kind, axes, &mut of);
            of
        };
        let key = |tail: &str| format!("{name}.{tail}");
        let of = derive(AccelerationKind::Spatial, Axes::Local);
        let dense = |j: &FrameJacobian<T, N>| j.to_dense::<V>().entries();
        w.see(
            state,
            &key("velocity_dq_l"),
            dense(&of.velocity_by_position),
        );
        w.see(
            state,
            &key("spatial_acceleration_dq_l"),
            dense(&of.acceleration_by_position),
        );
        w.see(
            state,
            &key("spatial_acceleration_dv_l"),
            dense(&of.acceleration_by_velocity),
        );
        let of = derive(AccelerationKind::Classical, Axes::LocalWorldAligned);
        let top = |j: &FrameJacobian<T, N>| dense(j)[..3 * V].to_vec();
        w.see(
            state,
            &key("point_acceleration_dq_a"),
            top(&of.acceleration_by_position),
        );
        w.see(
            state,
            &key("point_acceleration_dv_a"),
            top(&of.acceleration_by_velocity),
        );
    }
}

pub(crate) fn centroidal_derivatives<T: Scalar, M: Tree<T, N>, const N: usize, const V: usize>(
    w: &mut Worst,
    model: &M,
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
) {
    let mut ws = DerivativesWorkspace::new();
    let mut of = CentroidalDerivatives::ZERO;
    rbd_core::centroidal_derivatives(model, posture, v, a, &mut ws, &mut of);
    w.see(state, "centroidal.momentum", of.momentum.to_array());
    w.see(state, "centroidal.momentum_rate", of.rate.to_array());
    w.see(state, "centroidal.map", of.map.to_dense::<V>().entries());
    let key = |tail: &str| format!("centroidal_derivatives.{tail}");
    w.see(
        state,
        &key("momentum_dq"),
        of.momentum_by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        &key("rate_dq"),
        of.rate_by_position.to_dense::<V>().entries(),
    );
    w.see(
        state,
        &key("rate_dv"),
        of.rate_by_velocity.to_dense::<V>().entries(),
    );
}
