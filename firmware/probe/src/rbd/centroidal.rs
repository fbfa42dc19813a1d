//! Centre of mass, momentum, energies.

use rbd_core::{
    CentroidalMap, ComJacobian, Posture, Tree, center_of_mass, centroidal_bias, centroidal_map,
    centroidal_momentum_rate, centroidal_state, com_jacobian, com_motion,
};

use super::state::State;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
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
    let at = (model, posture);
    on.call("center_of_mass", at, |(m, p)| center_of_mass(m, p));
    let mut jacobian = ComJacobian::ZERO;
    on.call("com_jacobian", (at, &mut jacobian), |((m, p), out)| {
        (com_jacobian(m, p, out), &*out)
    });
    on.call(
        "com_motion",
        (at, velocity, acceleration),
        |((m, p), v, a)| com_motion(m, p, v, a),
    );
    on.call("ComJacobian::mul", (&jacobian, velocity), |(j, v)| j.mul(v));
    let mut map = CentroidalMap::ZERO;
    on.call("centroidal_map", (at, &mut map), |((m, p), out)| {
        centroidal_map(m, p, out);
        &*out
    });
    let momentum = on.call("CentroidalMap::momentum", (&map, velocity), |(map, v)| {
        map.momentum(v)
    });
    on.call(
        "CentroidalMap::locked_angular_velocity",
        (&map, &momentum),
        |(map, h)| map.locked_angular_velocity(h),
    );
    on.call("CentroidalMap::to_dense", &map, |map| map.to_dense::<V>());
    on.call("centroidal_state", (at, velocity), |((m, p), v)| {
        centroidal_state(m, p, v)
    });
    on.call("centroidal_bias", (at, velocity), |((m, p), v)| {
        centroidal_bias(m, p, v)
    });
    on.call(
        "centroidal_momentum_rate",
        (at, velocity, acceleration),
        |((m, p), v, a)| centroidal_momentum_rate(m, p, v, a),
    );
}
