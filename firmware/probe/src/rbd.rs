//! `rbd-core`: the dynamics of one robot.

use rbd_core::{
    AbaWorkspace, Configuration, Effort, Force, Kinematics, MassMatrix, Motion, Posture,
    TableModel, Tangent, Transform, Tree, aba, crba, forward_kinematics, generalized_gravity,
    nonlinear_effects, rnea, rnea_with_forces,
};
use so3::{Rotation3, math};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// Random states per robot.
const STATES: usize = 4;

/// A robot somewhere, moving and pushed.
struct State<T: Real, const N: usize> {
    configuration: Configuration<T, N>,
    velocity: Tangent<T, N>,
    acceleration: Tangent<T, N>,
    effort: Effort<T, N>,
    forces: [Force<T>; N],
}

impl<T: Real, const N: usize> State<T, N> {
    fn random(stream: &mut Stream) -> Self {
        Self {
            configuration: Configuration {
                base: Transform::new(rotation(stream), stream.array::<T, 3>(2.0).into()),
                joints: stream.array(1.5),
            },
            velocity: tangent(stream, 3.0),
            acceleration: tangent(stream, 20.0),
            effort: Effort {
                base: Force::from_array(stream.array(50.0)),
                joints: stream.array(30.0),
            },
            forces: core::array::from_fn(|_| Force::from_array(stream.array(20.0))),
        }
    }
}

fn tangent<T: Real, const N: usize>(stream: &mut Stream, half_width: f64) -> Tangent<T, N> {
    Tangent {
        base: Motion::from_array(stream.array(half_width)),
        joints: stream.array(half_width),
    }
}

/// Three turns about the axes.
fn rotation<T: Real>(stream: &mut Stream) -> Rotation3<T> {
    let [x, y, z] = stream.array::<T, 3>(3.0).map(math::sin_cos);
    let matrix = |[[a, b, c], [d, e, f], [g, h, i]]: [[T; 3]; 3]| {
        so3::Matrix3::new(a, b, c, d, e, f, g, h, i)
    };
    let (one, zero) = (T::ONE, T::ZERO);
    let about_x = matrix([[one, zero, zero], [zero, x.1, -x.0], [zero, x.0, x.1]]);
    let about_y = matrix([[y.1, zero, y.0], [zero, one, zero], [-y.0, zero, y.1]]);
    let about_z = matrix([[z.1, -z.0, zero], [z.0, z.1, zero], [zero, zero, one]]);
    Rotation3::from_matrix_unchecked(about_z * about_y * about_x)
}

/// Every algorithm on a const model, and the same on its tables as a model built at run time.
pub(crate) fn run<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, R>,
    names: [&'static str; 2],
    model: &M,
) {
    let [const_name, table_name] = names;
    on.name = const_name;
    algorithms(on, model);
    on.name = table_name;
    let tables = (model.base_kind(), *model.base(), model.bodies().as_slice());
    let built = on.call::<T, _, _>("TableModel::new", tables, |(kind, base, rows)| {
        TableModel::<T, N>::new(kind, base, rows)
    });
    if let Ok(table) = built {
        algorithms(on, &table);
    }
}

fn algorithms<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, R>,
    model: &M,
) {
    let mut stream = Stream::new(2);
    for _ in 0..STATES {
        dynamics(on, model, &State::random(&mut stream));
    }
    let mut lost = State::random(&mut stream);
    lost.configuration
        .joints
        .iter_mut()
        .for_each(|q| *q = T::NAN);
    dynamics(on, model, &lost);
}

fn dynamics<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, R>,
    model: &M,
    state: &State<T, N>,
) {
    let State {
        configuration,
        velocity,
        acceleration,
        effort,
        forces,
    } = state;
    let posture = on.call::<T, _, _>("Posture::new", (model, configuration), |(m, q)| {
        Posture::new(m, q)
    });
    let at = (model, &posture);
    let mut kinematics = Kinematics::IDENTITY;
    on.call::<T, _, _>(
        "forward_kinematics",
        (at, &mut kinematics),
        |((m, p), out)| {
            forward_kinematics(m, p, out);
            &*out
        },
    );
    let mut mass = MassMatrix::ZERO;
    on.call::<T, _, _>("crba", (at, &mut mass), |((m, p), out)| {
        crba(m, p, out);
        &*out
    });
    on.call::<T, _, _>("MassMatrix::mul", (&mass, acceleration), |(mass, a)| {
        mass.mul(a)
    });
    on.call::<T, _, _>(
        "MassMatrix::kinetic_energy",
        (&mass, velocity),
        |(mass, v)| mass.kinetic_energy(v),
    );
    on.call::<T, _, _>("generalized_gravity", at, |(m, p)| {
        generalized_gravity(m, p)
    });
    on.call::<T, _, _>("nonlinear_effects", (at, velocity), |((m, p), v)| {
        nonlinear_effects(m, p, v)
    });
    on.call::<T, _, _>("rnea", (at, velocity, acceleration), |((m, p), v, a)| {
        rnea(m, p, v, a)
    });
    let pushed = (at, velocity, acceleration, &effort.base, forces);
    on.call::<T, _, _>("rnea_with_forces", pushed, |((m, p), v, a, base, f)| {
        rnea_with_forces(m, p, v, a, base, f)
    });
    let mut ws = AbaWorkspace::new();
    on.call::<T, _, _>(
        "aba",
        (at, velocity, effort, &mut ws),
        |((m, p), v, tau, ws)| aba(m, p, v, tau, ws),
    );
}
