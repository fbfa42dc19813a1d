//! Ends of limbs as their own joints move them: what a controller of feet needs, and nothing else.
//!
//! Seen from the base, in base axes: p(q) and ∂p/∂q, whose column of a revolute joint with axis z through o is
//! z × (p − o), of a prismatic joint z. Joints that do not move the end have no column, so work with a foot costs the length
//! of its leg, not the number of joints of the robot.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use super::at;
use super::jacobian::axis_w;
use super::kinematics::chain;
use crate::model::{Frame, Link};
use crate::spatial::Transform;
use crate::state::{Configuration, Posture};
use crate::tree::Tree;

/// One end: position and linear Jacobian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbEnd<T: Scalar, const N: usize> {
    /// Origin of the frame relative to the base, base axes, m.
    pub position: Vector3<T>,
    columns: [Vector3<T>; N],
    /// Joints that may move the end: `first..last`.
    first: usize,
    last: usize,
}

impl<T: Scalar, const N: usize> LimbEnd<T, N> {
    /// The joints that may move the end, each with the velocity that a unit of its speed gives it.
    #[inline(always)]
    pub fn columns(&self) -> impl Iterator<Item = (usize, &Vector3<T>)> {
        let columns = self.columns.get(self.first..self.last).unwrap_or(&[]);
        columns
            .iter()
            .enumerate()
            .map(|(i, column)| (self.first + i, column))
    }

    /// J q̇: velocity of the end relative to the base; any other sum of columns likewise.
    #[inline]
    #[must_use]
    pub fn mul(&self, qd: &[T; N]) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        for (j, column) in self.columns() {
            sum += column * at(qd, j);
        }
        sum
    }

    /// out ← out + Jᵀ f: the torques that a force on the end needs.
    #[inline]
    pub fn add_tr_mul(&self, force: &Vector3<T>, out: &mut [T; N]) {
        for (j, column) in self.columns() {
            if let Some(tau) = out.get_mut(j) {
                *tau += column.dot(force);
            }
        }
    }
}

/// A posture with `K` ends of limbs in base axes: computed once per tick, read by every controller of it.
#[derive(Clone, Copy, Debug)]
pub struct Limbs<T: Scalar, const N: usize, const K: usize> {
    /// Sines and cosines of the joints, and the pose of the base.
    pub posture: Posture<T, N>,
    /// The ends, relative to the base, base axes.
    pub ends: [LimbEnd<T, N>; K],
    /// Poses of all bodies in base axes.
    bodies: [Transform<T>; N],
}

impl<T: Scalar, const N: usize, const K: usize> Limbs<T, N, K> {
    /// Only storage, for [`Limbs::update`].
    pub const ZERO: Self = Self {
        posture: Posture::ZERO,
        ends: [LimbEnd::ZERO; K],
        bodies: [Transform::IDENTITY; N],
    };

    /// The ends `frames` of `model` in a configuration.
    #[must_use]
    pub fn new<M: Tree<T, N>>(
        model: &M,
        configuration: &Configuration<T, N>,
        frames: &[Frame<T>; K],
    ) -> Self {
        let mut limbs = Self::ZERO;
        limbs.update(model, configuration, frames);
        limbs
    }

    /// Overwrites with [`Limbs::new`], in place: a controller that keeps its limbs from tick to tick copies nothing.
    pub fn update<M: Tree<T, N>>(
        &mut self,
        model: &M,
        configuration: &Configuration<T, N>,
        frames: &[Frame<T>; K],
    ) {
        self.posture.update(model, configuration);
        let base = (Matrix3::identity(), Vector3::zeros());
        chain(model, &self.posture, &base, &mut self.bodies);
        for (end, frame) in self.ends.iter_mut().zip(frames) {
            end.update(model, &self.bodies, frame);
        }
    }
}

impl<T: Scalar, const N: usize> LimbEnd<T, N> {
    const ZERO: Self = Self {
        position: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        columns: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); N],
        first: 0,
        last: 0,
    };

    fn update<M: Tree<T, N>>(&mut self, model: &M, bodies: &[Transform<T>; N], frame: &Frame<T>) {
        let offset = Vector3::from(frame.offset);
        let of = |joint: usize| model.bodies().get(joint).zip(bodies.get(joint));
        let mut link = frame.link;
        (self.first, self.last) = match link {
            Link::Joint(joint) => (joint, joint + 1),
            Link::Base => (0, 0),
        };
        self.position = match link {
            Link::Joint(joint) => of(joint).map_or(offset, |(_, pose)| pose.point(&offset)),
            Link::Base => offset,
        };
        // At most N steps from a leaf to the base.
        for _ in 0..N {
            let Link::Joint(joint) = link else { break };
            let (Some((body, pose)), Some(column)) = (of(joint), self.columns.get_mut(joint))
            else {
                break;
            };
            let axis = axis_w(body, pose);
            *column = if body.kind.is_revolute() {
                axis.cross(&(self.position - pose.translation))
            } else {
                axis
            };
            // Joints between this one and its parent move other limbs.
            let parent = match body.parent {
                Link::Joint(parent) => parent + 1,
                Link::Base => joint,
            };
            if let Some(others) = self.columns.get_mut(parent..joint) {
                others.fill(Vector3::zeros());
            }
            self.first = joint;
            link = body.parent;
        }
    }
}
