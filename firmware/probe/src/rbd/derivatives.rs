//! Derivatives of inverse and forward dynamics, of a frame's motion and of the momentum.

use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AccelerationKind, Axes, CentroidalDerivatives,
    DerivativesWorkspace, FrameDerivatives, Posture, RneaDerivatives, Tree, aba_derivatives,
    aba_derivatives_with_forces, centroidal_derivatives, frame_derivatives, rnea_derivatives,
    rnea_derivatives_with_forces,
};

use super::kinematics::Place;
use super::state::State;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
    place: &Place<'_, T, N>,
) {
    inverse::<T, R, M, N>(on, model, posture, state);
    forward::<T, R, M, N>(on, model, posture, state);
    moving_frame(on, model, place);
    momentum::<T, R, M, N, V>(on, model, posture, state);
}

fn inverse<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) {
    let State {
        velocity,
        acceleration,
        forces,
        ..
    } = state;
    let at = (model, posture, velocity, acceleration);
    let (mut ws, mut out) = (DerivativesWorkspace::new(), RneaDerivatives::ZERO);
    on.call(
        "rnea_derivatives",
        (at, &mut ws, &mut out),
        |((m, p, v, a), ws, out)| {
            rnea_derivatives(m, p, v, a, ws, out);
            &*out
        },
    );
    let pushed = (at, forces, &mut ws, &mut out);
    on.call(
        "rnea_derivatives_with_forces",
        pushed,
        |((m, p, v, a), f, ws, out)| {
            rnea_derivatives_with_forces(m, p, v, a, f, ws, out);
            &*out
        },
    );
    let small = (&out, velocity, acceleration, acceleration);
    on.call("RneaDerivatives::change", small, |(d, dq, dv, da)| {
        d.change(dq, dv, da)
    });
}

fn forward<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) {
    let State {
        velocity,
        acceleration,
        effort,
        forces,
        ..
    } = state;
    let at = (model, posture, velocity, effort);
    let (mut ws, mut out) = (AbaDerivativesWorkspace::new(), AbaDerivatives::ZERO);
    on.call(
        "aba_derivatives",
        (at, &mut ws, &mut out),
        |((m, p, v, tau), ws, out)| {
            aba_derivatives(m, p, v, tau, ws, out);
            &*out
        },
    );
    let pushed = (at, forces, &mut ws, &mut out);
    on.call(
        "aba_derivatives_with_forces",
        pushed,
        |((m, p, v, tau), f, ws, out)| {
            aba_derivatives_with_forces(m, p, v, tau, f, ws, out);
            &*out
        },
    );
    on.call("AbaDerivativesWorkspace::inverse_dynamics", &ws, |ws| {
        ws.inverse_dynamics()
    });
    let small = (&out, velocity, acceleration, effort);
    on.call("AbaDerivatives::change", small, |(d, dq, dv, dtau)| {
        d.change(dq, dv, dtau)
    });
}

fn moving_frame<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    place: &Place<'_, T, N>,
) {
    let Place {
        frame,
        poses,
        motions,
        ..
    } = place;
    let mut out = FrameDerivatives::ZERO;
    for (kind, axes) in [
        (AccelerationKind::Spatial, Axes::Local),
        (AccelerationKind::Classical, Axes::World),
        (AccelerationKind::Classical, Axes::LocalWorldAligned),
    ] {
        let input = (model, poses, motions, frame, &mut out);
        on.call(
            "frame_derivatives",
            input,
            |(m, poses, motions, frame, out)| {
                frame_derivatives(m, poses, motions, frame, kind, axes, out);
                &*out
            },
        );
    }
}

fn momentum<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) {
    let State {
        velocity,
        acceleration,
        ..
    } = state;
    let at = (model, posture, velocity, acceleration);
    let (mut ws, mut out) = (DerivativesWorkspace::new(), CentroidalDerivatives::ZERO);
    on.call(
        "centroidal_derivatives",
        (at, &mut ws, &mut out),
        |((m, p, v, a), ws, out)| {
            centroidal_derivatives(m, p, v, a, ws, out);
            &*out
        },
    );
    on.call("ForceColumns::mul", (&out.map, velocity), |(columns, v)| {
        columns.mul(v)
    });
    on.call("ForceColumns::to_dense", &out.map, |columns| {
        columns.to_dense::<V>()
    });
}
