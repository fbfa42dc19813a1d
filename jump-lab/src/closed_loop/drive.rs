//! The path from the machine's commands to the plant's torques.

use super::{Actuators, Sensors};
use crate::lab::{Boards, Disturbance, Ground, Interface};
use jump_control::{JointCommand, Phase};
use jump_machine::JumpMachine;
use rbd_core::hardware::Budgets;
use rbd_core::{JointLimits, Motor, Tree};

/// Boards and motors of one run.
pub struct Drive<const N: usize> {
    interface: Interface,
    boards: Boards<N>,
    actuators: Actuators<N>,
    drives: [Motor<f64>; N],
}

/// One tick of the plant.
pub struct Step<const N: usize> {
    /// Time of the jump at its end, s.
    pub time: f64,
    /// Time from the machine's command to its begin, s.
    pub since: f64,
    /// Its length, s.
    pub dt: f64,
    /// Torques that the joint loop asked for.
    pub asked: [f64; N],
    /// Speeds of the joints at its begin, rad/s.
    pub speeds: [f64; N],
    /// Positions and velocities as the encoders said at its begin.
    pub encoders: ([f64; N], [f64; N]),
    /// What the supply gave, W.
    pub power: f64,
}

impl<const N: usize> Drive<N> {
    /// Boards and motors at rest: how they differ, how they are commanded with the seed of their delays, the joints' limits and motors, and the
    /// budgets that say what the supply gives.
    #[must_use]
    pub fn new(
        disturbance: &Disturbance,
        (interface, seed): (Interface, u64),
        (limits, drives): (&[JointLimits<f64>; N], [Motor<f64>; N]),
        budgets: &Budgets,
    ) -> Self {
        Self {
            interface,
            boards: Boards::new(disturbance, seed.wrapping_add(0xb0a2d)),
            actuators: Actuators::new(disturbance, (limits, drives), budgets),
            drives,
        }
    }

    /// Mean torques since the last call, friction included, N m.
    pub const fn take_felt(&mut self) -> [f64; N] {
        self.actuators.take_felt()
    }

    /// Sends the command of the `k`-th millisecond at time `t` to the boards, where they listen.
    pub fn send(&mut self, k: u64, t: f64, command: &JointCommand<f64, N>) {
        if k.is_multiple_of(self.interface.period_ms()) {
            self.boards.send(t, command);
        }
    }

    /// The `i`-th tick of the plant in the millisecond that began at `t`: reads the encoders, lets the joint loop compute, and applies what
    /// it computed a tick ago.
    ///
    /// # Errors
    /// What the simulator says.
    pub fn step<R, M, const F: usize, const C: usize, const E: usize>(
        &mut self,
        (machine, world, sensors): (&mut M, &mut Ground<N, C>, &mut Sensors<R, N, F, C, E>),
        t: f64,
        i: u32,
    ) -> Result<Step<N>, String>
    where
        R: Tree<f64, N>,
        M: JumpMachine<f64, N, F>,
    {
        let dt = world.plant().tick();
        let since = f64::from(i) * dt;
        let now = t + since;
        let (q, v) = sensors.encoders(world);
        let computed = match self.interface {
            Interface::Torque => machine.joint_tick(&q, &v, dt),
            Interface::JointPd { .. } => self.boards.torques(now, (&q, &v), &self.drives),
        };
        let flies = matches!(machine.phase(), Phase::Flight | Phase::PreLanding);
        let times = (now, since);
        self.actuators.step((world, flies), times, (q, v), computed)
    }
}
