//! The mass matrix factored, solved and inverted.

use rbd_core::{BlockMatrix, MassFactors, MassMatrix, Tree, mass_matrix_inverse};

use super::state::State;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    mass: &MassMatrix<T, N>,
    state: &State<T, N>,
) -> MassFactors<T, N> {
    let (mut factors, mut out) = (MassFactors::new(), BlockMatrix::ZERO);
    on.call(
        "MassFactors::factor",
        (model, mass, &mut factors),
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
    let input = (model, mass, &mut factors, &mut out);
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
    factors
}
