//! The push-off: the plan's torques as the robot and its legs are, its forces changed as the [regulator](crate::regulator) wants.

use jump_control::{Measurement, Reference};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, LimbEnd, Tangent, Tree, integrate};
use so3::{Scalar, math};

use crate::{Jump, Load, Machine};

/// Nodes by which the plan was less far when the oldest measurement was made, for the search only.
const BEHIND: usize = 3;

/// Where legs and base of a measurement are now: as they were, gone on at their velocities for its age.
pub(crate) fn predicted<T: Scalar, const N: usize, const F: usize>(
    measured: &Measurement<T, N, F>,
) -> Configuration<T, N> {
    let mut way = measured.velocity();
    way.base = way.base * measured.age;
    for joint in &mut way.joints {
        *joint *= measured.age;
    }
    integrate(&measured.configuration(), &way)
}

impl<'a, T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'a, T, M, N, F> {
    /// The plan's torques at time `t` of the plan, in `reference`, become those of this robot as it weighs and stands; the planned
    /// rotation of the base and the forces that they are for, world axes.
    ///
    /// A planned force f needs −Jᵀ Rᵀ f of the legs as they are, not as planned: the difference is added.
    #[inline(always)]
    pub(crate) fn as_it_stands(
        &self,
        jump: &Jump<'a, T, N, F>,
        t: T,
        reference: &mut Reference<T, N>,
    ) -> Option<(Rotation3<T>, [Vector3<T>; F])> {
        let (s, node) = (&self.settings, reference.node);
        let hold = self.payload.factor(s.max_payload);
        for torque in &mut reference.torques {
            *torque *= hold;
        }
        let ahead = jump.plan.node_at(t + s.lookahead, node);
        let mut forces_w = jump.plan.forces(ahead)?;
        // Before the start it stands as it does there.
        let base = jump.plan.base((node, math::max(t, T::ZERO)))?;
        for force in &mut forces_w {
            *force *= hold;
        }
        let rot_wb = self.limbs.posture.base().rotation;
        let (rot_bw, planned_rot_bw) = (rot_wb.inverse(), base.rot_wb.inverse());
        let legs = self.limbs.ends.iter().zip(&self.wanted.ends);
        for ((now, planned), force) in legs.zip(&forces_w) {
            now.add_tr_mul(&(rot_bw * -*force), &mut reference.torques);
            planned.add_tr_mul(&(planned_rot_bw * *force), &mut reference.torques);
        }
        Some((base.rot_wb, forces_w))
    }

    /// The plan's torques at time `t` of the plan, in `reference`, become those with which this robot comes back to its plan.
    ///
    /// The legs, seen late, are those of [`predicted`], and velocities are compared with those that were planned for the time of the measurement.
    #[inline(always)]
    pub(crate) fn push_off(
        &mut self,
        jump: &Jump<'a, T, N, F>,
        t: T,
        (measured, velocity): (&Measurement<T, N, F>, &Tangent<T, N>),
        reference: &mut Reference<T, N>,
    ) {
        let Some((rot_planned, forces_w)) = self.as_it_stands(jump, t, reference) else {
            return;
        };
        let (s, node) = (&self.settings, reference.node);
        let rot_bw = self.limbs.posture.base().rotation.inverse();
        let then = t - measured.age;
        let was = jump.plan.node_at(then, node.saturating_sub(BEHIND));
        let load = Load {
            share: self.centred.load,
            height: s.centring.load_height,
        };
        let changes = self.workspace.regulator.forces(
            (self.model, &s.regulator),
            &jump.plan,
            [(node, t), (was, then)],
            velocity,
            (
                &self.limbs,
                &self.centred.offset_b.unwrap_or_default(),
                &load,
            ),
            (&rot_planned, &forces_w),
        );
        for (end, change) in self.limbs.ends.iter().zip(&changes) {
            self.change(end, &(rot_bw * *change), measured, reference);
        }
    }

    /// Adds the torques of a change of the ground's force on one foot, base axes, as much of it as its motors have room for beside what the joint
    /// loop will ask.
    fn change(
        &self,
        end: &LimbEnd<T, N>,
        force_b: &Vector3<T>,
        measured: &Measurement<T, N, F>,
        reference: &mut Reference<T, N>,
    ) {
        let s = &self.settings;
        let mut share = T::ONE;
        for (j, column) in end.columns() {
            let wanted = -column.dot(force_b);
            let (Some(motor), Some(gains)) = (s.motors.get(j), s.pd.joint_gains.get(j)) else {
                continue;
            };
            let of = |numbers: &[T; N]| numbers.get(j).copied().unwrap_or_default();
            let (q, qd) = (of(&measured.joints), of(&measured.joint_velocities));
            let asked = of(&reference.torques)
                + gains.stiffness * (of(&reference.joints) - q)
                + gains.damping * (of(&reference.joint_velocities) - qd);
            let [low, high] = motor.torque_range(qd).map(|most| most * s.regulator.torque);
            let room = if wanted > T::ZERO {
                math::max(high - asked, T::ZERO)
            } else {
                math::min(low - asked, T::ZERO)
            };
            if math::abs(wanted) > math::abs(room) {
                share = math::min(share, room / wanted);
            }
        }
        end.add_tr_mul(&(force_b * -share), &mut reference.torques);
    }
}
