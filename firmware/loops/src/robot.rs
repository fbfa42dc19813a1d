//! The hardware behind one trait, and a simulated A1 behind it.

use a1_model::A1Geared;
use jump_machine::Inputs;
use rbd_core::Model;
use saltus_probe::Real;
use saltus_probe::flight::{Flight, Planned};

/// What firmware needs of a robot. No method waits.
pub trait Robot<T: Real> {
    /// Joint positions and velocities of now, rad and rad/s: every 100 µs.
    fn encoders(&mut self) -> ([T; 12], [T; 12]);

    /// What the control loop is to hear, every millisecond: base, joints, feet, and the mean torques of the last millisecond.
    fn sensors(&mut self) -> Inputs<T, 12, 4>;

    /// Gives torques to the motors, N m.
    fn drive(&mut self, torques: &[T; 12]);

    /// Whether the flight is over, so that a simulator can stop.
    fn is_over(&self) -> bool;
}

impl<T: Planned> Robot<T> for Flight<T>
where
    A1Geared: Model<T, 12>,
{
    fn encoders(&mut self) -> ([T; 12], [T; 12]) {
        self.joints()
    }

    fn sensors(&mut self) -> Inputs<T, 12, 4> {
        self.hear()
    }

    fn drive(&mut self, torques: &[T; 12]) {
        self.step(torques);
    }

    fn is_over(&self) -> bool {
        Flight::is_over(self)
    }
}
