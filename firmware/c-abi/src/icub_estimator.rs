//! iCub: where its base is, from an IMU and the legs.

use core::ffi::c_void;

use icub_model::{Icub23GazeboGeared, SOLES};

use crate::Status;
use crate::estimator::{self, BaseEstimator, Estimate, Sample, Start};
use crate::memory::{align, size};

type Kept = BaseEstimator<23, 2, 4>;

/// Bytes of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_estimator_size() -> usize {
    size::<Kept>()
}

/// Alignment of the block of an estimator.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_estimator_align() -> usize {
    align::<Kept>()
}

/// Initialises an estimator in a block, of a robot that stands still in a known place; `version` is `SALTUS_VERSION`. Before a jump it may be
/// initialised anew where the jump begins, so that what it has drifted is forgotten.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_estimator_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    start: *const Start<23>,
) -> Status {
    estimator::init::<_, 23, 2, 4>(
        (&Icub23GazeboGeared, &SOLES),
        (memory, bytes, version),
        start,
    )
}

/// One step of `dt` s, for 1 kHz; `sample` is null if none arrived. What is wrong with a sample, the estimate says.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_estimator_update(
    memory: *mut c_void,
    sample: *const Sample<23, 2>,
    dt: f64,
    estimate: *mut Estimate<2>,
) -> Status {
    estimator::update::<_, 23, 2, 4>(&Icub23GazeboGeared, memory, sample, dt, estimate)
}
