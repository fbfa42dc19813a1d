//! Robots in any attitude, their feet, and what an ideal sensor says of them.

use a1_model::{A1, FEET};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use rbd_core::{Configuration, Frame, Kinematics, Posture, Transform, forward_kinematics};
use state_est::{Estimate, Estimator, Foot, Sample, Settings, State};

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub(crate) fn config(cases: u32, seed: u64) -> Config {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

pub(crate) fn rotation() -> impl Strategy<Value = Rotation3<f64>> {
    vector(2.0).prop_map(|x| so3::exp(&x))
}

/// A robot in the world and how it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    pub(crate) q: Configuration<f64, 12>,
    pub(crate) joint_velocities: [f64; 12],
    /// Angular velocity of the base, base axes.
    pub(crate) omega_b: Vector3<f64>,
    /// Pose of the IMU in the base.
    pub(crate) imu: Transform<f64>,
}

pub(crate) fn world() -> impl Strategy<Value = World> {
    let pose = || (rotation(), vector(0.5)).prop_map(|(r, p)| Transform::new(r, p));
    let joints = || prop::array::uniform12(-1.0..1.0_f64);
    (pose(), joints(), joints(), vector(3.0), pose()).prop_map(
        |(base, joints, joint_velocities, omega_b, imu)| World {
            q: Configuration { base, joints },
            joint_velocities,
            omega_b,
            imu,
        },
    )
}

impl World {
    /// The crouched robot on level ground, still, with its IMU at the base's origin.
    pub(crate) fn crouched() -> Self {
        let mut q = Configuration::<f64, 12>::NEUTRAL;
        q.joints = core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3]);
        Self {
            q,
            joint_velocities: [0.0; 12],
            omega_b: Vector3::zeros(),
            imu: Transform::IDENTITY,
        }
    }

    pub(crate) fn estimator<const F: usize, const S: usize>(
        &self,
        feet: [Foot<f64>; F],
        settings: Settings<f64>,
    ) -> Estimator<f64, 12, F, S> {
        Estimator {
            feet,
            imu: self.imu,
            settings,
        }
    }

    /// What the sensors say while the base feels `force_b`, base axes.
    pub(crate) fn sample<const F: usize>(
        &self,
        force_b: &Vector3<f64>,
        evidence: [f64; F],
    ) -> Sample<f64, 12, F> {
        let to_imu = self.imu.rotation.inverse();
        Sample {
            specific_force_i: to_imu * force_b,
            angular_velocity_i: to_imu * self.omega_b,
            joints: self.q.joints,
            joint_velocities: self.joint_velocities,
            evidence,
        }
    }

    /// The force that holds the robot still against gravity, base axes.
    pub(crate) fn held(&self) -> Vector3<f64> {
        self.q.base.rotation.inverse() * Vector3::new(0.0, 0.0, 9.81)
    }

    pub(crate) fn pose_of(&self, frame: &Frame<f64>) -> Transform<f64> {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&A1, &Posture::new(&A1, &self.q), &mut kinematics);
        kinematics.frame(frame)
    }

    /// From the IMU's point to a foot, world axes.
    pub(crate) fn arm_w(&self, foot: &Foot<f64>) -> Vector3<f64> {
        self.pose_of(&foot.frame).translation - self.q.base.point(&self.imu.translation)
    }

    /// The robot after `dt`, if its base's origin has the velocity `vel_b`, base axes, and everything else goes on as it does.
    pub(crate) fn after(&self, vel_b: &Vector3<f64>, dt: f64) -> Self {
        let mut next = *self;
        next.q.base.translation += self.q.base.rotation * vel_b * dt;
        next.q.base.rotation *= so3::exp(&(self.omega_b * dt));
        for (q, qd) in next.q.joints.iter_mut().zip(&self.joint_velocities) {
            *q += qd * dt;
        }
        next
    }

    /// The first estimate of one that believes a single foot, and only this foot.
    pub(crate) fn by_foot(&self, foot: Foot<f64>) -> Estimate<f64, 1> {
        let mut settings = Settings::new();
        settings.foot_speed = 1e-9;
        settings.agreement = 0.0;
        let estimator = self.estimator::<1, 3>([foot], settings);
        let mut state = State::new(&estimator, &A1, &self.q);
        let sample = self.sample(&self.held(), [1.0]);
        estimator.step(&A1, &mut state, Some(&sample), 1e-9)
    }

    /// Velocity of the IMU's point, world axes, with which this foot stands.
    pub(crate) fn velocity_by(&self, foot: Foot<f64>) -> Vector3<f64> {
        let velocity = self.by_foot(foot).velocity;
        self.q.base.rotation * velocity.at_point(&self.imu.translation)
    }
}

/// A1's feet.
pub(crate) fn feet() -> [Foot<f64>; 4] {
    FEET.map(|foot| Foot::of(&foot))
}
