//! From the torques that a joint loop asks for to those at the joints, whoever closes it.

use super::{RATIO, Step};
use crate::lab::{Disturbance, Ground, Motors};
use rbd_core::hardware::Budgets;
use rbd_core::{JointLimits, Motor, joint_friction};

/// Speed at which the joints' Coulomb friction fades, rad/s.
const FRICTION_SMOOTHING: f64 = 0.1;

/// Motors of one run, with what is under way to them and what is measured at them.
pub(crate) struct Actuators<const N: usize> {
    motors: Motors<N>,
    /// Torques that the joint loop has computed and that act from the next tick on.
    computed: [f64; N],
    /// What the boards believe to have given, friction included, since it was taken last: sum over ticks of a share of a millisecond.
    felt: [f64; N],
    limits: [JointLimits<f64>; N],
}

impl<const N: usize> Actuators<N> {
    /// At rest: how they differ, the joints' limits and motors, and the budgets that say what the supply gives.
    pub(crate) fn new(
        disturbance: &Disturbance,
        (limits, drives): (&[JointLimits<f64>; N], [Motor<f64>; N]),
        budgets: &Budgets,
    ) -> Self {
        Self {
            motors: Motors::new(disturbance, drives, budgets),
            computed: [0.0; N],
            felt: [0.0; N],
            limits: *limits,
        }
    }

    /// Mean torques of the last millisecond, friction included, N m, if they were taken a millisecond ago.
    pub(crate) const fn take_felt(&mut self) -> [f64; N] {
        core::mem::replace(&mut self.felt, [0.0; N])
    }

    /// A tick of the plant from the time `now` on, `since` the machine's command: applies what was computed a tick ago, and keeps for the next what
    /// the joint loop has `computed` of its encoders.
    pub(crate) fn step<const C: usize>(
        &mut self,
        (world, flies): (&mut Ground<N, C>, bool),
        (now, since): (f64, f64),
        (q, v): ([f64; N], [f64; N]),
        computed: [f64; N],
    ) -> Result<Step<N>, String> {
        let dt = world.plant().tick();
        let asked = core::mem::replace(&mut self.computed, computed);
        let speeds = world.velocity().joints;
        let given = self.motors.give(&asked, &speeds, dt);
        world.step(&given, flies)?;
        let losses = joint_friction(&self.limits, &v, FRICTION_SMOOTHING);
        for ((felt, tau), loss) in self.felt.iter_mut().zip(self.motors.measured()).zip(losses) {
            *felt += (tau + loss) / f64::from(RATIO);
        }
        Ok(Step {
            time: now + dt,
            since,
            dt,
            asked,
            speeds,
            encoders: (q, v),
            power: self.motors.power(),
        })
    }
}
