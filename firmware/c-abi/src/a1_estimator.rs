//! A1: where its base is, from an IMU and the legs.

use core::ffi::c_void;

use a1_model::{A1Geared, FEET};
use nalgebra::Vector3;
use rbd_core::Configuration;
use state_est::{Estimator, Foot, Sample, Settings, State, Status as Freshness};

use crate::Status;
use crate::codes::{EstimateStatus, SampleFault, sample_fault};
use crate::memory::{Resident, align, input, optional, place, resident, result, size, status};
use crate::state::{pose, xyzw};

const N: usize = 12;
const F: usize = 4;
/// States of the estimator's filter: the IMU's position and velocity, and the feet.
const S: usize = F + 2;

/// Where the robot stands still when the estimator begins, and where its IMU is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Start {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Orientation of the base: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Joint positions, rad.
    pub joints: [f64; 12],
    /// Position of the IMU in the base, m.
    pub imu_position_b: [f64; 3],
    /// Orientation of the IMU in the base: a unit quaternion x, y, z, w that takes IMU axes to base axes.
    pub imu_orientation_bi: [f64; 4],
}

/// What the sensors say every millisecond.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Sample {
    /// Accelerometer: acceleration minus gravity, IMU axes, m/s²; at rest it points up.
    pub specific_force_i: [f64; 3],
    /// Gyroscope, IMU axes, rad/s.
    pub angular_velocity_i: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; 12],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; 12],
    /// How certainly each foot stands, 0 to 1: its force over 15 N, for one.
    pub evidence: [f64; 4],
}

/// Where the base is; always finite. The first four go into an observation of the machine as they are.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Estimate {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Orientation of the base: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// How sure it is that each foot stands on the ground, 0 to 1.
    pub confidence: [f64; 4],
    /// Whether it may be acted on; what is lost makes an observation of infinite age.
    pub status: EstimateStatus,
    /// The first thing that was wrong with the sample.
    pub fault: SampleFault,
    /// Its joint or foot.
    pub fault_index: u32,
}

struct A1Estimator {
    estimator: Estimator<f64, N, F, S>,
    state: State<f64, F, S>,
}

impl Resident for A1Estimator {
    const KIND: u64 = 0x6131_6573_7469;
    type Lent = ();
}

impl A1Estimate {
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

/// Bytes of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_size() -> usize {
    size::<A1Estimator>()
}

/// Alignment of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_align() -> usize {
    align::<A1Estimator>()
}

/// Initialises an estimator in a block, of a robot that stands still in a known place; `version` is `SALTUS_VERSION`. Before a jump it may be
/// initialised anew where the plan begins, so that what it has drifted is forgotten.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    start: *const A1Start,
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
                feet: FEET.each_ref().map(Foot::of),
                imu,
                settings: Settings::new(),
            };
            let state = State::new(&estimator, &A1Geared, &Configuration { base, joints });
            A1Estimator { estimator, state }
        };
        place(memory, bytes, version, || (), fill)
    })())
}

/// One step of `dt` s, for 1 kHz; `sample` is null if none arrived. What is wrong with a sample, the estimate says.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_update(
    memory: *mut c_void,
    sample: *const A1Sample,
    dt: f64,
    estimate: *mut A1Estimate,
) -> Status {
    status((|| {
        let out = result(estimate)?.write(A1Estimate::UNKNOWN);
        let A1Estimator { estimator, state } = resident(memory)?;
        let sample = optional(sample)?.map(|given| Sample {
            specific_force_i: Vector3::from(given.specific_force_i),
            angular_velocity_i: Vector3::from(given.angular_velocity_i),
            joints: given.joints,
            joint_velocities: given.joint_velocities,
            evidence: given.evidence,
        });
        let found = estimator.step(&A1Geared, state, sample.as_ref(), dt);
        let (fault, fault_index) = sample_fault(found.fault);
        *out = A1Estimate {
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
