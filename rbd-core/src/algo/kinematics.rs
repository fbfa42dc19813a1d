//! Forward kinematics: where every body is.
//!
//! R_wi = R_wp R_pi(q), p_wi = p_wp + R_wp p_pi(q), from the base outwards.

use nalgebra::{Matrix3, Rotation3, Vector3};
use so3::Scalar;

use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::model::{Frame, Link};
use crate::spatial::Transform;
use crate::state::Posture;
use crate::tree::{At, Fold, Nothing, Tree};

/// Pose of every body in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics<T: Scalar, const N: usize> {
    /// Of the base.
    pub base: Transform<T>,
    /// Of the canonical frame of each body.
    pub bodies: [Transform<T>; N],
}

impl<T: Scalar, const N: usize> Kinematics<T, N> {
    /// Everything at the world's origin.
    pub const IDENTITY: Self = Self {
        base: Transform::IDENTITY,
        bodies: [Transform::IDENTITY; N],
    };

    /// Pose of a link in the world.
    #[inline]
    #[must_use]
    pub fn link(&self, link: Link) -> Transform<T> {
        match link {
            Link::Base => self.base,
            Link::Joint(i) => at(&self.bodies, i),
        }
    }

    /// Pose of a frame in the world.
    #[inline]
    #[must_use]
    pub fn frame(&self, frame: &Frame<T>) -> Transform<T> {
        self.link(frame.link).compose(&frame.placement())
    }
}

struct Fk<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    out: &'a mut [Transform<T>; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Fk<'_, T, N> {
    type Down = (Matrix3<T>, Vector3<T>);
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Self::Down) -> (Self::Down, Nothing) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let (rot, pos) = (rotation.after(&up.0), up.1 + up.0 * offset);
        let pose = Transform::new(Rotation3::from_matrix_unchecked(rot), pos);
        put(self.out, here.index, pose);
        ((rot, pos), Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing, _: Nothing) -> Nothing {
        Nothing
    }
}

/// Pose of every body in the world.
#[inline]
pub fn forward_kinematics<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    out: &mut Kinematics<T, N>,
) {
    out.base = posture.base;
    let base = (*posture.base.rotation.matrix(), posture.base.translation);
    chain(model, posture, &base, &mut out.bodies);
}

/// Pose of every body where the base has this pose, whatever the posture's own.
#[inline(always)]
pub(crate) fn chain<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    base: &(Matrix3<T>, Vector3<T>),
    out: &mut [Transform<T>; N],
) {
    model.fold(&mut Fk { posture, out }, base);
}
