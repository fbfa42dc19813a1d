//! The jump machine with A1's plan from flash.

use a1_model::A1Geared;
use jump_control::{JointCommand, Measurement};
use jump_machine::Workspace;
use jump_machine::{Machine, Observation};
use rbd_core::{Model, Motion};
use saltus_probe::Real;
use saltus_probe::flight::{HOLD, Planned, jump, settings};

use super::{Control, Heard, pose};
use crate::joints::Joints;

/// Largest rate of a joint's torque, N m/s.
const SLEW: f64 = 1e4;

/// The machine and its clock.
#[derive(Debug)]
pub struct Jumper<T: Planned>
where
    A1Geared: Model<T, 12>,
{
    machine: Machine<'static, T, A1Geared, 12, 4>,
    ticks: u32,
}

impl<T: Planned> Control<T, 12> for Jumper<T>
where
    A1Geared: Model<T, 12>,
{
    type Heard = Observation<T, 12, 4>;
    type Memory = Workspace<T, 12, 4>;

    fn memory() -> Self::Memory {
        Workspace::new()
    }

    /// Standing, with the jump armed; `None` if the plan in flash is refused.
    fn new(workspace: &'static mut Self::Memory) -> Option<Self> {
        let mut machine = Machine::new(&A1Geared, settings(), workspace);
        machine.arm(jump()?, T::of(HOLD)).ok()?;
        Some(Self { machine, ticks: 0 })
    }

    fn joints() -> Joints<T, 12> {
        Joints::new(saltus_probe::control::motors(&A1Geared), T::of(SLEW))
    }

    fn tick(&mut self, heard: &Self::Heard) {
        let now = T::of(f64::from(self.ticks)) * T::of(1e-3);
        self.ticks = self.ticks.wrapping_add(1);
        self.machine.tick(now, Some(heard));
    }

    fn command(&self) -> &JointCommand<T, 12> {
        self.machine.command()
    }
}

impl<T: Real, const N: usize, const F: usize> Heard<T> for Observation<T, N, F> {
    fn read(mut next: impl FnMut() -> T) -> Self {
        Self {
            measured: Measurement {
                base: pose(&mut next),
                base_velocity: Motion::from_array(core::array::from_fn(|_| next())),
                joints: core::array::from_fn(|_| next()),
                joint_velocities: core::array::from_fn(|_| next()),
                foot_forces: core::array::from_fn(|_| next()),
                age: next(),
            },
            joint_torques: core::array::from_fn(|_| next()),
        }
    }
}
