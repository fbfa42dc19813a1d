//! States as C gives them.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{Configuration, Effort, Motion, Tangent, Transform};

use crate::Status;

/// State of a robot: base and joints.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize> {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Rotation of the base, base to world, by rows.
    pub rotation_wb: [f64; 9],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; N],
}

impl<const N: usize> State<N> {
    /// The state as the dynamics take it; an error unless all is finite and the rotation is one.
    pub(crate) fn read(&self) -> Result<(Configuration<f64, N>, Tangent<f64, N>), Status> {
        let numbers = self.position_w.iter().chain(&self.rotation_wb);
        let numbers = numbers
            .chain(&self.linear_velocity_b)
            .chain(&self.angular_velocity_b);
        let mut numbers = numbers.chain(&self.joints).chain(&self.joint_velocities);
        let rotation = Matrix3::from_row_slice_generic(
            nalgebra::Const::<3>,
            nalgebra::Const::<3>,
            &self.rotation_wb,
        );
        let skewed = (rotation * rotation.transpose() - Matrix3::identity()).norm_squared();
        if !numbers.all(|x| x.is_finite()) || skewed > 1e-6 || rotation.determinant() < 0.0 {
            return Err(Status::BadData);
        }
        let base = Transform::new(
            Rotation3::from_matrix_unchecked(rotation),
            Vector3::from(self.position_w),
        );
        let velocity = Motion::new(
            Vector3::from(self.linear_velocity_b),
            Vector3::from(self.angular_velocity_b),
        );
        Ok((
            Configuration {
                base,
                joints: self.joints,
            },
            Tangent {
                base: velocity,
                joints: self.joint_velocities,
            },
        ))
    }
}

/// How far the square of a quaternion's length may be from 1.
const UNIT: f64 = 1e-3;

/// A pose from a position and a quaternion x, y, z, w; none unless all is finite and the quaternion of length 1.
pub(crate) fn pose(position: &[f64; 3], xyzw: &[f64; 4]) -> Option<Transform<f64>> {
    let square: f64 = xyzw.iter().map(|x| x * x).sum();
    // Also false for NaN.
    let unit = so3::math::abs(square - 1.0) <= UNIT;
    if !unit || !position.iter().all(|x| x.is_finite()) {
        return None;
    }
    let rotation = so3::quat::to_rotation(&so3::quat::from_xyzw(*xyzw).ok()?);
    Some(Transform::new(rotation, Vector3::from(*position)))
}

/// A pose that is none: who acts on it finds that it is not finite.
pub(crate) fn no_pose() -> Transform<f64> {
    let nan = Matrix3::repeat(f64::NAN);
    Transform::new(
        Rotation3::from_matrix_unchecked(nan),
        Vector3::repeat(f64::NAN),
    )
}

/// The quaternion x, y, z, w of a rotation, w ≥ 0.
pub(crate) fn xyzw(rotation: &Rotation3<f64>) -> [f64; 4] {
    so3::quat::to_xyzw(&so3::quat::from_rotation(rotation))
}

/// A generalised acceleration: base in base axes, linear first, then joints.
pub(crate) fn tangent<const N: usize>(base: &[f64; 6], joints: &[f64; N]) -> Tangent<f64, N> {
    Tangent {
        base: Motion::from_array(*base),
        joints: *joints,
    }
}

/// A generalised effort: wrench on the base in base axes, force first, then joint torques.
pub(crate) fn effort<const N: usize>(base: &[f64; 6], joints: &[f64; N]) -> Effort<f64, N> {
    Effort {
        base: rbd_core::Force::from_array(*base),
        joints: *joints,
    }
}
