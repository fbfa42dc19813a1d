//! What the controller is told: late and noisy.

use super::plant::{Disturbance, Plant};
use super::{FOOT_COUNT, JOINTS};
use crate::noise::Noise;
use jump_control::Measurement;
use std::collections::VecDeque;

/// The sensors of one run.
pub(crate) struct Sensors {
    disturbance: Disturbance,
    noise: Noise,
    waiting: VecDeque<Measurement<f64, JOINTS, FOOT_COUNT>>,
}

impl Sensors {
    pub(crate) fn new(disturbance: &Disturbance, seed: u64) -> Self {
        Self {
            disturbance: *disturbance,
            noise: Noise::new(seed.wrapping_add(0x5eed), 1.0),
            waiting: VecDeque::new(),
        }
    }

    /// Joint positions and speeds as the encoders say now.
    pub(crate) fn encoders(&mut self, plant: &Plant) -> ([f64; JOINTS], [f64; JOINTS]) {
        let (mut q, mut v) = (plant.configuration().joints, plant.velocity().joints);
        let (dq, dv) = self.disturbance.encoder;
        if dq > 0.0 || dv > 0.0 {
            for (q, v) in q.iter_mut().zip(&mut v) {
                *q += dq * self.noise.sample();
                *v += dv * self.noise.sample();
            }
        }
        (q, v)
    }

    /// The measurement that arrives in this millisecond: the base as it was, the joints as the encoders saw them.
    pub(crate) fn measure(&mut self, plant: &Plant) -> Measurement<f64, JOINTS, FOOT_COUNT> {
        let (joints, joint_velocities) = self.encoders(plant);
        let forces = plant.contact_forces_w();
        self.waiting.push_back(Measurement {
            base: plant.configuration().base,
            base_velocity: plant.velocity().base,
            joints,
            joint_velocities,
            foot_forces: core::array::from_fn(|i| forces[i].norm()),
            age: 0.0,
        });
        while self.waiting.len() > self.disturbance.latency_ms + 1 {
            self.waiting.pop_front();
        }
        let age = (self.waiting.len() - 1) as f64 * 1e-3;
        Measurement {
            age,
            ..self.waiting[0]
        }
    }
}
