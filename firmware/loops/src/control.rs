//! The control loop at 1 kHz: the jump machine with A1's plan from flash.

use a1_model::A1Geared;
use jump_control::JointCommand;
use jump_machine::{Inputs, Machine, Tick};
use landing::Workspace;
use rbd_core::Model;
use saltus_probe::flight::{HOLD, Planned, jump, settings};

/// The machine and its clock.
#[derive(Debug)]
pub struct Control<'a, T: Planned>
where
    A1Geared: Model<T, 12>,
{
    machine: Machine<'a, T, A1Geared, 12, 4>,
    ticks: u32,
}

impl<'a, T: Planned> Control<'a, T>
where
    A1Geared: Model<T, 12>,
{
    /// Standing, with the jump armed; `None` if the plan in flash is refused.
    #[must_use]
    pub fn new(workspace: &'a mut Workspace<T, 12, 4>) -> Option<Self> {
        let mut machine = Machine::new(&A1Geared, settings(), workspace);
        machine.arm(jump()?, T::of(HOLD)).ok()?;
        Some(Self { machine, ticks: 0 })
    }

    /// One tick; the command is then [`Control::command`].
    pub fn tick(&mut self, inputs: &Inputs<T, 12, 4>) -> Tick {
        let now = T::of(f64::from(self.ticks)) * T::of(1e-3);
        self.ticks = self.ticks.wrapping_add(1);
        self.machine.tick(now, Some(inputs))
    }

    /// What the joints are to do.
    #[must_use]
    pub const fn command(&self) -> &JointCommand<T, 12> {
        self.machine.command()
    }
}
