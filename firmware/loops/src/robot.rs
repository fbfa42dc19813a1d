//! The hardware behind one trait, and simulated robots behind it.

use a1_model::A1Geared;
use jump_machine::Observation;
use rbd_core::Model;
use saltus_probe::flight::{Flight, IcubFlight, Planned};
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

impl<T: Planned> Robot<T, 12> for Flight<T>
where
    A1Geared: Model<T, 12>,
{
    type Heard = Observation<T, 12, 4>;

    fn encoders(&mut self) -> ([T; 12], [T; 12]) {
        self.joints()
    }

    fn sensors(&mut self) -> Observation<T, 12, 4> {
        self.hear()
    }

    fn drive(&mut self, torques: &[T; 12]) {
        self.step(torques);
    }

    fn is_over(&self) -> bool {
        Flight::is_over(self)
    }
}

impl Robot<f64, 23> for IcubFlight {
    type Heard = Observation<f64, 23, 2>;

    fn encoders(&mut self) -> ([f64; 23], [f64; 23]) {
        self.joints()
    }

    fn sensors(&mut self) -> Self::Heard {
        self.hear()
    }

    fn drive(&mut self, torques: &[f64; 23]) {
        self.step(torques);
    }

    fn is_over(&self) -> bool {
        Self::is_over(self)
    }
}
