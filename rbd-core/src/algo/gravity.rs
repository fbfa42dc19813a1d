//! The effort of gravity alone.
//!
//! τ_j = −(m ∂c/∂q_j)·g: with h the first moment of the subtree of joint j in its own axes, a revolute joint
//! feels −(axis × h)·g and a prismatic one −m axis·g. Gravity is turned into body axes on the way down;
//! masses and first moments add up on the way back.

use nalgebra::Vector3;
use so3::Scalar;

use super::com::Moments;
use super::{place, put};
use crate::joint::{JointKind, JointRotation};
use crate::spatial::Force;
use crate::state::{Effort, Posture};
use crate::tree::{At, Fold, Tree};

/// Gravity in the world as a vector of the scalar, m/s².
#[inline(always)]
pub(crate) fn gravity<T: Scalar>() -> Vector3<T> {
    Vector3::from(crate::GRAVITY.map(T::of))
}

struct Gravity<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    effort: [T; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Gravity<'_, T, N> {
    /// g in body axes.
    type Down = Vector3<T>;
    type Keep = [T; 3];
    type Up = Moments<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Vector3<T>) -> (Vector3<T>, [T; 3]) {
        let (rotation, _) = place::<J, T, N>(here, self.posture);
        let g = rotation.down(up);
        (g, g.into())
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        g: &[T; 3],
        children: Moments<T>,
    ) -> Moments<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let subtree = Moments::of(here.body) + children;
        let g = Vector3::from(*g);
        let along = if J::KIND.is_revolute() {
            J::component(&subtree.first.cross(&g))
        } else {
            J::component(&g) * subtree.mass
        };
        put(&mut self.effort, here.index, -along * here.body.sign);
        let first = rotation.up(&subtree.first) + offset * subtree.mass;
        Moments {
            mass: subtree.mass,
            first,
        }
    }
}

/// The effort that holds the robot still against gravity, g(q) of paper A eq. (4).
#[inline]
#[must_use]
pub fn generalized_gravity<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
) -> Effort<T, N> {
    let g = posture.base.rotation.matrix().tr_mul(&gravity());
    let mut fold = Gravity {
        posture,
        effort: [T::ZERO; N],
    };
    let base = model.base();
    let own = Moments {
        mass: base.mass,
        first: Vector3::from(base.first),
    };
    let whole = own + model.fold(&mut fold, &g);
    let base = Force {
        linear: -g * whole.mass,
        angular: -whole.first.cross(&g),
    };
    Effort {
        base,
        joints: fold.effort,
    }
}
