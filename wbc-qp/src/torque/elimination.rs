//! The base and the torques as functions of the variables: the equations of motion, solved once per tick.

use rbd_core::linear::{ldl_back_substitute, ldl_factor};
use rbd_core::{BaseKind, Effort, Force, Motion, Tangent, Tree, crba, nonlinear_effects};
use so3::Scalar;

use super::{TorqueQp, get};
use crate::Snapshot;

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// Writes a_b and τ as functions of z.
    pub(super) fn eliminate<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Effort<T, N>; K],
        friction: &[T; N],
    ) {
        crba(model, &snapshot.posture, &mut self.mass);
        let bias = nonlinear_effects(model, &snapshot.posture, &snapshot.velocity);
        let moves = model.base_kind() == BaseKind::Floating;
        let locked = self.mass.base;
        let mut factors =
            [0, 1, 2, 3, 4, 5].map(|i| locked.mul(&Tangent::<T, N>::unit(i).base).to_array());
        ldl_factor(&mut factors);
        // A fixed base does not accelerate, whatever pulls at it.
        let solve = |f: Force<T>| {
            if moves {
                Motion::from_array(ldl_back_substitute(&factors, f.to_array()))
            } else {
                Motion::ZERO
            }
        };
        self.base_constant = solve(-bias.base);
        let columns = self.mass.coupling.iter().map(|f| -*f);
        let columns = columns.chain(contacts.iter().map(|row| row.base * self.unit));
        for (to, f) in self.base.iter_mut().zip(columns) {
            *to = solve(f);
        }
        let joints = self.effort.iter_mut().zip(&mut self.effort_constant);
        let mass = self.mass.coupling.iter().zip(&self.mass.joints);
        let known = bias.joints.iter().zip(friction);
        for (j, (((row, constant), (coupling, mass)), (h, friction))) in
            joints.zip(mass).zip(known).enumerate()
        {
            *constant = self.base_constant.dot(coupling) + *h - *friction;
            let direct = mass.iter().copied();
            let direct = direct.chain(contacts.iter().map(|c| -get(&c.joints, j) * self.unit));
            for ((x, base), direct) in row.iter_mut().zip(&self.base).zip(direct) {
                *x = base.dot(coupling) + direct;
            }
        }
    }

    /// A row over motions as coefficients of z and a constant.
    pub(super) fn row(&self, row: &Effort<T, N>) -> ([T; V], T) {
        let mut a = [T::ZERO; V];
        let direct = row.joints.iter().copied().chain([T::ZERO; K]);
        for ((x, base), direct) in a.iter_mut().zip(&self.base).zip(direct) {
            *x = direct + base.dot(&row.base);
        }
        (a, self.base_constant.dot(&row.base))
    }
}
