//! What the controller is told: the truth in a nominal run; otherwise late and noisy sensors, and the base as
//! `state-est` makes it out of them.

use super::plant::{Disturbance, Plant};
use super::{FOOT_COUNT, JOINTS, ROBOT, State, Velocity, feet};
use crate::noise::Noise;
use crate::observer::{Legs, Observer};
use a1_model::FOOT_RADIUS;
use jump_control::Measurement;
use state_est::{Foot, Status};
use std::collections::VecDeque;

/// What arrives at 1 kHz.
pub(crate) type Told = jump_machine::Inputs<f64, JOINTS, FOOT_COUNT>;

/// Force at which a foot is certainly loaded, N.
const LOADED: f64 = 15.0;
/// Time between two measurements, s.
const PERIOD: f64 = 1e-3;

/// The sensors of one run.
pub(crate) struct Sensors {
    disturbance: Disturbance,
    noise: Noise,
    observer: Option<Observer<JOINTS, FOOT_COUNT, 6>>,
    waiting: VecDeque<Told>,
    /// Largest error of the base's place and of its tilt and heading since the start: m, rad.
    pub(crate) worst: [f64; 2],
}

impl Sensors {
    pub(crate) fn new(disturbance: &Disturbance, seed: u64, start: &State) -> Self {
        let mut noise = Noise::new(seed.wrapping_add(0x5eed), 1.0);
        let observer = disturbance.imu.map(|imu| {
            let feet = feet().map(|frame| Foot {
                frame,
                radius: FOOT_RADIUS,
            });
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

    /// What arrives in this millisecond, given the torques since the last one.
    pub(crate) fn measure(&mut self, plant: &Plant, felt: &[f64; JOINTS]) -> Told {
        let (joints, joint_velocities) = self.encoders(plant);
        let forces = plant.contact_forces_w();
        let mut measured = Measurement {
            base: plant.configuration().base,
            base_velocity: plant.velocity().base,
            joints,
            joint_velocities,
            foot_forces: core::array::from_fn(|i| forces[i].norm()),
            age: 0.0,
        };
        self.estimate(plant.configuration(), plant.velocity(), &mut measured);
        self.waiting.push_back(Told {
            measured,
            felt: *felt,
        });
        while self.waiting.len() > self.disturbance.latency_ms + 1 {
            self.waiting.pop_front();
        }
        let late = (self.waiting.len() - 1) as f64 * PERIOD;
        let mut told = self.waiting[0];
        told.measured.age += late;
        told
    }

    /// Puts the estimate of the base in the place of the truth.
    fn estimate(
        &mut self,
        q: &State,
        v: &Velocity,
        told: &mut Measurement<f64, JOINTS, FOOT_COUNT>,
    ) {
        let Some(observer) = &mut self.observer else {
            return;
        };
        let legs = Legs {
            joints: told.joints,
            joint_velocities: told.joint_velocities,
            evidence: told.foot_forces.map(|f| (f / LOADED).min(1.0)),
        };
        let estimate = observer.step(&ROBOT, q, v, &legs, &mut self.noise);
        told.base = estimate.base;
        told.base_velocity = estimate.velocity;
        if estimate.status == Status::Lost {
            told.age = f64::INFINITY;
        }
        let turn = so3::log(&(told.base.rotation * q.base.rotation.inverse()));
        let place = (told.base.translation - q.base.translation).norm();
        self.worst = [self.worst[0].max(place), self.worst[1].max(turn.norm())];
    }
}
