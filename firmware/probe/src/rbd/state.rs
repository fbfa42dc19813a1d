//! Random states of a robot.

use rbd_core::{
    Configuration, Effort, Force, JointLimits, Motion, Tangent, Transform, difference, integrate,
    interpolate,
};
use so3::{Matrix3, Rotation3, math};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// A robot somewhere, moving, driven and pushed.
pub(crate) struct State<T: Real, const N: usize> {
    pub(crate) configuration: Configuration<T, N>,
    pub(crate) velocity: Tangent<T, N>,
    pub(crate) acceleration: Tangent<T, N>,
    pub(crate) effort: Effort<T, N>,
    pub(crate) base_force: Force<T>,
    pub(crate) forces: [Force<T>; N],
    pub(crate) limits: [JointLimits<T>; N],
}

impl<T: Real, const N: usize> State<T, N> {
    pub(crate) fn random(stream: &mut Stream) -> Self {
        Self {
            configuration: Configuration {
                base: transform(stream),
                joints: stream.array(1.5),
            },
            velocity: tangent(stream, 3.0),
            acceleration: tangent(stream, 20.0),
            effort: Effort {
                base: Force::from_array(stream.array(50.0)),
                joints: stream.array(30.0),
            },
            base_force: Force::from_array(stream.array(20.0)),
            forces: core::array::from_fn(|_| Force::from_array(stream.array(20.0))),
            limits: core::array::from_fn(|_| JointLimits {
                damping: stream.next(0.1),
                friction: stream.next(0.4),
                ..JointLimits::NONE
            }),
        }
    }
}

/// The manifold of configurations.
pub(super) fn run<T: Real, R: Recorder, const N: usize>(
    on: &mut Subject<'_, T, R>,
    state: &State<T, N>,
) {
    let (from, velocity) = (&state.configuration, &state.velocity);
    let to = on.call("integrate", (from, velocity), |(q, v)| integrate(q, v));
    on.call("difference", (from, &to), |(from, to)| difference(from, to));
    on.call("interpolate", (from, &to, T::of(0.3)), |(from, to, f)| {
        interpolate(from, to, f)
    });
    on.call("Tangent::dot", (velocity, &state.effort), |(v, f)| v.dot(f));
}

fn tangent<T: Real, const N: usize>(stream: &mut Stream, half_width: f64) -> Tangent<T, N> {
    Tangent {
        base: Motion::from_array(stream.array(half_width)),
        joints: stream.array(half_width),
    }
}

/// A pose: three turns about the axes, and a translation.
pub(crate) fn transform<T: Real>(stream: &mut Stream) -> Transform<T> {
    let [x, y, z] = stream.array::<T, 3>(3.0).map(math::sin_cos);
    let (one, zero) = (T::ONE, T::ZERO);
    let about_x = Matrix3::new(one, zero, zero, zero, x.1, -x.0, zero, x.0, x.1);
    let about_y = Matrix3::new(y.1, zero, y.0, zero, one, zero, -y.0, zero, y.1);
    let about_z = Matrix3::new(z.1, -z.0, zero, z.0, z.1, zero, zero, zero, one);
    let rotation = Rotation3::from_matrix_unchecked(about_z * about_y * about_x);
    Transform::new(rotation, stream.array::<T, 3>(2.0).into())
}
