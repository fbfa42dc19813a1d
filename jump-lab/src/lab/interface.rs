//! How commands reach the motors.

use super::{Disturbance, Link};
use core::fmt;
use core::str::FromStr;
use jump_control::JointCommand;
use rbd_core::Motor;

/// What the machine commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// Torques at 10 kHz: the joint loop is the machine's own, with its limits on torque, speed and slew.
    Torque,
    /// What robots sell: (q, q̇, kp, kd, τ) so many times a second over a link; the motor board closes the loop and knows no
    /// limit but its current.
    JointPd {
        /// Commands a second.
        rate: u32,
    },
}

/// Rates of commands that robots' links have, 1/s.
const RATES: [u32; 2] = [500, 1000];
/// Least delay, and least jitter, of each direction of a command link, s: a packet of a few hundred bytes through two network stacks.
const LEAST_DELAY: f64 = 2.5e-4;

impl FromStr for Interface {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "torque" => Ok(Self::Torque),
            "joint-pd" => Ok(Self::JointPd { rate: 1000 }),
            _ => {
                let rate = text
                    .strip_prefix("joint-pd@")
                    .and_then(|hz| hz.parse().ok());
                rate.filter(|rate| RATES.contains(rate))
                    .map(|rate| Self::JointPd { rate })
                    .ok_or_else(|| {
                        format!(
                            "`{text}`: the interfaces are torque, joint-pd (1 kHz) and joint-pd@500"
                        )
                    })
            }
        }
    }
}

impl fmt::Display for Interface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torque => f.write_str("torque"),
            Self::JointPd { rate: 1000 } => f.write_str("joint-pd"),
            Self::JointPd { rate } => write!(f, "joint-pd@{rate}"),
        }
    }
}

impl Interface {
    /// Milliseconds between two commands.
    #[must_use]
    pub const fn period_ms(self) -> u64 {
        match self {
            Self::Torque => 1,
            Self::JointPd { rate } => 1000 / rate as u64,
        }
    }

    /// Share of the link's latency that lies on the way from the sensors to the machine, and the least of it, s: the joint loop of
    /// [`Interface::Torque`] is where the motors are, so that all of it does.
    #[must_use]
    pub const fn measuring(self) -> (f64, f64) {
        match self {
            Self::Torque => (1.0, 0.0),
            Self::JointPd { .. } => (0.5, LEAST_DELAY),
        }
    }
}

/// The motor boards behind a command link.
pub struct Boards<const N: usize> {
    link: Link<JointCommand<f64, N>>,
    held: JointCommand<f64, N>,
}

impl<const N: usize> Boards<N> {
    /// Damping until the first command arrives.
    #[must_use]
    pub fn new(disturbance: &Disturbance, seed: u64) -> Self {
        Self {
            link: Link::new(disturbance, 0.5, LEAST_DELAY, seed),
            held: JointCommand::damp(1.0),
        }
    }

    /// Sends a command at time `now`, s.
    pub fn send(&mut self, now: f64, command: &JointCommand<f64, N>) {
        self.link.send(now, *command);
    }

    /// Torques by the boards' own loop ([`board_torques`]) under the newest command that has arrived.
    pub fn torques(
        &mut self,
        now: f64,
        measured: (&[f64; N], &[f64; N]),
        motors: &[Motor<f64>; N],
    ) -> [f64; N] {
        if let Some((command, _)) = self.link.receive(now) {
            self.held = command;
        }
        board_torques(&self.held, measured, motors)
    }
}

/// What motor boards make of a command: τ + kp(q_d − q) + kd(q̇_d − q̇), cut at the current's limit only.
#[must_use]
pub fn board_torques<const N: usize>(
    command: &JointCommand<f64, N>,
    (q, qd): (&[f64; N], &[f64; N]),
    motors: &[Motor<f64>; N],
) -> [f64; N] {
    core::array::from_fn(|i| {
        let gains = command.gains[i];
        let spring = gains.stiffness * (command.position[i] - q[i]);
        let damper = gains.damping * (command.velocity[i] - qd[i]);
        let wanted = command.feed_forward[i] + spring + damper;
        wanted.clamp(-motors[i].torque, motors[i].torque)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Boards, Interface};
    use crate::lab::Disturbance;
    use a1_model::MOTORS;
    use jump_control::JointCommand;

    #[test]
    fn interfaces_are_read_back() {
        for text in ["torque", "joint-pd", "joint-pd@500"] {
            assert_eq!(text.parse::<Interface>().unwrap().to_string(), text);
        }
        assert_eq!(
            "joint-pd@1000".parse(),
            Ok(Interface::JointPd { rate: 1000 })
        );
        for wrong in ["", "pd", "joint-pd@", "joint-pd@50", "joint-pd@-1"] {
            assert!(wrong.parse::<Interface>().is_err(), "{wrong}");
        }
    }

    /// A command acts when it has arrived and not before, and only the current's limit cuts it.
    #[test]
    fn commands_arrive_late_and_are_held() {
        let mut boards = Boards::<12>::new(&Disturbance::NOMINAL, 1);
        let mut command = JointCommand::damp(0.0);
        command.feed_forward = [50.0; 12];
        boards.send(0.0, &command);
        let rest = ([0.0; 12], [30.0; 12]);
        let mut at = |now| boards.torques(now, (&rest.0, &rest.1), &MOTORS)[0];
        assert_eq!(at(1e-4), -30.0);
        assert_eq!(at(1e-3), MOTORS[0].torque);
        assert_eq!(at(2e-3), MOTORS[0].torque);
    }
}
