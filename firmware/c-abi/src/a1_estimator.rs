//! A1: where its base is, from an IMU and the legs.

use core::ffi::c_void;

use a1_model::{A1Geared, FEET};

use crate::Status;
use crate::estimator::{self, BaseEstimator, Estimate, Sample, Start};
use crate::memory::{align, size};

type Kept = BaseEstimator<12, 4, 6>;

/// Bytes of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_size() -> usize {
    size::<Kept>()
}

/// Alignment of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_align() -> usize {
    align::<Kept>()
}

/// Initialises an estimator in a block, of a robot that stands still in a known place; `version` is `SALTUS_VERSION`. Before a jump it may be
/// initialised anew where the plan begins, so that what it has drifted is forgotten.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    start: *const Start<12>,
) -> Status {
    estimator::init::<_, 12, 4, 6>((&A1Geared, &FEET), (memory, bytes, version), start)
}

/// One step of `dt` s, for 1 kHz; `sample` is null if none arrived. What is wrong with a sample, the estimate says.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_estimator_update(
    memory: *mut c_void,
    sample: *const Sample<12, 4>,
    dt: f64,
    estimate: *mut Estimate<4>,
) -> Status {
    estimator::update::<_, 12, 4, 6>(&A1Geared, memory, sample, dt, estimate)
}
