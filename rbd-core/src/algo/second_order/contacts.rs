//! Points in contact, how they move, and the forces on them.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use super::Sweep;
use super::moments::{outer, turn};
use crate::spatial::Motion;

/// A point on a body and its motion, world axes.
#[derive(Clone, Copy, Debug)]
pub struct PointMotion<T: Scalar> {
    /// Index of the body.
    pub link: usize,
    /// Where it is, m.
    pub pos: Vector3<T>,
    /// From the point to where its force acts, m, fixed in the world however the body turns: down by the radius of a ball foot.
    pub arm: Vector3<T>,
    /// Its velocity, m/s.
    pub velocity: Vector3<T>,
    /// Its acceleration less gravity, m/s².
    pub lifted: Vector3<T>,
}

impl<T: Scalar> PointMotion<T> {
    /// A point of body 0, at rest in the world's origin: only storage.
    pub const ZERO: Self = {
        let zero = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        Self {
            link: 0,
            pos: zero,
            arm: zero,
            velocity: zero,
            lifted: zero,
        }
    };
}

/// Points in contact and the forces on them, world axes.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<T: Scalar, const CONTACTS: usize> {
    /// The points ([`Sweep::point`]).
    pub points: [PointMotion<T>; CONTACTS],
    /// Force of the world on each point, N.
    pub forces: [Vector3<T>; CONTACTS],
    /// How many of them count: the first ones.
    pub count: usize,
}

impl<T: Scalar, const CONTACTS: usize> Contacts<T, CONTACTS> {
    /// No contacts.
    pub const NONE: Self = Self {
        points: [PointMotion::ZERO; CONTACTS],
        forces: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); CONTACTS],
        count: 0,
    };

    /// The contacts that count, and their forces.
    #[inline(always)]
    pub fn active(&self) -> impl Iterator<Item = (&PointMotion<T>, &Vector3<T>)> {
        self.points.iter().zip(&self.forces).take(self.count)
    }

    /// Forces on the subtree of every joint.
    #[inline(always)]
    pub(super) fn sums<const N: usize>(&self, sweep: &Sweep<'_, T, N>) -> [Push<T>; N] {
        let mut pushes = [Push::zero(); N];
        for (point, force) in self.active() {
            let moment = outer(&point.pos, force);
            for k in sweep.path(point.link) {
                pushes[k].force += force;
                pushes[k].spread += moment;
            }
        }
        pushes
    }
}

/// Sums over the contact forces F at r on a subtree.
#[derive(Clone, Copy)]
pub(super) struct Push<T: Scalar> {
    /// Σ F.
    force: Vector3<T>,
    /// Σ r Fᵀ.
    spread: Matrix3<T>,
}

impl<T: Scalar> Push<T> {
    fn zero() -> Self {
        Self {
            force: Vector3::zeros(),
            spread: Matrix3::zeros(),
        }
    }

    /// Σ F × x(r): the moment by which the contact forces' wrench falls behind when the points move with
    /// X and the forces keep their direction.
    #[inline(always)]
    pub(super) fn kept_direction(&self, x: &Motion<T>) -> Vector3<T> {
        self.force.cross(&x.linear) + turn(&self.spread, &x.angular)
    }
}
