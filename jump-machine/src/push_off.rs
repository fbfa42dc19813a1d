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

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing, reason = "tests")]
    use a1_model::{A1Geared, BUILD, FEET, MOTORS};
    use jump_control::{JointCommand, JointGains, Measurement, Reference};
    use nalgebra::Vector3;
    use proptest::array::uniform3;
    use proptest::prelude::{ProptestConfig, prop_assert, prop_assert_eq, proptest};
    use rbd_core::{Configuration, Limbs, Motion, Motor};

    use crate::{Machine, Settings, Workspace};

    const CROUCH: [f64; 12] = [
        0.1, 0.9, -1.8, -0.1, 0.8, -1.6, 0.0, 0.7, -1.5, 0.2, 0.9, -1.4,
    ];

    /// What the joint loop would ask for if motors could give anything.
    fn asked(
        measured: &Measurement<f64, 12, 4>,
        reference: &Reference<f64, 12>,
        gains: [JointGains<f64>; 12],
    ) -> [f64; 12] {
        let command = JointCommand {
            position: reference.joints,
            velocity: reference.joint_velocities,
            feed_forward: reference.torques,
            gains,
        };
        let tireless = MOTORS.map(|motor| Motor {
            torque: 1e9,
            corner_speed: 1e9,
            no_load_speed: 2e9,
            ..motor
        });
        command.torques(&measured.joints, &measured.joint_velocities, &tireless)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

        /// A change of a foot's force is felt by its own leg alone, in full where its motors have room for it beside what the servos ask; else as far as the first joint
        /// is at the end of its room, and not at all where one is beyond it.
        #[test]
        fn a_foots_force_is_changed_as_far_as_its_motors_have_room(
            foot in 0_usize..4,
            force in uniform3(-80.0..80.0_f64),
            torques in uniform3(-15.0..15.0_f64),
            off in uniform3(-0.1..0.1_f64),
            speeds in uniform3([-15.0..15.0_f64, -15.0..15.0]),
        ) {
            let settings = Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, CROUCH);
            let mut workspace = Workspace::new();
            let machine = Machine::<f64, A1Geared, 12, 4>::new(&A1Geared, settings, &mut workspace);
            let measured = Measurement {
                base: Configuration::<f64, 12>::NEUTRAL.base,
                base_velocity: Motion::ZERO,
                joints: CROUCH,
                joint_velocities: core::array::from_fn(|j| speeds[j % 3][0]),
                foot_forces: [0.0; 4],
                age: 0.0,
            };
            let mut reference = Reference {
                joints: core::array::from_fn(|j| CROUCH[j] + off[j % 3]),
                joint_velocities: core::array::from_fn(|j| speeds[j % 3][1]),
                torques: core::array::from_fn(|j| torques[j % 3]),
                node: 0,
            };
            let q = Configuration { joints: CROUCH, ..Configuration::NEUTRAL };
            let limbs: Limbs<f64, 12, 4> = Limbs::new(&A1Geared, &q, &settings.pd.feet);
            let end = &limbs.ends[foot];
            let force_b = Vector3::from(force);
            // What the ground does to the foot the joints hold.
            let mut whole = [0.0; 12];
            end.add_tr_mul(&-force_b, &mut whole);
            let (torques, before) = (reference.torques, asked(&measured, &reference, settings.pd.joint_gains));
            machine.change(end, &force_b, &measured, &mut reference);
            let after = asked(&measured, &reference, settings.pd.joint_gains);
            let (most, size) = whole.iter().enumerate().fold((0, 0.0), |(most, size): (usize, f64), (j, x)| {
                if x.abs() > size { (j, x.abs()) } else { (most, size) }
            });
            let share = if size > 0.0 { (reference.torques[most] - torques[most]) / whole[most] } else { 1.0 };
            prop_assert!((0.0..=1.0 + 1e-12).contains(&share), "{share}");
            let (mut beyond, mut at_end) = (false, false);
            for j in 0..12 {
                prop_assert!((reference.torques[j] - torques[j] - share * whole[j]).abs() < 1e-9);
                if j / 3 != foot {
                    prop_assert_eq!(whole[j], 0.0);
                    continue;
                }
                let range = MOTORS[j].torque_range(measured.joint_velocities[j]);
                let (sense, end) = (whole[j].signum(), range[usize::from(whole[j] > 0.0)]);
                let left = |asked: f64| (end * settings.regulator.torque - asked) * sense;
                beyond |= left(before[j]) < 0.0;
                at_end |= left(after[j]).abs() < 1e-9;
                prop_assert!(left(after[j]) > -1e-9 || share == 0.0, "joint {j}: {share}");
            }
            prop_assert!(if beyond { share == 0.0 } else { share > 1.0 - 1e-12 || at_end }, "{share}");
        }
    }
}
