//! Derivatives of inverse and forward dynamics, and the mass matrix solved and inverted.

use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, BlockMatrix, DerivativesWorkspace, MassFactors,
    MassMatrix, Posture, RneaDerivatives, Tree, aba_derivatives, aba_derivatives_with_forces, crba,
    mass_matrix_inverse, rnea_derivatives, rnea_derivatives_with_forces,
};

use super::state::State;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) {
    inverse::<T, R, M, N>(on, model, posture, state);
    forward::<T, R, M, N>(on, model, posture, state);
    factors::<T, R, M, N, V>(on, model, posture, state);
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

fn factors<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) {
    let mut mass = MassMatrix::ZERO;
    crba(model, posture, &mut mass);
    let (mut factors, mut out) = (MassFactors::new(), BlockMatrix::ZERO);
    on.call(
        "MassFactors::factor",
        (model, &mass, &mut factors),
        |(m, mass, factors)| {
            factors.factor(m, mass);
        },
    );
    on.call(
        "MassFactors::solve",
        (&factors, &state.effort),
        |(factors, b)| factors.solve(b),
    );
    on.call(
        "MassFactors::inverse",
        (&factors, &mut out),
        |(factors, out)| {
            factors.inverse(out);
            &*out
        },
    );
    on.call(
        "MassFactors::solve_columns",
        (&factors, &mut out),
        |(factors, b)| {
            factors.solve_columns(b);
            &*b
        },
    );
    let input = (model, &mass, &mut factors, &mut out);
    on.call("mass_matrix_inverse", input, |(m, mass, factors, out)| {
        mass_matrix_inverse(m, mass, factors, out);
        &*out
    });
    let v = &state.velocity;
    on.call(
        "BlockMatrix::mul",
        (&out, v.base.to_array(), &v.joints),
        |(m, base, joints)| m.mul(base, joints),
    );
    on.call("BlockMatrix::to_dense", &out, |m| m.to_dense::<V>());
}
