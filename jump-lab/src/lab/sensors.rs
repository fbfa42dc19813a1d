//! Sensors of joints and feet, as wrong as the lab's.

use super::{Disturbance, Key};
use crate::noise::Noise;

/// Encoders of `N` joints.
pub struct Encoders<const N: usize> {
    offsets: [f64; N],
    /// Standard deviations of positions and speeds, rad and rad/s.
    deviations: [f64; 2],
}

impl<const N: usize> Encoders<N> {
    /// Draws the offsets.
    pub fn new(disturbance: &Disturbance, noise: &mut Noise) -> Self {
        let most = disturbance.get(Key::EncoderOffset);
        Self {
            offsets: core::array::from_fn(|_| within(most, noise)),
            deviations: [Key::EncoderNoise, Key::SpeedNoise].map(|key| disturbance.get(key)),
        }
    }

    /// Positions and speeds as they are told.
    pub fn read(&self, q: &[f64; N], v: &[f64; N], noise: &mut Noise) -> ([f64; N], [f64; N]) {
        let mut told = (*q, *v);
        for ((q, v), offset) in told.0.iter_mut().zip(&mut told.1).zip(&self.offsets) {
            *q += offset + self.deviations[0] * noise.sample();
            *v += self.deviations[1] * noise.sample();
        }
        told
    }
}

/// Force sensors of `F` feet.
pub struct FootSensors<const F: usize> {
    gain: f64,
    deviation: f64,
    biases: [f64; F],
}

impl<const F: usize> FootSensors<F> {
    /// Draws the biases.
    pub fn new(disturbance: &Disturbance, noise: &mut Noise) -> Self {
        let most = disturbance.get(Key::FootBias);
        Self {
            gain: disturbance.get(Key::FootGain),
            deviation: disturbance.get(Key::FootNoise),
            biases: core::array::from_fn(|_| within(most, noise)),
        }
    }

    /// Forces as they are told, N: never negative.
    pub fn read(&self, mut forces: [f64; F], noise: &mut Noise) -> [f64; F] {
        for (force, bias) in forces.iter_mut().zip(&self.biases) {
            let told = self.gain * *force + bias + self.deviation * noise.sample();
            *force = told.max(0.0);
        }
        forces
    }
}

/// Evenly from −most to most.
fn within(most: f64, noise: &mut Noise) -> f64 {
    most * (2.0 * noise.uniform() - 1.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Encoders, FootSensors};
    use crate::lab::{Disturbance, Lab, PlantArgument};
    use crate::noise::Noise;

    fn plant(text: &str) -> Disturbance {
        PlantArgument::plant(Some(&text.parse().unwrap()), Lab::A1, 0)
    }

    #[test]
    fn nominal_sensors_tell_the_truth() {
        let mut noise = Noise::new(1, 1.0);
        let (q, v) = ([0.1, -2.0], [3.0, 4.0]);
        let encoders = Encoders::new(&Disturbance::NOMINAL, &mut noise);
        assert_eq!(encoders.read(&q, &v, &mut noise), (q, v));
        let feet = FootSensors::new(&Disturbance::NOMINAL, &mut noise);
        assert_eq!(feet.read([30.0, 0.0], &mut noise), [30.0, 0.0]);
    }

    #[test]
    fn offsets_are_constant_and_gains_multiply() {
        let mut noise = Noise::new(1, 1.0);
        let encoders = Encoders::<2>::new(&plant("encoder_offset=0.01"), &mut noise);
        let (q, _) = encoders.read(&[0.0; 2], &[0.0; 2], &mut noise);
        assert!(q.iter().all(|q| *q != 0.0 && q.abs() <= 0.01) && q[0] != q[1]);
        assert_eq!(encoders.read(&[0.0; 2], &[0.0; 2], &mut noise).0, q);
        let feet = FootSensors::new(&plant("foot_gain=0.9"), &mut noise);
        assert_eq!(feet.read([100.0], &mut noise), [90.0]);
    }
}
