//! An IMU at the base's origin, and what `state-est` makes of it and of the legs.

use crate::lab::{Disturbance, Key};
use crate::noise::Noise;
use nalgebra::Vector3;
use rbd_core::{Configuration, GRAVITY, Tangent, Transform, Tree};
use state_est::{Estimate, Estimator, Foot, Sample, Settings, State};

/// Time between two samples, s.
const PERIOD: f64 = 1e-3;

/// Bias of a gyroscope over that of an accelerometer, rad/s per m/s².
const GYROSCOPE_BIAS: f64 = 0.2;

/// An IMU at the base's origin.
pub(crate) struct Imu {
    /// Standard deviations of a gyroscope's and an accelerometer's sample: rad/s, m/s².
    deviations: [f64; 2],
    /// Velocity of the base at the last sample, world axes.
    last_w: Vector3<f64>,
    gyroscope_bias: Vector3<f64>,
    accelerometer_bias: Vector3<f64>,
}

impl Imu {
    /// On a base that moves so, world axes; draws the biases.
    pub(crate) fn new(disturbance: &Disturbance, now_w: Vector3<f64>, noise: &mut Noise) -> Self {
        Self {
            deviations: [Key::GyroNoise, Key::AccelerometerNoise].map(|key| disturbance.get(key)),
            last_w: now_w,
            gyroscope_bias: vector(noise, GYROSCOPE_BIAS * disturbance.get(Key::ImuBias)),
            accelerometer_bias: vector(noise, disturbance.get(Key::ImuBias)),
        }
    }

    /// Accelerometer's mean over the `period` since the last sample, m/s², and gyroscope, rad/s, of the true motion, with noise.
    pub(crate) fn sample<const N: usize>(
        &mut self,
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
        period: f64,
        noise: &mut Noise,
    ) -> [Vector3<f64>; 2] {
        let now_w = q.base.rotation * v.base.linear;
        let felt_w = (now_w - self.last_w) / period - Vector3::from(GRAVITY);
        self.last_w = now_w;
        let specific_force = q.base.rotation.inverse() * felt_w
            + self.accelerometer_bias
            + vector(noise, self.deviations[1]);
        let angular_velocity =
            v.base.angular + self.gyroscope_bias + vector(noise, self.deviations[0]);
        [specific_force, angular_velocity]
    }
}

/// The IMU with the estimator behind it; `S` is F + 2.
pub(super) struct Observer<const N: usize, const F: usize, const S: usize> {
    estimator: Estimator<f64, N, F, S>,
    state: State<f64, F, S>,
    imu: Imu,
}

/// What the sensors of joints and feet say with an IMU's sample.
pub(super) struct Legs<const N: usize, const F: usize> {
    pub(super) joints: [f64; N],
    pub(super) joint_velocities: [f64; N],
    /// How certainly each foot is loaded, 0 to 1.
    pub(super) evidence: [f64; F],
}

impl<const N: usize, const F: usize, const S: usize> Observer<N, F, S> {
    /// In a known place, moving as is known; draws the biases.
    pub(super) fn new<M: Tree<f64, N>>(
        model: &M,
        feet: [Foot<f64>; F],
        disturbance: &Disturbance,
        (start, moving): (&Configuration<f64, N>, &Tangent<f64, N>),
        noise: &mut Noise,
    ) -> Self {
        let estimator = Estimator {
            feet,
            imu: Transform::IDENTITY,
            settings: Settings::new(),
        };
        let last_w = start.base.rotation * moving.base.linear;
        Self {
            state: State::new(&estimator, model, start).moving(last_w),
            estimator,
            imu: Imu::new(disturbance, last_w, noise),
        }
    }

    /// As [`State::stand_at`].
    pub(super) fn stand_at(&mut self, middle_w: &Vector3<f64>, heading: f64) -> bool {
        self.state.stand_at(middle_w, heading)
    }

    /// As [`State::feet`].
    pub(super) fn feet(&self) -> Option<[Vector3<f64>; F]> {
        self.state.feet()
    }

    /// One millisecond: samples the true motion with noise and estimates.
    pub(super) fn step<M: Tree<f64, N>>(
        &mut self,
        model: &M,
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
        legs: &Legs<N, F>,
        noise: &mut Noise,
    ) -> Estimate<f64, F> {
        let [specific_force_i, angular_velocity_i] = self.imu.sample(q, v, PERIOD, noise);
        let sample = Sample {
            specific_force_i,
            angular_velocity_i,
            joints: legs.joints,
            joint_velocities: legs.joint_velocities,
            evidence: legs.evidence,
        };
        self.estimator
            .step(model, &mut self.state, Some(&sample), PERIOD)
    }
}

fn vector(noise: &mut Noise, deviation: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| deviation * noise.sample())
}
