//! Tasks: rows that are linear in the robot's motion.
//!
//! A task's coordinates x have the rate ẋ = J ν and the acceleration ẍ = J ν̇ + J̇ν. At the level of velocities a program
//! asks for ẋ = ẋ*, at the level of accelerations for ẍ = ẍ*; J, J̇ν and ẋ are all that either needs, so every task
//! serves both.

use nalgebra::{Rotation3, Vector3};
use rbd_core::{Axes, Effort, Force, Frame, FrameJacobian, Tangent, Tree, frame_jacobian};
use so3::Scalar;

use crate::Snapshot;

/// R rows of a task on a robot with N joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task<T, const N: usize, const R: usize> {
    /// Rows of J.
    pub jacobian: [Effort<T, N>; R],
    /// J̇ν.
    pub drift: [T; R],
    /// ẋ = J ν now.
    pub rate: [T; R],
}

/// Feedback on a task's position and rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<T> {
    /// On the position error, 1/s² (1/s at the level of velocities).
    pub stiffness: T,
    /// On the rate error, 1/s.
    pub damping: T,
}

impl Gains<f64> {
    /// The same in either precision.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Gains<T> {
        Gains {
            stiffness: T::of(self.stiffness),
            damping: T::of(self.damping),
        }
    }
}

impl<T: Scalar, const N: usize, const R: usize> Task<T, N, R> {
    /// The rows with these indices, in this order: a mask. Rows that do not exist are zero.
    #[must_use]
    pub fn select<const S: usize>(&self, rows: [usize; S]) -> Task<T, N, S> {
        Task {
            jacobian: rows.map(|i| self.jacobian.get(i).copied().unwrap_or_default()),
            drift: rows.map(|i| self.drift.get(i).copied().unwrap_or_default()),
            rate: rows.map(|i| self.rate.get(i).copied().unwrap_or_default()),
        }
    }

    /// J x of any motion x: the rate at a velocity; the acceleration less J̇ν at an acceleration.
    #[must_use]
    pub fn of(&self, motion: &Tangent<T, N>) -> [T; R] {
        let mut out = [T::ZERO; R];
        for (x, row) in out.iter_mut().zip(&self.jacobian) {
            *x = motion.dot(row);
        }
        out
    }

    /// ẍ = J ν̇ + J̇ν at an acceleration of the robot.
    #[must_use]
    pub fn reached(&self, acceleration: &Tangent<T, N>) -> [T; R] {
        let mut x = self.of(acceleration);
        for (x, drift) in x.iter_mut().zip(&self.drift) {
            *x += *drift;
        }
        x
    }

    /// ẋ* = ẋ_d + K e: the velocity law of paper B eq. (3b), e the wanted position less the actual one.
    #[must_use]
    pub fn velocity(&self, wanted_rate: [T; R], error: [T; R], gain: T) -> [T; R] {
        let mut out = wanted_rate;
        for (x, e) in out.iter_mut().zip(error) {
            *x += gain * e;
        }
        out
    }

    /// ẍ* = ẍ_d + K_d (ẋ_d − ẋ) + K_p e: the acceleration law of paper B eq. (6b).
    #[must_use]
    pub fn acceleration(
        &self,
        wanted: [T; R],
        wanted_rate: [T; R],
        error: [T; R],
        gains: Gains<T>,
    ) -> [T; R] {
        let mut out = wanted;
        let state = wanted_rate.iter().zip(&self.rate).zip(error);
        for (x, ((wanted, rate), e)) in out.iter_mut().zip(state) {
            *x += gains.damping * (*wanted - *rate) + gains.stiffness * e;
        }
        out
    }
}

/// Position error of a point, wanted less actual, as a task's `error`.
#[must_use]
pub fn position_error<T: Scalar>(wanted_w: &Vector3<T>, actual_w: &Vector3<T>) -> [T; 3] {
    (wanted_w - actual_w).into()
}

/// Rotation that leads from the actual to the wanted orientation, as a rotation vector in world axes: log(R_d Rᵀ).
#[must_use]
pub fn orientation_error<T: Scalar>(wanted: &Rotation3<T>, actual: &Rotation3<T>) -> [T; 3] {
    so3::log(&(wanted * actual.inverse())).into()
}

impl<T: Scalar, const N: usize> Snapshot<T, N> {
    /// The centre of mass, x = c in world axes: J_c of paper B eqs. (3b) and (6b).
    #[must_use]
    pub fn com(&self) -> Task<T, N, 3> {
        let per_mass = T::ONE / self.centroidal.mass;
        let map = &self.centroidal;
        Task {
            jacobian: [0, 1, 2].map(|axis| Effort {
                base: Force::from_array(map.base.map(|f| pick(&f.linear, axis) * per_mass)),
                joints: map.joints.map(|f| pick(&f.linear, axis) * per_mass),
            }),
            drift: (self.momentum_bias_w.linear * per_mass).into(),
            rate: self.com_velocity_w().into(),
        }
    }

    /// Linear momentum, ẋ = m ċ in world axes, kg m/s.
    #[must_use]
    pub fn linear_momentum(&self) -> Task<T, N, 3> {
        let map = &self.centroidal;
        Task {
            jacobian: [0, 1, 2].map(|axis| Effort {
                base: Force::from_array(map.base.map(|f| pick(&f.linear, axis))),
                joints: map.joints.map(|f| pick(&f.linear, axis)),
            }),
            drift: self.momentum_bias_w.linear.into(),
            rate: self.momentum_w.linear.into(),
        }
    }

    /// Angular momentum about the centre of mass, ẋ = H_ω in world axes, kg m²/s: J_M^ω of paper B eq. (3d).
    #[must_use]
    pub fn angular_momentum(&self) -> Task<T, N, 3> {
        let map = &self.centroidal;
        Task {
            jacobian: [0, 1, 2].map(|axis| Effort {
                base: Force::from_array(map.base.map(|f| pick(&f.angular, axis))),
                joints: map.joints.map(|f| pick(&f.angular, axis)),
            }),
            drift: self.momentum_bias_w.angular.into(),
            rate: self.momentum_w.angular.into(),
        }
    }

    /// Position and orientation of a frame: ẋ is its linear and angular velocity in world axes.
    #[must_use]
    pub fn frame_pose<M: Tree<T, N>>(&self, model: &M, frame: &Frame<T>) -> Task<T, N, 6> {
        let mut j = FrameJacobian::ZERO;
        let axes = Axes::LocalWorldAligned;
        frame_jacobian(model, &self.kinematics, frame, axes, &mut j);
        let xf_wf = self.pose(frame);
        let drift = self.motions.frame_classical_acceleration(frame);
        let rate = self.motions.frame_velocity(frame);
        Task {
            jacobian: rows(&j),
            drift: axes.motion(&xf_wf, &drift).to_array(),
            rate: axes.motion(&xf_wf, &rate).to_array(),
        }
    }

    /// Position of a frame's origin in world axes.
    #[must_use]
    pub fn frame_position<M: Tree<T, N>>(&self, model: &M, frame: &Frame<T>) -> Task<T, N, 3> {
        self.frame_pose(model, frame).select([0, 1, 2])
    }

    /// Orientation of a frame: ẋ is its angular velocity in world axes.
    #[must_use]
    pub fn frame_orientation<M: Tree<T, N>>(&self, model: &M, frame: &Frame<T>) -> Task<T, N, 3> {
        self.frame_pose(model, frame).select([3, 4, 5])
    }
}

impl<T: Scalar, const N: usize> Task<T, N, 3> {
    /// The same task with its three rows along other axes: R from these axes to the present ones, so x becomes Rᵀx. The axes are
    /// those of this instant and do not turn with any link, so drift and rate are turned likewise. With a frame's `rot_wf`, a task in the world becomes
    /// one in the frame's own axes.
    #[must_use]
    pub fn in_axes(&self, rotation: &Rotation3<T>) -> Self {
        let to = rotation.inverse();
        let turned = |x: [T; 3]| -> [T; 3] { (to * Vector3::from(x)).into() };
        let [a, b, c] = self.jacobian;
        let jacobian = [0, 1, 2].map(|axis| {
            let mut unit = Vector3::zeros();
            if let Some(x) = unit.get_mut(axis) {
                *x = T::ONE;
            }
            let share = rotation * unit;
            a * share.x + b * share.y + c * share.z
        });
        Self {
            jacobian,
            drift: turned(self.drift),
            rate: turned(self.rate),
        }
    }
}

/// The rows of a Jacobian that is stored by columns.
pub(crate) fn rows<T: Scalar, const N: usize>(j: &FrameJacobian<T, N>) -> [Effort<T, N>; 6] {
    [0, 1, 2, 3, 4, 5].map(|axis| {
        let mut unit = [T::ZERO; 6];
        if let Some(x) = unit.get_mut(axis) {
            *x = T::ONE;
        }
        j.tr_mul(&Force::from_array(unit))
    })
}

#[inline(always)]
fn pick<T: Scalar>(v: &Vector3<T>, axis: usize) -> T {
    v.get(axis).copied().unwrap_or(T::ZERO)
}
