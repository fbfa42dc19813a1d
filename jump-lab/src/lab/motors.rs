//! From the torque that is asked for to the torque at the joint: the current loop, the motor's real torque constant, and a supply whose
//! voltage sags.
//!
//! What a motor cannot do at its speed, the simulators cut off themselves; here the speed at which that begins is lowered. Torque τ at
//! speed ω needs the voltage U = R τ/(n k) + k n ω, so a voltage that is lower by a share s of U leaves for each torque a speed
//! that is lower by s times the no-load speed.

use super::{Disturbance, Key};
use rbd_core::Motor;

/// Supply power at which the whole sag is there, W: all knees of A1 at their corner speed and torque are 1.3 kW of motion and as much of
/// heat.
const FULL_POWER: f64 = 2000.0;

/// The motors of `N` joints with their state.
pub struct Motors<const N: usize> {
    motors: [Motor<f64>; N],
    gain: f64,
    lag: f64,
    sag: f64,
    torques: [f64; N],
    /// Electrical power drawn in the last step, W.
    power: f64,
    resistance: f64,
    torque_constant: f64,
}

impl<const N: usize> Motors<N> {
    /// At rest.
    #[must_use]
    pub fn new(
        disturbance: &Disturbance,
        motors: [Motor<f64>; N],
        budgets: &rbd_core::Budgets,
    ) -> Self {
        Self {
            motors,
            gain: disturbance.get(Key::TorqueGain),
            lag: disturbance.seconds(Key::CurrentLag),
            sag: disturbance.get(Key::Sag),
            torques: [0.0; N],
            power: 0.0,
            resistance: budgets.resistance,
            torque_constant: budgets.torque_constant,
        }
    }

    /// Torques at the joints for the next `dt` seconds, N m.
    pub fn give(&mut self, asked: &[f64; N], speeds: &[f64; N], dt: f64) -> [f64; N] {
        let share = if self.lag > 0.0 {
            1.0 - so3::math::exp(-dt / self.lag)
        } else {
            1.0
        };
        let lost = self.sag * (self.power / FULL_POWER).clamp(0.0, 1.0);
        let joints = self
            .torques
            .iter_mut()
            .zip(asked)
            .zip(speeds)
            .zip(&self.motors);
        for (((torque, asked), speed), motor) in joints {
            *torque += share * (asked - *torque);
            let faster = speed + speed.signum() * lost * motor.no_load_speed;
            let [low, high] = motor.torque_range(faster);
            *torque = torque.clamp(low, high);
        }
        self.power = self.electrical_power(speeds);
        self.torques.map(|torque| self.gain * torque)
    }

    /// What the motor boards believe to give: their current times the torque constant of the data sheet, N m.
    #[must_use]
    pub const fn measured(&self) -> &[f64; N] {
        &self.torques
    }

    /// Power of the supply, W: motion and copper losses of all joints; what comes back is not counted.
    #[must_use]
    pub const fn power(&self) -> f64 {
        self.power
    }

    fn electrical_power(&self, speeds: &[f64; N]) -> f64 {
        let each = self.torques.iter().zip(speeds).zip(&self.motors);
        let all = each.map(|((torque, speed), motor)| {
            torque * speed + copper_loss(*torque, motor.gear, self.torque_constant, self.resistance)
        });
        all.sum::<f64>().max(0.0)
    }
}

/// Heat in a winding, W: I² R with I = τ/(n k).
#[must_use]
pub fn copper_loss(torque: f64, gear: f64, torque_constant: f64, resistance: f64) -> f64 {
    let current = torque / (gear * torque_constant);
    current * current * resistance
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::Motors;
    use crate::lab::{Disturbance, Lab, PlantArgument};
    use a1_model::{BUDGETS, MOTORS};

    fn motors(text: &str) -> Motors<12> {
        let disturbance = PlantArgument::plant(Some(&text.parse().unwrap()), Lab::A1, 0);
        Motors::new(&disturbance, MOTORS, &BUDGETS)
    }

    #[test]
    fn nominal_motors_give_what_is_asked() {
        let asked = core::array::from_fn(|i| 5.0 * (i as f64 - 6.0));
        let mut motors = Motors::new(&Disturbance::NOMINAL, MOTORS, &BUDGETS);
        assert_eq!(motors.give(&asked, &[0.0; 12], 1e-4), asked);
    }

    /// A first-order lag is at 1 − 1/e after its time constant, and a gain multiplies what is felt at the joint only.
    #[test]
    fn lag_and_gain() {
        let mut motors = motors("current_lag_ms=1,torque_gain=0.9");
        let mut given = [0.0; 12];
        for _ in 0..10 {
            given = motors.give(&[10.0; 12], &[0.0; 12], 1e-4);
        }
        let share = 1.0 - so3::math::exp(-1.0);
        assert!((motors.measured()[0] - 10.0 * share).abs() < 1e-12);
        assert!((given[0] - 9.0 * share).abs() < 1e-12);
    }

    /// With a tenth of the voltage gone a motor at its corner speed has no longer all of its torque.
    #[test]
    fn a_sagging_supply_takes_torque_at_speed() {
        let speeds = [MOTORS[0].corner_speed; 12];
        let asked = [MOTORS[0].torque; 12];
        let mut full = motors("");
        let mut sagging = motors("sag=0.1");
        for _ in 0..5 {
            full.give(&asked, &speeds, 1e-4);
            sagging.give(&asked, &speeds, 1e-4);
        }
        assert_eq!(full.measured()[0], MOTORS[0].torque);
        let motor = MOTORS[0];
        let slope = motor.torque / (motor.no_load_speed - motor.corner_speed);
        let wanted = motor.torque - 0.1 * motor.no_load_speed * slope;
        assert!(
            (sagging.measured()[0] - wanted).abs() < 1e-9,
            "{}",
            sagging.measured()[0]
        );
    }
}
