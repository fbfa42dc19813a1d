//! Where the base of any robot is, from an IMU and the legs: what its files, such as `a1_estimator`, have in common.

use core::ffi::c_void;

use nalgebra::Vector3;
use rbd_core::{Configuration, Contact, Tree};
use state_est::{Estimator, Foot, Settings, Status as Freshness};

use crate::Status;
use crate::codes::{EstimateStatus, SampleFault, sample_fault};
use crate::memory::{Resident, input, optional, place, resident, result, status};
use crate::state::{pose, xyzw};

/// Where the robot stands still when the estimator begins, and where its IMU is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<const N: usize> {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Orientation of the base: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Joint positions, rad.
    pub joints: [f64; N],
    /// Position of the IMU in the base, m.
    pub imu_position_b: [f64; 3],
    /// Orientation of the IMU in the base: a unit quaternion x, y, z, w that takes IMU axes to base axes.
    pub imu_orientation_bi: [f64; 4],
}

/// What the sensors say every millisecond.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const N: usize, const F: usize> {
    /// Accelerometer: acceleration minus gravity, IMU axes, m/s²; at rest it points up.
    pub specific_force_i: [f64; 3],
    /// Gyroscope, IMU axes, rad/s.
    pub angular_velocity_i: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; N],
    /// How certainly each foot stands, 0 to 1: its force over 15 N of A1, over 40 N of iCub, for one.
    pub evidence: [f64; F],
}

/// Where the base is; always finite. The first four go into an observation of the machine as they are.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const F: usize> {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Orientation of the base: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// How sure it is that each foot stands on the ground, 0 to 1.
    pub confidence: [f64; F],
    /// Whether it may be acted on; what is lost makes an observation of infinite age.
    pub status: EstimateStatus,
    /// The first thing that was wrong with the sample.
    pub fault: SampleFault,
    /// Its joint or foot.
    pub fault_index: u32,
}

/// The estimator of a robot with N joints and F feet; its filter has S = F + 2 states: the IMU's position and velocity, and the feet.
pub(crate) struct BaseEstimator<const N: usize, const F: usize, const S: usize> {
    estimator: Estimator<f64, N, F, S>,
    state: state_est::State<f64, F, S>,
}

impl<const N: usize, const F: usize, const S: usize> Resident for BaseEstimator<N, F, S> {
    const KIND: u64 = 0x6573_7469_0000 | (N << 8 | F) as u64;
    type Lent = ();
}

impl<const F: usize> Estimate<F> {
    /// Of an estimator that cannot be reached.
    const UNKNOWN: Self = Self {
        position_w: [0.0; 3],
        orientation_wb: [0.0, 0.0, 0.0, 1.0],
        linear_velocity_b: [0.0; 3],
        angular_velocity_b: [0.0; 3],
        confidence: [0.0; F],
        status: EstimateStatus::Lost,
        fault: SampleFault::Missing,
        fault_index: 0,
    };
}

/// Initialises the estimator of a robot with these feet in a block.
pub(crate) fn init<M: Tree<f64, N>, const N: usize, const F: usize, const S: usize>(
    (model, feet): (&M, &[Contact<f64>; F]),
    (memory, bytes, version): (*mut c_void, usize, u32),
    start: *const Start<N>,
) -> Status {
    status((|| {
        let start = input(start)?;
        let joints = start.joints;
        let base = pose(&start.position_w, &start.orientation_wb).ok_or(Status::BadData)?;
        let imu = pose(&start.imu_position_b, &start.imu_orientation_bi).ok_or(Status::BadData)?;
        if !joints.iter().all(|x| x.is_finite()) {
            return Err(Status::BadData);
        }
        let fill = |&mut ()| {
            let estimator = Estimator {
                feet: feet.each_ref().map(Foot::of),
                imu,
                settings: Settings::new(),
            };
            let start = Configuration { base, joints };
            let state = state_est::State::new(&estimator, model, &start);
            BaseEstimator::<N, F, S> { estimator, state }
        };
        place(memory, bytes, version, || (), fill)
    })())
}

/// One step of the estimator in a block.
pub(crate) fn update<M: Tree<f64, N>, const N: usize, const F: usize, const S: usize>(
    model: &M,
    memory: *mut c_void,
    sample: *const Sample<N, F>,
    dt: f64,
    estimate: *mut Estimate<F>,
) -> Status {
    status((|| {
        let out = result(estimate)?.write(Estimate::UNKNOWN);
        let BaseEstimator::<N, F, S> { estimator, state } = resident(memory)?;
        let sample = optional(sample)?.map(|given| state_est::Sample {
            specific_force_i: Vector3::from(given.specific_force_i),
            angular_velocity_i: Vector3::from(given.angular_velocity_i),
            joints: given.joints,
            joint_velocities: given.joint_velocities,
            evidence: given.evidence,
        });
        let found = estimator.step(model, state, sample.as_ref(), dt);
        let (fault, fault_index) = sample_fault(found.fault);
        *out = Estimate {
            position_w: found.base.translation.into(),
            orientation_wb: xyzw(&found.base.rotation),
            linear_velocity_b: found.velocity.linear.into(),
            angular_velocity_b: found.velocity.angular.into(),
            confidence: found.confidence,
            status: match found.status {
                Freshness::Good => EstimateStatus::Good,
                Freshness::Coasting => EstimateStatus::Coasting,
                Freshness::Lost => EstimateStatus::Lost,
            },
            fault,
            fault_index,
        };
        Ok(())
    })())
}
