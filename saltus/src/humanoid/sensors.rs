//! What the controller is told: the truth in a nominal run; otherwise late and noisy encoders, and the base as `state-est`
//! makes it out of them and an IMU.

use super::{JOINTS, Plant, ROBOT, State, Velocity};
use crate::jump::plant::Disturbance;
use crate::noise::Noise;
use crate::observer::{Legs, Observer};
use icub_model::SOLES;
use nalgebra::Vector3;
use state_est::Foot;
use std::collections::VecDeque;

/// Force at which a sole is certainly loaded, N.
const LOADED: f64 = 40.0;

/// What arrives in one millisecond.
#[derive(Clone, Copy)]
pub(crate) struct Told {
    pub(crate) q: State,
    pub(crate) v: Velocity,
    /// Force on each sole, N.
    pub(crate) forces: [f64; 2],
}

/// The sensors of one run.
pub(crate) struct Sensors {
    disturbance: Disturbance,
    noise: Noise,
    observer: Option<Observer<JOINTS, 2, 4>>,
    waiting: VecDeque<Told>,
    /// Largest error of the base's place and of its orientation since the start: m, rad.
    pub(crate) worst: [f64; 2],
}

impl Sensors {
    pub(crate) fn new(disturbance: &Disturbance, seed: u64, start: &State) -> Self {
        let mut noise = Noise::new(seed, 1.0);
        let observer = disturbance.imu.map(|imu| {
            let feet = SOLES.map(|sole| Foot::of(&sole));
            Observer::new(&ROBOT, feet, imu, start, &mut noise)
        });
        Self {
            disturbance: *disturbance,
            noise,
            observer,
            waiting: VecDeque::new(),
            worst: [0.0; 2],
        }
    }

    /// Joint positions and speeds as the encoders say now.
    pub(crate) fn encoders(&mut self, plant: &Plant) -> ([f64; JOINTS], [f64; JOINTS]) {
        let (q, v) = (plant.configuration().joints, plant.velocity().joints);
        self.disturbance.encode(q, v, &mut self.noise)
    }

    /// What arrives in this millisecond.
    pub(crate) fn measure(&mut self, plant: &Plant) -> Told {
        let (mut q, mut v) = (*plant.configuration(), *plant.velocity());
        let forces = sole_forces(plant).map(|f| f.norm());
        let (joints, joint_velocities) = self.encoders(plant);
        if let Some(observer) = &mut self.observer {
            let legs = Legs {
                joints,
                joint_velocities,
                evidence: forces.map(|f| (f / LOADED).min(1.0)),
            };
            let estimate = observer.step(&ROBOT, &q, &v, &legs, &mut self.noise);
            let turn = so3::log(&(estimate.base.rotation * q.base.rotation.inverse()));
            let place = (estimate.base.translation - q.base.translation).norm();
            self.worst = [self.worst[0].max(place), self.worst[1].max(turn.norm())];
            q.base = estimate.base;
            v.base = estimate.velocity;
        }
        (q.joints, v.joints) = (joints, joint_velocities);
        self.waiting.push_back(Told { q, v, forces });
        while self.waiting.len() > self.disturbance.latency_ms + 1 {
            self.waiting.pop_front();
        }
        self.waiting[0]
    }
}

/// Force of the ground on each sole.
pub(crate) fn sole_forces(plant: &Plant) -> [Vector3<f64>; 2] {
    let f = plant.contact_forces_w();
    [f[..4].iter().sum(), f[4..].iter().sum()]
}
