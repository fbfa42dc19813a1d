//! Inverse and forward dynamics, mass matrix, friction, factorisations.

use rbd_core::linear::{ldl_back_substitute, ldl_factor, ldl_solve, spd_inverse_6};
use rbd_core::{
    AbaWorkspace, MassMatrix, Posture, Tangent, Tree, aba, aba_with_forces, crba,
    generalized_gravity, joint_friction, mass_solve, nonlinear_effects, rnea, rnea_with_forces,
};

use super::state::State;
use crate::{Real, Recorder, Subject};

/// Returns the acceleration of the free robot.
pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) -> Tangent<T, N> {
    let State {
        velocity,
        acceleration,
        effort,
        base_force,
        forces,
        ..
    } = state;
    let at = (model, posture);
    on.call("generalized_gravity", at, |(m, p)| {
        generalized_gravity(m, p)
    });
    on.call("nonlinear_effects", (at, velocity), |((m, p), v)| {
        nonlinear_effects(m, p, v)
    });
    on.call("rnea", (at, velocity, acceleration), |((m, p), v, a)| {
        rnea(m, p, v, a)
    });
    let pushed = (at, velocity, acceleration, base_force, forces);
    on.call("rnea_with_forces", pushed, |((m, p), v, a, base, f)| {
        rnea_with_forces(m, p, v, a, base, f)
    });
    let mut ws = AbaWorkspace::new();
    let free = on.call(
        "aba",
        (at, velocity, effort, &mut ws),
        |((m, p), v, tau, ws)| aba(m, p, v, tau, ws),
    );
    let pushed = (at, velocity, effort, forces, &mut ws);
    on.call("aba_with_forces", pushed, |((m, p), v, tau, f, ws)| {
        aba_with_forces(m, p, v, tau, f, ws)
    });
    on.call("mass_solve", (at, effort, &mut ws), |((m, p), b, ws)| {
        mass_solve(m, p, b, ws)
    });
    let drag = (&state.limits, &velocity.joints, T::of(0.05));
    on.call("joint_friction", drag, |(limits, qd, smoothing)| {
        joint_friction(limits, qd, smoothing)
    });
    free
}

pub(super) fn mass_matrix<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
) -> MassMatrix<T, N> {
    let mut mass = MassMatrix::ZERO;
    on.call("crba", (model, posture, &mut mass), |(m, p, out)| {
        crba(m, p, out);
        &*out
    });
    on.call(
        "MassMatrix::mul",
        (&mass, &state.acceleration),
        |(mass, a)| mass.mul(a),
    );
    on.call(
        "MassMatrix::kinetic_energy",
        (&mass, &state.velocity),
        |(mass, v)| mass.kinetic_energy(v),
    );
    on.call("MassMatrix::to_dense", &mass, |mass| mass.to_dense::<V>());
    let (mut factor, b) = (mass.joints, state.effort.joints);
    on.call("ldl_factor", &mut factor, |m| {
        ldl_factor(m);
        &*m
    });
    on.call("ldl_back_substitute", (&factor, b), |(m, b)| {
        ldl_back_substitute(m, b)
    });
    let mut copy = mass.joints;
    on.call("ldl_solve", (&mut copy, b), |(m, b)| ldl_solve(m, b));
    let locked: [[T; 6]; 6] = core::array::from_fn(|i| {
        core::array::from_fn(|j| T::of(if i == j { 9.0 } else { 0.3 * (i + j) as f64 }))
    });
    on.call("spd_inverse_6", &locked, |m| spd_inverse_6(m));
    mass
}
