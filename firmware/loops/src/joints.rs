//! The joint loop: what an interrupt at 10 kHz does, without waiting for anybody.

use jump_control::{JointCommand, Slew, Watch};
use rbd_core::Motor;
use saltus_probe::Real;

/// Period of the joint loop, s.
pub const PERIOD: f64 = 1e-4;
/// Longest time without a command, s.
const SILENCE: f64 = 0.005;
/// Damping of the safe command, N m s/rad.
const SAFE: f64 = 2.0;

/// The command in force, and the memory of the loop.
#[derive(Clone, Debug)]
pub struct Joints<T: Real, const N: usize> {
    command: JointCommand<T, N>,
    motors: [Motor<T>; N],
    slew: Slew<T, N>,
    silence: T,
    /// How many commands there were.
    pub number: u32,
}

impl<T: Real, const N: usize> Joints<T, N> {
    /// Damping until the first command; `slew` is the largest rate of a joint's torque, N m/s.
    #[must_use]
    pub fn new(motors: [Motor<T>; N], slew: T) -> Self {
        Self {
            command: JointCommand::damp(T::of(SAFE)),
            motors,
            slew: Slew::new(slew),
            silence: T::ZERO,
            number: 0,
        }
    }

    /// A new command from the control loop.
    pub fn give(&mut self, command: &JointCommand<T, N>) {
        self.command = *command;
        self.silence = T::ZERO;
        self.number = self.number.wrapping_add(1);
    }

    /// Torques for these positions and velocities. Damping alone if no command came for 5 ms, or an encoder fails.
    pub fn tick(&mut self, q: &[T; N], qd: &[T; N]) -> [T; N] {
        self.silence += T::of(PERIOD);
        if self.silence > T::of(SILENCE) || Watch::joints(q, qd).is_some() {
            self.command = JointCommand::damp(T::of(SAFE));
        }
        let wanted = self.command.torques(q, qd, &self.motors);
        self.slew.limit(&wanted, T::of(PERIOD))
    }
}
