//! Differences of a stage's values over its coordinates: those of the state, then the controls.

use super::{N, NI, NU, Node};
use nalgebra::Vector3;
use ocp_solver::Derivatives;
use wb_opt::{BaseCoordinates, State};

/// The step of the state, and the control, that these steps lead to.
pub(crate) fn moved<const NX: usize>(
    control: &[f64; NU],
    steps: &[(usize, f64)],
) -> ([f64; NX], [f64; NU]) {
    let (mut step, mut control) = ([0.0; NX], *control);
    for &(j, h) in steps {
        match j.checked_sub(NX) {
            None => step[j] += h,
            Some(u) => control[u] += h,
        }
    }
    (step, control)
}

/// ∂²f/∂aᵢ∂aⱼ by central differences with steps of this length.
pub(crate) fn mixed(
    f: impl Fn(&[(usize, f64)]) -> f64,
    (i, h): (usize, f64),
    (j, k): (usize, f64),
) -> f64 {
    let corner = |a: f64, b: f64| f(&[(i, a * h), (j, b * k)]);
    let sum = corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0);
    sum / (4.0 * h * k)
}

/// ∂²L/∂aᵢ∂aⱼ as the Hessian says it.
pub(crate) fn entry<const NX: usize>(d: &Derivatives<f64, NX, NU, NI>, i: usize, j: usize) -> f64 {
    match (i.checked_sub(NX), j.checked_sub(NX)) {
        (None, None) => d.hessian_xx[i][j],
        (None, Some(u)) => d.hessian_xu[u][i],
        (Some(u), None) => d.hessian_xu[u][j],
        (Some(u), Some(w)) => d.hessian_uu[u][w],
    }
}

/// `next`, turned as the interval of length `dt` turns the base: there the derivative of the gap is exact.
pub(crate) fn reached(
    base: BaseCoordinates,
    dt: f64,
    (state, control): &Node,
    mut next: State<f64, N>,
) -> State<f64, N> {
    if base == BaseCoordinates::Rotation {
        // The unit of accelerations is 100 rad/s².
        let omega = Vector3::from_fn(|i, _| state.v[3 + i] + 50.0 * dt * control[3 + i]);
        next.rot_wc = state.rot_wc * so3::exp(&(omega * dt));
    }
    next
}
