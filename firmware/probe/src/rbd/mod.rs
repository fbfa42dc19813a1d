//! `rbd-core`: every algorithm on one robot, as a const model and as the same tables at run time.

mod centroidal;
mod contact;
mod derivatives;
mod dynamics;
mod factors;
mod kinematics;
mod reduction;
pub(crate) mod second_order;
mod state;

use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Link};
use rbd_core::{BaseKind, Frame, Posture, TableModel, Tree};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};
use state::State;
pub(crate) use state::transform;

/// Random states per robot.
const STATES: usize = 3;

/// One robot's calls on its const model; `V` is 6 + `N`, and `frame` a place on it.
pub(crate) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    name: &'static str,
    model: &M,
    frame: &Frame<T>,
) {
    on.name = name;
    algorithms::<T, R, M, N, V>(on, model, frame);
}

/// The same on its tables as a model built at run time.
pub(crate) fn run_table<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    name: &'static str,
    model: &M,
    frame: &Frame<T>,
) {
    on.name = name;
    refused::<T, R, N>(on, model.base());
    let tables = (model.base_kind(), *model.base(), model.bodies().as_slice());
    let built = on.call("TableModel::new", tables, |(kind, base, rows)| {
        TableModel::<T, N>::new(kind, base, rows)
    });
    let _ = on.call(
        "TableModel::with_any_inertia",
        tables,
        |(kind, base, rows)| TableModel::<T, N>::with_any_inertia(kind, base, rows),
    );
    if let Ok(table) = built {
        algorithms::<T, R, _, N, V>(on, &table, frame);
    }
}

/// Tables that are no robot.
fn refused<T: Real, R: Recorder, const N: usize>(on: &mut Subject<'_, T, R>, base: &BaseBody<T>) {
    let good = Body::<T>::EMPTY;
    let wrong = [
        Body {
            parent: Link::Joint(7),
            ..good
        },
        Body {
            mass: T::NAN,
            ..good
        },
        Body {
            mass: -T::ONE,
            ..good
        },
        Body {
            sign: T::HALF,
            ..good
        },
        Body {
            kind: Kind::RevoluteTilted,
            tilt: [[T::ONE; 3]; 3],
            ..good
        },
    ];
    for row in wrong {
        let tables = (BaseKind::Fixed, *base, [row]);
        let _ = on.call("TableModel::new", tables, |(kind, base, rows)| {
            TableModel::<T, N>::new(kind, base, &rows)
        });
    }
}

fn algorithms<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    frame: &Frame<T>,
) {
    let mut stream = Stream::new(2);
    for case in 0..=STATES {
        let mut state = State::random(&mut stream);
        if case == STATES {
            // A lost sensor: results are NaN, and nothing hangs.
            state
                .configuration
                .joints
                .iter_mut()
                .for_each(|q| *q = T::NAN);
        }
        let input = (model, &state.configuration);
        let posture = on.call("Posture::new", input, |(model, q)| Posture::new(model, q));
        let free = dynamics::run(on, model, &posture, &state);
        let mass = dynamics::mass_matrix::<T, R, M, N, V>(on, model, &posture, &state);
        let factors = factors::run::<T, R, M, N, V>(on, model, &mass, &state);
        let place = kinematics::run::<T, R, M, N, V>(on, model, &posture, &state, frame);
        derivatives::run::<T, R, M, N, V>(on, model, &posture, &state, &place);
        centroidal::run::<T, R, M, N, V>(on, model, &posture, &state);
        contact::run(on, &factors, &free, &state, &place);
        reduction::run(on, model, &mass, &state);
        state::run(on, &state);
    }
}
