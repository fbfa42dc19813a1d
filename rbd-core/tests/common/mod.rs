//! Random robots and states, shared by the integration tests.

pub(crate) mod dual;

use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use rbd_core::joint::Kind;
use rbd_core::{
    BaseBody, BaseKind, Body, Configuration, Effort, Inertia, Link, Motion, Symmetric3, TableModel,
    Tangent, Transform, Tree,
};

pub(crate) const CAP: usize = 40;
pub(crate) type Model = TableModel<f64, CAP>;

pub(crate) fn rotation() -> impl Strategy<Value = Rotation3<f64>> {
    prop::array::uniform4(-1.0..1.0f64).prop_filter_map("degenerate quaternion", |[x, y, z, w]| {
        let n = x * x + y * y + z * z + w * w;
        (n > 1e-2).then(|| {
            let q = nalgebra::Quaternion::new(w, x, y, z);
            nalgebra::UnitQuaternion::from_quaternion(q).to_rotation_matrix()
        })
    })
}

pub(crate) fn vector(scale: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-scale..scale).prop_map(Vector3::from)
}

pub(crate) fn inertia() -> impl Strategy<Value = Inertia<f64>> {
    (
        0.1..3.0f64,
        vector(0.2),
        prop::array::uniform3(1e-3..0.1f64),
        rotation(),
    )
        .prop_map(|(mass, com, moments, rot)| {
            let principal = Matrix3::from_diagonal(&Vector3::from(moments));
            let second = rot.matrix() * principal * rot.matrix().transpose();
            Inertia::from_com(mass, com, Symmetric3::of(&second).trace_complement())
        })
}

pub(crate) fn body() -> impl Strategy<Value = (Body<f64>, usize)> {
    let kind = prop::sample::select(Kind::ALL.to_vec());
    (
        kind,
        rotation(),
        vector(0.5),
        inertia(),
        any::<bool>(),
        0.0..0.05f64,
        0..1000usize,
    )
        .prop_map(
            |(kind, rot, offset, inertia, flip, rotor_inertia, branch)| {
                let tilt = if kind.is_tilted() {
                    *rot.matrix()
                } else {
                    Matrix3::identity()
                };
                let row = |i: usize| [tilt[(i, 0)], tilt[(i, 1)], tilt[(i, 2)]];
                let body = Body {
                    kind,
                    sign: if flip { -1.0 } else { 1.0 },
                    offset: offset.into(),
                    tilt: [row(0), row(1), row(2)],
                    mass: inertia.mass,
                    first: inertia.first.into(),
                    second: inertia.second.to_array(),
                    rotor_inertia,
                    ..Body::EMPTY
                };
                (body, branch)
            },
        )
}

pub(crate) fn model() -> impl Strategy<Value = Model> {
    (
        prop::collection::vec(body(), 1..CAP),
        inertia(),
        any::<bool>(),
    )
        .prop_map(|(rows, base, floating)| {
            // Each body hangs from an ancestor-or-self of the one before it: depth-first order.
            let mut path: Vec<usize> = vec![];
            let mut bodies = vec![];
            for (i, (mut body, branch)) in rows.into_iter().enumerate() {
                path.truncate(path.len() - branch % 3 % (path.len() + 1));
                body.parent = path.last().map_or(Link::Base, |&p| Link::Joint(p));
                path.push(i);
                bodies.push(body);
            }
            let base = BaseBody {
                mass: base.mass,
                first: base.first.into(),
                second: base.second.to_array(),
            };
            let kind = if floating {
                BaseKind::Floating
            } else {
                BaseKind::Fixed
            };
            TableModel::new(kind, base, &bodies).unwrap()
        })
}

pub(crate) fn joints(scale: f64) -> impl Strategy<Value = [f64; CAP]> {
    prop::collection::vec(-scale..scale, CAP).prop_map(|x| x.try_into().unwrap())
}

pub(crate) fn motion(scale: f64) -> impl Strategy<Value = Motion<f64>> {
    (vector(scale), vector(scale)).prop_map(|(l, a)| Motion::new(l, a))
}

/// A state: configuration, velocity, acceleration; what the robot does not have is zero.
pub(crate) fn state() -> impl Strategy<Value = (Configuration<f64, CAP>, [Tangent<f64, CAP>; 2])> {
    let tangent = || (motion(2.0), joints(3.0)).prop_map(|(base, joints)| Tangent { base, joints });
    (rotation(), vector(2.0), joints(3.1), tangent(), tangent()).prop_map(|(r, p, q, v, a)| {
        (
            Configuration {
                base: Transform::new(r, p),
                joints: q,
            },
            [v, a],
        )
    })
}

pub(crate) fn masked(model: &Model, mut t: Tangent<f64, CAP>) -> Tangent<f64, CAP> {
    for x in t.joints.iter_mut().skip(model.joint_count()) {
        *x = 0.0;
    }
    if model.base_kind() == BaseKind::Fixed {
        t.base = Motion::ZERO;
    }
    t
}

pub(crate) fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-10 * scale.max(1.0)
}

pub(crate) fn size(e: &Effort<f64, CAP>) -> f64 {
    (0..6 + CAP)
        .map(|i| e.coordinate(i).abs())
        .fold(0.0, f64::max)
}
