//! State of a node and units of the unknowns.

use crate::robot::BASE;
use so3::Scalar;

/// Configuration and velocity at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T, const N: usize> {
    /// Coordinates: base (m and rad), then joints (rad).
    pub q: [T; N],
    /// Their rates.
    pub v: [T; N],
}

impl<T: Scalar, const N: usize> State<T, N> {
    /// At rest at `q`.
    #[must_use]
    pub const fn at_rest(q: [T; N]) -> Self {
        Self { q, v: [T::ZERO; N] }
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
