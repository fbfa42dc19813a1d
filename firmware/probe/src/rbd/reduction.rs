//! Joints that follow others: every joint of the robot by two coordinates.

use rbd_core::reduction::{CoupledWorkspace, Coupling, Reduction, coupled_dynamics};
use rbd_core::{Configuration, MassMatrix, Posture, Tangent, Tree};

use super::state::State;
use crate::{Real, Recorder, Subject};

/// Coordinates.
const TWO: usize = 2;

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    mass: &MassMatrix<T, N>,
    state: &State<T, N>,
) {
    let mut reduction = Reduction {
        rows: state.configuration.joints.map(|offset| Coupling {
            coordinate: 1,
            ratio: T::HALF,
            offset,
        }),
    };
    if let Some(first) = reduction.rows.first_mut() {
        *first = Coupling::independent(0);
    }
    on.call("Reduction::validate", &reduction, |r| r.validate(N).is_ok());
    let [one, two] = [T::of(0.3), T::of(-0.2)];
    let q = Configuration {
        base: state.configuration.base,
        joints: [one, two],
    };
    let full = on.call("Reduction::configuration", (&reduction, &q), |(r, q)| {
        r.configuration(q)
    });
    let v = Tangent {
        base: state.velocity.base,
        joints: [two, one],
    };
    let joints = on.call("Reduction::tangent", (&reduction, &v), |(r, v)| {
        r.tangent(v).joints
    });
    on.call("Reduction::gather", (&reduction, &joints), |(r, x)| {
        r.gather(x, T::ZERO)
    });
    let effort = on.call(
        "Reduction::effort",
        (&reduction, &state.effort),
        |(r, f)| r.effort(f),
    );
    let mut reduced = MassMatrix::ZERO;
    let input = (&reduction, mass, &mut reduced);
    on.call("Reduction::mass", input, |(r, mass, out)| {
        r.mass(mass, out);
        &*out
    });
    let posture = Posture::new(model, &full);
    let mut workspace = CoupledWorkspace::new();
    let input = (model, &reduction, &posture, &v, &effort, &mut workspace);
    on.call("coupled_dynamics", input, |(m, r, q, v, f, ws)| {
        coupled_dynamics::<T, M, N, TWO>(m, r, q, v, f, ws)
    });
}
