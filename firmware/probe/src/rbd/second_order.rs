//! Dynamics to second order of a robot that hangs in the world, with two contacts, one of them rolling.

use nalgebra::{Matrix3, Vector3};
use rbd_core::second_order::{
    Contacts, EffortJacobian, Gradient, Hessian, Multipliers, PositionTerms, Sweep,
};
use rbd_core::{Body, Tree};

use super::STATES;
use super::state::State;
use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// Contacts.
const TWO: usize = 2;

pub(crate) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
) {
    on.name = "kinds";
    let mut stream = Stream::new(3);
    for case in 0..=STATES {
        let mut state = State::<T, N>::random(&mut stream);
        if case == STATES {
            // A lost sensor: results are NaN, and nothing hangs.
            state.configuration.joints = [T::NAN; N];
        }
        at(on, model.bodies(), &state, &mut stream);
    }
}

fn at<T: Real, R: Recorder, const N: usize>(
    on: &mut Subject<'_, T, R>,
    bodies: &[Body<T>; N],
    state: &State<T, N>,
    stream: &mut Stream,
) {
    let moving = [
        &state.configuration.joints,
        &state.velocity.joints,
        &state.acceleration.joints,
    ];
    let rot = &state.configuration.base.rotation;
    // What the sweep holds shows in what it answers.
    let sweep = Sweep::new(bodies, moving, Some((0, rot)));
    let offset = vector(stream, 0.2);
    on.call("Sweep::place", (&sweep, &offset), |(s, offset)| {
        s.place(1, offset)
    });
    let mut contacts = Contacts::<T, TWO>::NONE;
    contacts.count = TWO;
    for (f, link) in [N.saturating_sub(1), N].into_iter().enumerate() {
        let point = on.call("Sweep::point", (&sweep, &offset, link), |(s, o, link)| {
            s.point(link, o)
        });
        if let (Some(slot), Some(force)) = (contacts.points.get_mut(f), contacts.forces.get_mut(f))
        {
            (*slot, *force) = (point, vector(stream, 20.0));
            slot.arm = vector(stream, 0.1);
        }
    }
    let jacobian = first(on, &sweep, &contacts, &state.acceleration.joints);
    second(on, &sweep, &contacts, (&jacobian, stream));
}

fn vector<T: Real>(stream: &mut Stream, half_width: f64) -> Vector3<T> {
    Vector3::from(stream.array::<T, 3>(half_width))
}

/// Values and first derivatives.
fn first<T: Real, R: Recorder, const N: usize>(
    on: &mut Subject<'_, T, R>,
    sweep: &Sweep<'_, T, N>,
    contacts: &Contacts<T, TWO>,
    acceleration: &[T; N],
) -> EffortJacobian<T, N, TWO> {
    on.call(
        "Sweep::effort",
        (sweep, contacts, acceleration),
        |(s, c, a)| {
            let mut effort = [T::ZERO; N];
            s.effort(a, c, &mut effort);
            effort
        },
    );
    let jacobian = on.call("Sweep::differentiate", (sweep, contacts), |(s, c)| {
        let mut out = EffortJacobian::ZERO;
        s.differentiate(c, &mut out);
        out
    });
    for (point, force) in contacts.active() {
        on.call("Sweep::slip_rate", (sweep, point), |(s, p)| s.slip_rate(p));
        on.call("Sweep::acceleration_gradients", (sweep, point), |(s, p)| {
            s.acceleration_gradients::<TWO>(p)
        });
        on.call(
            "Sweep::position_gradient",
            (sweep, point, force),
            |(s, p, f)| s.position_gradient::<TWO>(p.link, &p.pos, f),
        );
    }
    jacobian
}

/// Second derivatives.
fn second<T: Real, R: Recorder, const N: usize>(
    on: &mut Subject<'_, T, R>,
    sweep: &Sweep<'_, T, N>,
    contacts: &Contacts<T, TWO>,
    (jacobian, stream): (&EffortJacobian<T, N, TWO>, &mut Stream),
) {
    let mut positions = PositionTerms::new();
    for (point, force) in contacts.active() {
        positions.add(point.link, &point.pos, force);
    }
    positions.add_spread(0, &Matrix3::identity());
    let effort = stream.array::<T, N>(1.0);
    let acceleration = [vector(stream, 1.0), vector(stream, 1.0)];
    let multipliers = Multipliers {
        effort: &effort,
        acceleration: &acceleration,
    };
    let input = (sweep, contacts, &multipliers, &positions);
    let mut hessian = on.call("Sweep::curvature", input, |(s, c, m, p)| {
        let mut out = Hessian::ZERO;
        s.curvature(c, m, p, &mut out);
        out
    });
    let row = on.call("EffortJacobian::row", jacobian, |j| j.row(1));
    let mut sum = Gradient::ZERO;
    on.call("Gradient::add", (&mut sum, &row), |(sum, row)| {
        sum.add(T::HALF, row);
        *sum
    });
    let tip = N.saturating_sub(1);
    on.call(
        "Hessian::add_outer",
        (sweep, &row, &mut hessian),
        |(s, g, h)| {
            h.add_outer(T::HALF, g, s.path(tip));
            *h
        },
    );
    on.call("Hessian::add_product", (&row, &mut hessian), |(g, h)| {
        h.add_product(tip, T::HALF, g);
        *h
    });
}
