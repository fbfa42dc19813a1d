//! Contacts in the torque program: cones as rows, normal forces as bounds, and costs of those that are not wholly there.

use so3::{Scalar, math};

use super::{TorqueQp, get};
use crate::{Contact, Error};

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// Contacts whose rows are no equalities, as costs: a load between 0 and 1 leads from nothing to an equality without a step.
    pub(super) fn weigh_contacts(&mut self) {
        let mut costs = [(0, T::ZERO, T::ZERO); K];
        let mut free = costs.iter_mut();
        let mut used = 0;
        for k in 0..K {
            let load = get(&self.load, k);
            let (wanted, (low, high)) = (get(&self.wanted, k), self.program.row_limits(k));
            if load > T::ZERO && low < high {
                let share = if load < T::ONE {
                    load / (T::ONE - load)
                } else {
                    T::ONE
                };
                if let Some(cost) = free.next() {
                    *cost = (k, wanted, self.contact_weight * share);
                    used += 1;
                }
            }
        }
        // All at once: each call goes over the whole of H.
        self.program.minimise_own(costs.into_iter().take(used));
    }

    /// Accelerations that contacts shall have besides the damping of their velocity, in the axes of their rows: feedback on where they
    /// are, a stiffness times [`Contact::error`]. Called after [`TorqueQp::begin`].
    pub fn correct_contacts(&mut self, accelerations: &[T; K]) {
        for (k, x) in accelerations.iter().enumerate() {
            let load = get(&self.load, k);
            if let Some(wanted) = self.wanted.get_mut(k) {
                *wanted += *x;
            }
            if load >= T::ONE {
                let wanted = get(&self.wanted, k);
                self.program.limit_row(k, wanted, wanted);
            } else if load > T::ZERO {
                let weight = self.contact_weight * load / (T::ONE - load);
                self.program.pull(k, *x * weight);
            }
        }
    }

    /// Friction cones as rows, normal forces as bounds; a contact that is off has no force.
    pub(super) fn write_cones(&mut self, contacts: &[Contact<T>]) -> Result<(), Error> {
        let mut first = N;
        for contact in contacts {
            self.rows.mark_contact(first - N);
            let size = contact.size();
            let mut k = 0;
            while let Some(cone) = contact.cone(k) {
                let mut row = [T::ZERO; V];
                for (x, c) in row.iter_mut().skip(first).zip(cone).take(size) {
                    *x = c;
                }
                self.program.constrain(&row, -T::INFINITY, T::ZERO)?;
                k += 1;
            }
            if contact.is_on() {
                let most = contact.max_force * math::min(contact.load, T::ONE);
                let least = math::min(contact.min_force, most);
                let normal = first + Contact::<T>::NORMAL;
                self.program
                    .bound(normal, least / self.unit, most / self.unit);
            } else {
                for i in first..first + size {
                    self.program.bound(i, T::ZERO, T::ZERO);
                }
            }
            first += size;
        }
        Ok(())
    }
}
