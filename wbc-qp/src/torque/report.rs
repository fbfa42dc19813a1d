//! What limited a tick, by name.

use dense_qp::Constraint;
use so3::{Scalar, math};

use super::{TorqueAnswer, TorqueQp, get};
use crate::program::dot;
use crate::rows::{Extent, Limit, Limited, missed, outside};

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// What limited the answer of the last [`TorqueQp::solve`]: limits on which it lies, then what gave way by more than `least`
    /// (in the units of each row). Without a line, the costs alone decided.
    ///
    /// # Cost
    /// O(M V), and nothing where it is not called.
    pub fn report<'a>(
        &'a self,
        answer: &TorqueAnswer<T, N, K>,
        least: T,
    ) -> impl Iterator<Item = Limited<T>> + 'a {
        let mut z = [T::ZERO; V];
        let forces = answer.forces.map(|f| f / self.unit);
        for (to, x) in z
            .iter_mut()
            .zip(answer.acceleration.joints.iter().chain(&forces))
        {
            *to = *x;
        }
        let held = self.workspace.active().filter_map(|(constraint, side)| {
            let limit = self.name(constraint)?;
            let extent = Extent::Held(side);
            Some(Limited { limit, extent })
        });
        let motions = self.range.iter().enumerate();
        let motions = motions.filter_map(move |(i, range)| {
            missed(Limit::Motion(i), outside(get(&z, i), *range), least)
        });
        // The worst row of each contact.
        let contacts = (0..K).filter_map(move |k| {
            let contact = self.rows.contact_of(k);
            let rows = (0..K).filter(|i| self.rows.contact_of(*i) == contact);
            let by = rows.fold(T::ZERO, |most, i| {
                math::max(most, self.miss_of_contact(i, &z))
            });
            let is_first = k == 0 || self.rows.contact_of(k - 1) != contact;
            is_first
                .then(|| missed(Limit::Contact(contact), by, least))
                .flatten()
        });
        let users = self
            .rows
            .of_the_user()
            .filter_map(move |(i, number, asked)| {
                let by = outside(dot(&self.program.row(i), &z), asked);
                missed(Limit::Row(number), by, least)
            });
        held.chain(motions).chain(contacts).chain(users)
    }

    /// By how much a contact of load 1 misses its row `k`; z without slack.
    pub(super) fn miss_of_contact(&self, k: usize, z: &[T; V]) -> T {
        if get(&self.load, k) >= T::ONE {
            math::abs(dot(&self.program.row(k), z) - get(&self.wanted, k))
        } else {
            T::ZERO
        }
    }

    /// What a constraint of the program is; `None` for slack and for a contact's rows, which are no limits.
    fn name(&self, constraint: Constraint) -> Option<Limit> {
        match constraint {
            Constraint::Bound(i) if i < N => Some(Limit::Motion(i)),
            Constraint::Bound(i) if i < N + K => {
                Some(Limit::NormalForce(self.rows.contact_of(i - N)))
            }
            Constraint::Bound(_) => None,
            Constraint::Row(i) if i < K => None,
            Constraint::Row(i) => self.rows.number(i).map(Limit::Row).or_else(|| {
                let joint = self.first_torque.and_then(|first| i.checked_sub(first));
                if let Some(joint) = joint.filter(|joint| *joint < N) {
                    return Some(Limit::Torque(joint));
                }
                let row = self.program.row(i);
                let forces = row.iter().skip(N).position(|x| *x != T::ZERO)?;
                Some(Limit::Cone(self.rows.contact_of(forces)))
            }),
        }
    }
}
