//! States as C gives them.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{Configuration, Effort, Motion, Tangent, Transform};

use crate::Status;

/// State of A1: base and twelve joints.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1State {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Rotation of the base, base to world, by rows.
    pub rotation_wb: [f64; 9],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; 12],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; 12],
}

/// State of iCub: base and 23 joints.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcubState {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Rotation of the base, base to world, by rows.
    pub rotation_wb: [f64; 9],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; 23],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; 23],
}

macro_rules! read {
    ($Name:ident $N:literal) => {
        impl $Name {
            /// The state as the dynamics take it; an error unless all is finite and the rotation is one.
            pub(crate) fn read(
                &self,
            ) -> Result<(Configuration<f64, $N>, Tangent<f64, $N>), Status> {
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
                if !numbers.all(|x| x.is_finite()) || skewed > 1e-6 || rotation.determinant() < 0.0
                {
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
    };
}

read! { A1State 12 }
read! { IcubState 23 }

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
