//! What benches beside peers share: states, the clock, the median.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rbd_core::{Configuration, Effort, Force, Motion, Posture, Tangent, Transform, Tree};
use rustix::time::{ClockId, clock_gettime};

use crate::golden::Golden;

/// One random state of a robot with `N` joints, as a caller has it: with a quaternion.
#[derive(Clone, Copy, Debug)]
pub struct State<const N: usize> {
    /// Position of the base in the world, m.
    pub position: Vector3<f64>,
    /// Orientation of the base.
    pub quat_wb: UnitQuaternion<f64>,
    /// Joint positions, rad.
    pub joints: [f64; N],
    /// Velocity.
    pub velocity: Tangent<f64, N>,
    /// Acceleration.
    pub acceleration: Tangent<f64, N>,
    /// Effort.
    pub effort: Effort<f64, N>,
}

impl<const N: usize> State<N> {
    /// From configuration, velocity, acceleration and effort, one after the other.
    fn from_numbers(x: &[f64]) -> Option<Self> {
        let (q, rest) = x.split_at_checked(7 + N)?;
        let (v, rest) = rest.split_at_checked(6 + N)?;
        let (a, tau) = rest.split_at_checked(6 + N)?;
        let tangent = |x: &[f64]| {
            Some(Tangent {
                base: Motion::from_array(x.get(..6)?.try_into().ok()?),
                joints: x.get(6..)?.try_into().ok()?,
            })
        };
        let tau: Tangent<f64, N> = tangent(tau)?;
        Some(Self {
            position: Vector3::new(q[0], q[1], q[2]),
            quat_wb: UnitQuaternion::new_unchecked(Quaternion::new(q[6], q[3], q[4], q[5])),
            joints: q[7..].try_into().ok()?,
            velocity: tangent(v)?,
            acceleration: tangent(a)?,
            effort: Effort {
                base: Force::from_array(tau.base.to_array()),
                joints: tau.joints,
            },
        })
    }

    /// The states that `tests/peers/dump_models.py` wrote for every peer.
    ///
    /// # Errors
    /// If the file is missing or malformed.
    pub fn read(path: &Path) -> Result<Vec<Self>, String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let state = |line: &str| {
            let numbers: Result<Vec<f64>, _> = line.split(' ').map(str::parse).collect();
            Self::from_numbers(&numbers.ok()?)
        };
        text.lines()
            .skip(1)
            .map(|line| state(line).ok_or_else(|| format!("{}: malformed", path.display())))
            .collect()
    }

    /// The states of a golden file of this repository.
    #[must_use]
    pub fn golden(robot: &str) -> Vec<Self> {
        let keys = ["q", "v", "a", "tau"];
        let golden = Golden::load(robot);
        let numbers = golden
            .states
            .iter()
            .map(|s| keys.map(|key| s.values(key)).concat());
        numbers.filter_map(|x| Self::from_numbers(&x)).collect()
    }

    /// The configuration, with the quaternion turned into a matrix.
    #[inline(always)]
    #[must_use]
    pub fn configuration(&self) -> Configuration<f64, N> {
        let base = Transform::new(self.quat_wb.to_rotation_matrix(), self.position);
        Configuration {
            base,
            joints: self.joints,
        }
    }

    /// The posture: what every algorithm starts from, sines and cosines included.
    #[inline(always)]
    #[must_use]
    pub fn posture<M: Tree<f64, N>>(&self, model: &M) -> Posture<f64, N> {
        Posture::new(model, &self.configuration())
    }
}

/// CPU time of this thread in ns: a preempted batch on a shared machine is not charged.
#[must_use]
pub fn thread_time() -> f64 {
    let t = clock_gettime(ClockId::ThreadCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

/// Calls `call(i)` for every state, batch after batch for `ms` of CPU time; the median ns per call.
pub fn time(states: usize, ms: f64, call: &mut dyn FnMut(usize)) -> f64 {
    let mut batch = || {
        let start = thread_time();
        (0..states).for_each(&mut *call);
        (thread_time() - start) / states as f64
    };
    batch();
    let end = thread_time() + ms * 1e6;
    let mut times = Vec::new();
    while times.len() < 5 || thread_time() < end {
        times.push(batch());
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
