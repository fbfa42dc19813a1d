//! Where a robot is that stands on its feet with given joints.

use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    Configuration, Kinematics, Posture, Transform, Tree, center_of_mass, forward_kinematics,
};
use so3::Scalar;
use wbc_qp::{Contact, Patch};

/// The robot with these joints, rad, and its first foot flat on the floor with its axes along the world's, the middle between the feet's
/// frames at the origin.
#[must_use]
pub fn on_the_floor<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize>(
    model: &M,
    feet: &[Contact<T>; F],
    joints: &[T; N],
) -> Configuration<T, N> {
    let mut q = Configuration {
        joints: *joints,
        ..Configuration::NEUTRAL
    };
    let Some(first) = feet.first() else { return q };
    q.base.rotation = poses(model, &q).frame(&first.frame).rotation.inverse();
    let poses = poses(model, &q);
    let places = feet.iter().map(|foot| poses.frame(&foot.frame).translation);
    let sum = places.fold(Vector3::zeros(), |sum, place| sum + place);
    q.base.translation = -sum * share::<T, F>();
    q
}

/// Middle between the feet's contacts in the world, m: of a rectangle its middle, of a polygon the mean of its vertices, of a ball its centre.
#[must_use]
pub fn middle_of_feet<T: Scalar, const N: usize, const F: usize>(
    poses: &Kinematics<T, N>,
    feet: &[Contact<T>; F],
) -> Vector3<T> {
    let middles = feet.iter().map(|foot| {
        let middle = match foot.shape {
            Patch::Ball { .. } => Vector3::zeros(),
            Patch::Rectangle {
                x: [a, b],
                y: [c, d],
            } => Vector3::new(T::HALF * (a + b), T::HALF * (c + d), T::ZERO),
            Patch::Polygon { vertices } => {
                let [x, y] = vertices
                    .iter()
                    .fold([T::ZERO; 2], |[a, b], [x, y]| [a + *x, b + *y]);
                Vector3::new(x, y, T::ZERO) / T::of(vertices.len() as f64)
            }
        };
        poses.frame(&foot.frame).point(&middle)
    });
    middles.fold(Vector3::zeros(), |sum, middle| sum + middle) * share::<T, F>()
}

/// 1/F.
fn share<T: Scalar, const F: usize>() -> T {
    T::ONE / T::of(F as f64)
}

/// Poses of all bodies.
fn poses<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    q: &Configuration<T, N>,
) -> Kinematics<T, N> {
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(model, &Posture::new(model, q), &mut kinematics);
    kinematics
}

/// Centre of mass in the world, m.
pub(super) fn com<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    q: &Configuration<T, N>,
) -> Vector3<T> {
    center_of_mass(model, &Posture::new(model, q)).position_w
}

/// A posture to stand in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance<T: Scalar, const N: usize> {
    /// Joint positions, rad.
    pub(super) joints: [T; N],
    /// Orientation of the base with the feet level.
    pub(super) upright: Rotation3<T>,
    /// Height of the centre of mass over the feet, m.
    pub(super) height: T,
}

impl<T: Scalar, const N: usize> Stance<T, N> {
    /// With these joints.
    pub(super) fn new<M: Tree<T, N>, const F: usize>(
        model: &M,
        feet: &[Contact<T>; F],
        joints: &[T; N],
    ) -> Self {
        let q = on_the_floor(model, feet, joints);
        Self {
            joints: *joints,
            upright: q.base.rotation,
            height: com(model, &q).z,
        }
    }
}

/// Where the first foot is in a configuration.
pub(super) fn first_foot<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize>(
    model: &M,
    feet: &[Contact<T>; F],
    q: &Configuration<T, N>,
) -> Transform<T> {
    let poses = poses(model, q);
    feet.first()
        .map_or(Transform::IDENTITY, |foot| poses.frame(&foot.frame))
}
