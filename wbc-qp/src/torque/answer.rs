//! What a torque program found, in the units of its user.

use rbd_core::Tangent;
use so3::{Scalar, math};

use super::{TorqueQp, Yielded};
use crate::program::dot;

/// What a torque program found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueAnswer<T, const N: usize, const K: usize> {
    /// τ, N m: the command, inside its limits.
    pub torques: [T; N],
    /// ν̇.
    pub acceleration: Tangent<T, N>,
    /// Force coordinates in the order of the contacts, N and N m.
    pub forces: [T; K],
    /// Which rows had to yield.
    pub yielded: Yielded,
    /// Largest amount by which a joint's acceleration is outside its limits, rad/s².
    pub limit_violation: T,
    /// Largest amount by which the acceleration of a contact of load 1 misses, m/s² or rad/s².
    pub contact_violation: T,
    /// Iterations of all solves.
    pub iterations: u32,
    /// Whether the cap ended the search: torques are the last iterate's, cut to their ranges; accelerations and forces are those of
    /// before the cut, and may be outside of their limits.
    pub capped: bool,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    pub(super) fn answer(
        &self,
        z: &[T; V],
        yielded: Yielded,
        iterations: u32,
    ) -> TorqueAnswer<T, N, K> {
        let mut answer = TorqueAnswer {
            torques: self.effort_constant,
            acceleration: Tangent {
                base: self.base_constant,
                joints: [T::ZERO; N],
            },
            forces: [T::ZERO; K],
            yielded,
            limit_violation: T::ZERO,
            contact_violation: T::ZERO,
            iterations,
            capped: false,
        };
        for (tau, row) in answer.torques.iter_mut().zip(&self.effort) {
            *tau += dot(row, z);
        }
        for (base, x) in self.base.iter().zip(z) {
            answer.acceleration.base += *base * *x;
        }
        for (to, x) in answer.acceleration.joints.iter_mut().zip(z) {
            *to = *x;
        }
        for (to, x) in answer.forces.iter_mut().zip(z.iter().skip(N)) {
            *to = *x * self.unit;
        }
        for (x, [low, high]) in z.iter().zip(&self.range) {
            let outside = math::max(*low - *x, *x - *high);
            answer.limit_violation = math::max(answer.limit_violation, outside);
        }
        for (k, (wanted, load)) in self.wanted.iter().zip(&self.load).enumerate() {
            if *load >= T::ONE {
                let miss = math::abs(dot(&self.program.row(k), z) - *wanted);
                answer.contact_violation = math::max(answer.contact_violation, miss);
            }
        }
        answer
    }
}
