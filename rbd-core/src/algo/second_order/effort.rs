//! Efforts of the joints, paper A eq. (4), and their first derivatives.
//!
//! With τ = S · f, f the force of the subtree less the contact forces on it, for a joint j and an ancestor k, or k = j, and
//! with I, C of the subtree of j ([`super::moments`]):
//!
//! ```text
//! ∂τ_j/∂q_k = S̈_k · I S_j + Ṡ_k · Cᵀ S_j          ∂τ_k/∂q_j = S_k · (S_j ×* f + I S̈_j + C Ṡ_j)
//! ∂τ_j/∂q̇_k = 2 Ṡ_k · I S_j + S_k · Cᵀ S_j        ∂τ_k/∂q̇_j = S_k · (2 I Ṡ_j + C S_j)
//! ∂τ_j/∂q̈_k = S_k · I S_j = ∂τ_k/∂q̈_j
//! ```
//!
//! plus what contact forces add because they keep their direction in the world.
//!
//! Source: Singh, Russell, Wensing, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra",
//! RA-L 2022; the moments' form is derived in [`super::moments`].

use nalgebra::Vector3;
use so3::Scalar;

use super::{Contacts, Gradient, Sweep};
use crate::spatial::Force;

/// Jacobians of the efforts by rows: `by_q[i][k]` is ∂τ_i/∂q_k, in N m or N per rad or m.
#[derive(Clone, Copy, Debug)]
pub struct EffortJacobian<T, const N: usize, const CONTACTS: usize> {
    /// ∂τ_i/∂q_k.
    pub by_q: [[T; N]; N],
    /// ∂τ_i/∂q̇_k.
    pub by_v: [[T; N]; N],
    /// ∂τ_i/∂q̈_k: the mass matrix, rotors included.
    pub by_a: [[T; N]; N],
    /// `by_force[i][f]` is ∂τ_i/∂F of the f-th contact that counts: less its Jacobian, at the point where the force acts.
    pub by_force: [[[T; 3]; CONTACTS]; N],
}

impl<T: Scalar, const N: usize, const CONTACTS: usize> EffortJacobian<T, N, CONTACTS> {
    /// All zero.
    pub const ZERO: Self = Self {
        by_q: [[T::ZERO; N]; N],
        by_v: [[T::ZERO; N]; N],
        by_a: [[T::ZERO; N]; N],
        by_force: [[[T::ZERO; 3]; CONTACTS]; N],
    };

    /// Gradient of the effort of joint `i`, which is less than `N`; zero beyond.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, i: usize) -> Gradient<T, N, CONTACTS> {
        match (
            self.by_q.get(i),
            self.by_v.get(i),
            self.by_a.get(i),
            self.by_force.get(i),
        ) {
            (Some(q), Some(v), Some(a), Some(force)) => Gradient {
                q: *q,
                v: *v,
                a: *a,
                force: *force,
            },
            _ => Gradient::ZERO,
        }
    }
}

impl<T: Scalar, const N: usize> Sweep<'_, T, N> {
    /// Effort of every joint, N m or N, with accelerations `qdd` and under contact forces: rotors included, friction not.
    #[inline(never)]
    pub fn effort<const CONTACTS: usize>(
        &self,
        qdd: &[T; N],
        contacts: &Contacts<T, CONTACTS>,
        effort: &mut [T; N],
    ) {
        for i in 0..N {
            effort[i] = self.joints[i].axis.dot(&self.moments[i].force)
                + self.bodies[i].rotor_inertia * qdd[i];
        }
        for (point, force) in contacts.active() {
            let wrench = Force::new(*force, (point.pos + point.arm).cross(force));
            for k in self.path(point.link) {
                effort[k] -= self.joints[k].axis.dot(&wrench);
            }
        }
    }

    /// Jacobians of the efforts; `out` is [`EffortJacobian::ZERO`] before, since only what is not zero is written.
    #[inline(never)]
    pub fn differentiate<const CONTACTS: usize>(
        &self,
        contacts: &Contacts<T, CONTACTS>,
        out: &mut EffortJacobian<T, N, CONTACTS>,
    ) {
        let pushes = contacts.sums(self);
        for (j, push) in pushes.iter().enumerate() {
            let (joint, sums) = (&self.joints[j], &self.moments[j]);
            let s = &joint.axis;
            let by_a = sums.inertia(s);
            let by_v = sums.carried_transposed(s);
            let above_v = sums.inertia(&joint.rate) * T::TWO + sums.carried(s);
            let kept = push.kept_direction(s);
            let above_q = s.cross_force(&sums.force)
                + sums.inertia(&joint.second)
                + sums.carried(&joint.rate)
                + Force::new(Vector3::zeros(), kept);
            let rotor = self.bodies[j].rotor_inertia;
            for k in self.path(j) {
                let other = &self.joints[k];
                out.by_q[k][j] = other.axis.dot(&above_q);
                out.by_v[k][j] = other.axis.dot(&above_v);
                let mass = other.axis.dot(&by_a);
                (out.by_a[j][k], out.by_a[k][j]) = (mass, mass);
                if k == j {
                    out.by_a[j][j] += rotor;
                }
                out.by_q[j][k] = other.second.dot(&by_a)
                    + other.rate.angular.dot(&by_v)
                    + other.axis.angular.dot(&kept);
                out.by_v[j][k] = other.rate.dot(&by_a) * T::TWO + other.axis.angular.dot(&by_v);
            }
        }
        for (f, (point, force)) in contacts.active().enumerate() {
            self.differentiate_couple(point, force, out);
            for k in self.path(point.link) {
                let column = -self.joints[k].axis.at_point(&(point.pos + point.arm));
                if let Some(slot) = out.by_force[k].get_mut(f) {
                    *slot = column.into();
                }
            }
        }
    }
}
