//! What the controller is told: the truth in a nominal run; otherwise late and noisy sensors, and the base as
//! `state-est` makes it out of them.

use super::plant::{Disturbance, Plant};
use super::{FOOT_COUNT, JOINTS, ROBOT, State, Velocity, feet};
use crate::noise::Noise;
use a1_model::FOOT_RADIUS;
use jump_control::Measurement;
use nalgebra::Vector3;
use rbd_core::{GRAVITY, Transform};
use state_est::{Estimator, Foot, Sample, Settings, Status};
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
    observer: Option<Observer>,
    waiting: VecDeque<Told>,
    /// Largest error of the base's place and of its tilt and heading since the start: m, rad.
    pub(crate) worst: [f64; 2],
}

/// An IMU at the base's origin with the estimator behind it.
struct Observer {
    estimator: Estimator<f64, JOINTS, FOOT_COUNT, 6>,
    state: state_est::State<f64, FOOT_COUNT, 6>,
    /// Velocity of the base at the last sample, world axes.
    last_w: Vector3<f64>,
    gyroscope_bias: Vector3<f64>,
    accelerometer_bias: Vector3<f64>,
}

impl Sensors {
    pub(crate) fn new(disturbance: &Disturbance, seed: u64, start: &State) -> Self {
        let mut noise = Noise::new(seed.wrapping_add(0x5eed), 1.0);
        let mut vector = |deviation: f64| Vector3::from_fn(|_, _| deviation * noise.sample());
        let observer = disturbance.imu.map(|imu| {
            let estimator = Estimator {
                feet: feet().map(|frame| Foot {
                    frame,
                    radius: FOOT_RADIUS,
                }),
                imu: Transform::IDENTITY,
                settings: Settings::new(),
            };
            Observer {
                state: state_est::State::new(&estimator, &ROBOT, start),
                estimator,
                last_w: Vector3::zeros(),
                gyroscope_bias: vector(imu.gyroscope_bias),
                accelerometer_bias: vector(imu.accelerometer_bias),
            }
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
        let (Some(observer), Some(imu)) = (&mut self.observer, self.disturbance.imu) else {
            return;
        };
        let noise = &mut self.noise;
        let mut vector = |deviation: f64| Vector3::from_fn(|_, _| deviation * noise.sample());
        let now_w = q.base.rotation * v.base.linear;
        let felt_w = (now_w - observer.last_w) / PERIOD - Vector3::from(GRAVITY);
        observer.last_w = now_w;
        let sample = Sample {
            specific_force_i: q.base.rotation.inverse() * felt_w
                + observer.accelerometer_bias
                + vector(imu.accelerometer),
            angular_velocity_i: v.base.angular + observer.gyroscope_bias + vector(imu.gyroscope),
            joints: told.joints,
            joint_velocities: told.joint_velocities,
            evidence: told.foot_forces.map(|f| (f / LOADED).min(1.0)),
        };
        let estimate = observer
            .estimator
            .step(&ROBOT, &mut observer.state, Some(&sample), PERIOD);
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
