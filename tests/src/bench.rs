//! What benches beside peers share: states, the clock, the median.

use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rbd_core::{
    Axes, BodyMotions, Configuration, ContactRow, ContactWorkspace, Effort, Force, Frame,
    FrameJacobian, Kinematics, MassFactors, MassMatrix, Motion, Posture, Tangent, Transform, Tree,
    bias_accelerations, crba, forward_kinematics, frame_jacobian,
};
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

/// What contact dynamics needs: every foot held, points if there are four, soles if there are two.
pub struct HeldFeet<const N: usize> {
    mass: MassMatrix<f64, N>,
    /// Factors of the mass matrix.
    pub factors: MassFactors<f64, N>,
    kinematics: Kinematics<f64, N>,
    bias: BodyMotions<f64, N>,
    jacobian: FrameJacobian<f64, N>,
    /// Rows of the feet.
    pub rows: [ContactRow<f64, N>; 12],
    /// How many rows count.
    pub count: usize,
    /// Scratch of the solver.
    pub workspace: ContactWorkspace<f64, N, 12>,
}

impl<const N: usize> HeldFeet<N> {
    /// Nothing prepared.
    #[must_use]
    pub fn new() -> Self {
        Self {
            mass: MassMatrix::ZERO,
            factors: MassFactors::new(),
            kinematics: Kinematics::IDENTITY,
            bias: BodyMotions::ZERO,
            jacobian: FrameJacobian::ZERO,
            rows: [ContactRow::ZERO; 12],
            count: 0,
            workspace: ContactWorkspace::new(),
        }
    }

    /// Factors of the mass matrix and the rows of the feet; without a velocity the rows have no bias.
    pub fn prepare<M: Tree<f64, N>>(
        &mut self,
        model: &M,
        posture: &Posture<f64, N>,
        feet: &[Frame<f64>],
        velocity: Option<&Tangent<f64, N>>,
    ) {
        crba(model, posture, &mut self.mass);
        self.factors.factor(model, &self.mass);
        forward_kinematics(model, posture, &mut self.kinematics);
        if let Some(velocity) = velocity {
            bias_accelerations(model, posture, velocity, &mut self.bias);
        }
        let rows_per_foot = self.rows.len() / feet.len();
        self.count = rows_per_foot * feet.len();
        for (rows, foot) in self.rows.chunks_exact_mut(rows_per_foot).zip(feet) {
            frame_jacobian(
                model,
                &self.kinematics,
                foot,
                Axes::Local,
                &mut self.jacobian,
            );
            let drift = self.bias.frame_classical_acceleration(foot);
            if rows_per_foot == 3 {
                rows.copy_from_slice(&ContactRow::point(&self.jacobian, &drift.linear));
            } else {
                rows.copy_from_slice(&ContactRow::surface(&self.jacobian, &drift));
            }
        }
    }
}

impl<const N: usize> Default for HeldFeet<N> {
    fn default() -> Self {
        Self::new()
    }
}
