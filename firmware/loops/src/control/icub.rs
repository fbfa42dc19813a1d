//! iCub's push-off by the torque program.

use icub_model::MOTORS;
use jump_control::JointCommand;
use rbd_core::{Configuration, Motion, Tangent};
use saltus_probe::flight::IcubPush;

use super::{Control, Heard, pose};
use crate::joints::Joints;

/// Largest rate of a joint's torque, N m/s: the program holds its torques for a millisecond, and smooths them itself.
const SLEW: f64 = 1e5;

impl Control<f64, 23> for IcubPush {
    type Heard = (Configuration<f64, 23>, Tangent<f64, 23>);
    /// The program keeps its own.
    type Memory = ();

    fn memory() {}

    fn new((): &'static mut ()) -> Option<Self> {
        Self::new()
    }

    fn joints() -> Joints<f64, 23> {
        Joints::new(MOTORS, SLEW)
    }

    fn tick(&mut self, heard: &Self::Heard) {
        // Without an answer the last command stays.
        let _torques = self.tick(heard);
    }

    fn command(&self) -> &JointCommand<f64, 23> {
        self.command()
    }
}

impl Heard<f64> for (Configuration<f64, 23>, Tangent<f64, 23>) {
    fn read(mut next: impl FnMut() -> f64) -> Self {
        let q = Configuration {
            base: pose(&mut next),
            joints: core::array::from_fn(|_| next()),
        };
        let v = Tangent {
            base: Motion::from_array(core::array::from_fn(|_| next())),
            joints: core::array::from_fn(|_| next()),
        };
        (q, v)
    }
}
