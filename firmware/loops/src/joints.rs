//! The joint loop: what an interrupt at 10 kHz does, without waiting for anybody.

use a1_model::A1Geared;
use jump_control::{JointCommand, Slew, Watch};
use rbd_core::{Model, Motor};
use saltus_probe::Real;

/// Period of the joint loop, s.
pub const PERIOD: f64 = 1e-4;
/// Longest time without a command, s.
const SILENCE: f64 = 0.005;
/// Damping of the safe command, N m s/rad.
const SAFE: f64 = 2.0;
/// Largest rate of a joint's torque, N m/s.
const SLEW: f64 = 1e4;

/// The command in force, and the memory of the loop.
#[derive(Clone, Debug)]
pub struct Joints<T: Real> {
    command: JointCommand<T, 12>,
    motors: [Motor<T>; 12],
    slew: Slew<T, 12>,
    silence: T,
    /// How many commands there were.
    pub number: u32,
}

impl<T: Real> Joints<T>
where
    A1Geared: Model<T, 12>,
{
    /// Damping until the first command.
    #[must_use]
    pub fn new() -> Self {
        Self {
            command: JointCommand::damp(T::of(SAFE)),
            motors: saltus_probe::control::motors(&A1Geared),
            slew: Slew::new(T::of(SLEW)),
            silence: T::ZERO,
            number: 0,
        }
    }

    /// A new command from the control loop.
    pub fn give(&mut self, command: &JointCommand<T, 12>) {
        self.command = *command;
        self.silence = T::ZERO;
        self.number = self.number.wrapping_add(1);
    }

    /// Torques for these positions and velocities. Damping alone if no command came for 5 ms, or an encoder fails.
    pub fn tick(&mut self, q: &[T; 12], qd: &[T; 12]) -> [T; 12] {
        self.silence += T::of(PERIOD);
        if self.silence > T::of(SILENCE) || Watch::joints(q, qd).is_some() {
            self.command = JointCommand::damp(T::of(SAFE));
        }
        let wanted = self.command.torques(q, qd, &self.motors);
        self.slew.limit(&wanted, T::of(PERIOD))
    }
}

impl<T: Real> Default for Joints<T>
where
    A1Geared: Model<T, 12>,
{
    fn default() -> Self {
        Self::new()
    }
}
