//! `rbd-core`'s spatial algebra: one operation at a time.

use rbd_core::hardware::Motor;
use rbd_core::{ArticulatedInertia, Body, Force, Frame, Inertia, Motion, Symmetric3, Tangent};
use so3::Vector3;

use crate::inputs::Stream;
use crate::rbd::transform;
use crate::{Real, Recorder, Subject};

const DRAWS: usize = 4;

pub(crate) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    on.name = "spatial";
    let mut stream = Stream::new(3);
    for _ in 0..DRAWS {
        vectors(on, &mut stream);
        transforms(on, &mut stream);
        symmetric(on, &mut stream);
        inertias(on, &mut stream);
        tables(on, &mut stream);
    }
}

fn motion<T: Real>(stream: &mut Stream) -> Motion<T> {
    Motion::from_array(stream.array(3.0))
}

fn force<T: Real>(stream: &mut Stream) -> Force<T> {
    Force::from_array(stream.array(30.0))
}

fn vector<T: Real>(stream: &mut Stream) -> Vector3<T> {
    stream.array::<T, 3>(1.0).into()
}

/// A positive definite matrix: an outer product on a diagonal.
fn positive<T: Real>(stream: &mut Stream) -> Symmetric3<T> {
    Symmetric3::outer(&vector(stream), T::ONE) + Symmetric3::diagonal(T::HALF)
}

fn vectors<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let (a, b, f): (Motion<T>, Motion<T>, Force<T>) =
        (motion(stream), motion(stream), force(stream));
    on.call("Motion::cross", (&a, &b), |(a, b)| a.cross(b));
    on.call("Motion::cross_force", (&a, &f), |(a, f)| a.cross_force(f));
    on.call("Motion::dot", (&a, &f), |(a, f)| a.dot(f));
    on.call("Motion::to_classical", (&a, &b), |(a, b)| a.to_classical(b));
    on.call("Motion::to_spatial", (&a, &b), |(a, b)| a.to_spatial(b));
    on.call("Motion::at_point", (&a, &f.linear), |(a, p)| a.at_point(p));
    on.call("Motion::to_array", &a, |a| a.to_array());
    on.call("Force::to_array", &f, |f| f.to_array());
    let t = Tangent::<T, 3> {
        base: a,
        joints: stream.array(1.0),
    };
    for i in [0, 5, 8, 9] {
        on.call("Tangent::coordinate", (&t, i), |(t, i)| t.coordinate(i));
        on.call("Tangent::unit", i, Tangent::<T, 3>::unit);
    }
}

fn transforms<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let (x, y) = (transform::<T>(stream), transform::<T>(stream));
    let (m, f) = (motion::<T>(stream), force::<T>(stream));
    let p = m.linear;
    on.call("Transform::compose", (&x, &y), |(x, y)| x.compose(y));
    on.call("Transform::inverse", &x, |x| x.inverse());
    on.call("Transform::point", (&x, &p), |(x, p)| x.point(p));
    on.call("Transform::motion", (&x, &m), |(x, m)| x.motion(m));
    on.call("Transform::inverse_motion", (&x, &m), |(x, m)| {
        x.inverse_motion(m)
    });
    on.call("Transform::force", (&x, &f), |(x, f)| x.force(f));
    on.call("Transform::inverse_force", (&x, &f), |(x, f)| {
        x.inverse_force(f)
    });
}

fn symmetric<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let (s, v, w) = (
        positive::<T>(stream),
        vector::<T>(stream),
        vector::<T>(stream),
    );
    let x = transform::<T>(stream);
    on.call("Symmetric3::outer", (&v, T::TWO), |(v, x)| {
        Symmetric3::outer(v, x)
    });
    on.call("Symmetric3::outer_pair", (&v, &w), |(v, w)| {
        Symmetric3::outer_pair(v, w)
    });
    on.call("Symmetric3::diagonal", T::TWO, Symmetric3::diagonal);
    on.call("Symmetric3::of", x.rotation.matrix(), Symmetric3::of);
    on.call("Symmetric3::trace", &s, |s| s.trace());
    on.call("Symmetric3::trace_complement", &s, |s| s.trace_complement());
    on.call("Symmetric3::mul", (&s, &v), |(s, v)| s.mul(v));
    on.call("Symmetric3::to_matrix", &s, |s| s.to_matrix());
    on.call("Symmetric3::to_array", &s, |s| s.to_array());
    on.call(
        "Symmetric3::rotated",
        (&s, x.rotation.matrix()),
        |(s, r)| s.rotated(r),
    );
}

fn inertias<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let body = (T::of(1.5), vector::<T>(stream), positive::<T>(stream));
    let inertia = on.call("Inertia::from_com", body, |(m, c, i)| {
        Inertia::from_com(m, c, i)
    });
    let (v, f, x) = (
        motion::<T>(stream),
        force::<T>(stream),
        transform::<T>(stream),
    );
    on.call("Inertia::com", &inertia, |i| i.com());
    on.call("Inertia::rotational", &inertia, |i| i.rotational());
    on.call("Inertia::rotational_com", &inertia, |i| i.rotational_com());
    on.call("Inertia::mul", (&inertia, &v), |(i, v)| i.mul(v));
    on.call("Inertia::kinetic_energy", (&inertia, &v), |(i, v)| {
        i.kinetic_energy(v)
    });
    on.call("Inertia::transformed", (&inertia, &x), |(i, x)| {
        i.transformed(x)
    });
    let whole = on.call(
        "ArticulatedInertia::from",
        inertia,
        ArticulatedInertia::from,
    );
    on.call("ArticulatedInertia::mul", (&whole, &v), |(i, v)| i.mul(v));
    let small = (&whole, &f, T::of(1e-4));
    on.call("ArticulatedInertia::without", small, |(i, f, x)| {
        i.without(f, x)
    });
    on.call(
        "ArticulatedInertia::shifted",
        (&whole, &v.linear),
        |(i, p)| i.shifted(p),
    );
    on.call("ArticulatedInertia::solve", (&whole, &f), |(i, f)| {
        i.solve(f)
    });
}

/// What the rows of a robot's tables say about themselves.
fn tables<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let frame: Frame<T> = Frame {
        offset: stream.array(1.0),
        ..Frame::IDENTITY
    };
    on.call("Frame::placement", &frame, |frame| frame.placement());
    on.call("Body::tilt_matrix", &Body::EMPTY, |body: &Body<T>| {
        body.tilt_matrix()
    });
    let motor = Motor {
        gear: T::of(9.0),
        torque: T::of(30.0),
        corner_speed: T::of(10.0),
        no_load_speed: T::of(20.0),
        rotor_inertia: T::of(0.01),
    };
    for speed in [stream.next(30.0), T::ZERO, T::NAN] {
        on.call("Motor::torque_range", (&motor, speed), |(motor, speed)| {
            motor.torque_range(speed)
        });
    }
}
