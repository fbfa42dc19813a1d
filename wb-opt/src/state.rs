//! State of a node and units of the unknowns.

use crate::robot::BASE;
use nalgebra::{Matrix3, Rotation3};
use so3::Scalar;

/// A configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T: Scalar, const N: usize> {
    /// Coordinates: base (m and rad), then joints (rad). On SO(3) the three that turn the base are zero.
    pub q: [T; N],
    /// Where the angles of the base turn from: on SO(3) they are zero, so it is the rotation from base to world;
    /// with Euler angles the identity.
    pub rot_wc: Rotation3<T>,
}

impl<T: Scalar, const N: usize> Pose<T, N> {
    /// With Euler angles among the coordinates, or level on SO(3).
    #[must_use]
    pub fn level(q: [T; N]) -> Self {
        Self {
            q,
            rot_wc: Rotation3::identity(),
        }
    }

    /// Squared distance: of the coordinates, and 2 (1 − cos) of the angle between the bases on SO(3), the square of
    /// the angle up to fourth order.
    #[inline(always)]
    pub(crate) fn distance_squared(&self, q: &[T; N], rot_wc: &Rotation3<T>) -> T {
        let square = |sum: T, (x, y): (&T, &T)| sum + (*x - *y) * (*x - *y);
        let turned = self.rot_wc.matrix().dot(rot_wc.matrix());
        q.iter().zip(&self.q).fold(T::ZERO, square) + (T::of(3.0) - turned)
    }

    /// How a rotation is seen from this one's.
    #[inline(always)]
    pub(crate) fn seen(&self, rot_wc: &Rotation3<T>) -> Matrix3<T> {
        self.rot_wc.matrix().tr_mul(rot_wc.matrix())
    }
}

/// Configuration and velocity at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T: Scalar, const N: usize> {
    /// Coordinates, see [`Pose::q`].
    pub q: [T; N],
    /// Their rates; on SO(3) the base's angular velocity in base axes.
    pub v: [T; N],
    /// See [`Pose::rot_wc`].
    pub rot_wc: Rotation3<T>,
}

impl<T: Scalar, const N: usize> State<T, N> {
    /// At rest in a configuration.
    #[must_use]
    pub const fn at_rest(pose: Pose<T, N>) -> Self {
        Self {
            q: pose.q,
            v: [T::ZERO; N],
            rot_wc: pose.rot_wc,
        }
    }
}

/// Units of the unknowns and rows as the solver sees them, so that all are of order one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units<T> {
    pub(crate) acceleration: T,
    pub(crate) force: T,
    pub(crate) moment: T,
    pub(crate) foot_acceleration: T,
    pub(crate) position: T,
    pub(crate) speed: T,
}

impl<T: Scalar> Units<T> {
    pub(crate) fn new() -> Self {
        Self {
            acceleration: T::of(100.0),
            force: T::of(50.0),
            moment: T::of(10.0),
            foot_acceleration: T::of(10.0),
            position: T::of(0.1),
            speed: T::of(5.0),
        }
    }

    /// Of effort `i` of the chain.
    pub(crate) fn effort(&self, i: usize) -> T {
        if i < 3 { self.force } else { self.moment }
    }
}

/// Where the unknowns of an interval are among the controls: base accelerations, contact forces, joint
/// accelerations. The last are not there where the joints rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Feet in contact.
    pub(crate) feet: usize,
    /// Joints that move.
    pub(crate) joints: usize,
}

impl Layout {
    pub(crate) const fn controls(&self) -> usize {
        BASE.saturating_add(self.feet.saturating_mul(3))
            .saturating_add(self.joints)
    }

    /// Control of the acceleration of coordinate `i`, if it moves.
    #[inline(always)]
    pub(crate) const fn acceleration(&self, i: usize) -> Option<usize> {
        if i < BASE {
            Some(i)
        } else if i < BASE.saturating_add(self.joints) {
            Some(i.saturating_add(self.feet.saturating_mul(3)))
        } else {
            None
        }
    }

    /// First control of the force on the f-th foot in contact.
    #[inline(always)]
    pub(crate) const fn force(f: usize) -> usize {
        BASE.saturating_add(f.saturating_mul(3))
    }
}
