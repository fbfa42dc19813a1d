//! iCub's jump machine.

use icub_model::profile::{JOINTS, Machine, Workspace};
use icub_model::{Icub23GazeboGeared, MOTORS};
use jump_control::JointCommand;
use jump_machine::Observation;
use saltus_probe::flight::{icub_machine, icub_settings};

use super::Control;
use crate::joints::Joints;

/// Largest rate of a joint's torque, N m/s: the program holds its torques for a millisecond, and smooths them itself.
const SLEW: f64 = 1e5;

/// The machine and its clock.
#[derive(Debug)]
pub struct Humanoid {
    machine: Machine<'static, Icub23GazeboGeared>,
    ticks: u32,
}

impl Control<f64, JOINTS> for Humanoid {
    type Heard = Observation<f64, JOINTS, 2>;
    type Memory = Workspace;

    fn memory() -> Workspace {
        Workspace::new(&icub_settings())
    }

    /// Standing in the squat, with the jump armed.
    fn new(workspace: &'static mut Workspace) -> Option<Self> {
        let machine = icub_machine(workspace)?;
        Some(Self { machine, ticks: 0 })
    }

    fn joints() -> Joints<f64, JOINTS> {
        Joints::new(MOTORS, SLEW)
    }

    fn tick(&mut self, heard: &Self::Heard) {
        let now = f64::from(self.ticks) * 1e-3;
        self.ticks = self.ticks.wrapping_add(1);
        self.machine.tick(now, Some(heard));
    }

    fn command(&self) -> &JointCommand<f64, JOINTS> {
        self.machine.command()
    }
}
