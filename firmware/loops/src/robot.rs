//! The hardware behind one trait, and simulated robots behind it.

use jump_machine::Observation;
use rbd_core::Tree;
use saltus_probe::flight::Simulated;
use saltus_probe::{Numbers, Real};

use crate::recorder::Recorder;

/// What firmware needs of a robot with `N` joints. No method waits.
pub trait Robot<T: Real, const N: usize> {
    /// What the control loop hears.
    type Heard: Numbers + Copy;

    /// Joint positions and velocities of now, rad and rad/s: every 100 µs.
    fn encoders(&mut self) -> ([T; N], [T; N]);

    /// What the control loop is to hear, every millisecond and before [`Robot::encoders`].
    fn sensors(&mut self) -> Self::Heard;

    /// Takes bytes of the flight recorder along with the next torques, where there is room; else the idle loop writes them out.
    fn carry<const B: usize>(&mut self, _recorder: &mut Recorder<B>) {}

    /// Gives torques to the motors, N m.
    fn drive(&mut self, torques: &[T; N]);

    /// Whether the flight is over, so that a simulator can stop.
    fn is_over(&self) -> bool;
}

impl<T: Real, M: Tree<T, N>, const N: usize, const F: usize, const B: usize> Robot<T, N>
    for Simulated<T, M, N, F, B>
{
    type Heard = Observation<T, N, F>;

    fn encoders(&mut self) -> ([T; N], [T; N]) {
        self.joints()
    }

    fn sensors(&mut self) -> Self::Heard {
        self.hear()
    }

    fn drive(&mut self, torques: &[T; N]) {
        self.step(torques);
    }

    fn is_over(&self) -> bool {
        Self::is_over(self)
    }
}
