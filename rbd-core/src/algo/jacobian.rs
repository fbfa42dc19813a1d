//! Jacobians of frames: from generalised velocity to the motion of a frame.
//!
//! Column j of a revolute joint with axis z_j through p_j is (z_j × (p_f − p_j), z_j) in world axes about
//! the frame's origin; of a prismatic joint (z_j, 0); zero for joints that do not move the frame.

use nalgebra::{Matrix3, SMatrix, Vector3};
use so3::Scalar;

use super::at;
use super::kinematics::Kinematics;
use super::motion::Axes;
use crate::model::{Body, Frame, Link};
use crate::spatial::{Force, Motion, Transform};
use crate::state::{Effort, Tangent};
use crate::tree::Tree;

/// Jacobian of one frame, 6 × (6 + N), by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameJacobian<T, const N: usize> {
    /// Columns of the base velocity, linear first.
    pub base: [Motion<T>; 6],
    /// Columns of the joints.
    pub joints: [Motion<T>; N],
}

impl<T: Scalar, const N: usize> FrameJacobian<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        base: [Motion::ZERO; 6],
        joints: [Motion::ZERO; N],
    };

    /// J ν: the motion of the frame.
    #[must_use]
    pub fn mul(&self, velocity: &Tangent<T, N>) -> Motion<T> {
        let base = self.base.iter().zip(velocity.base.to_array());
        let sum = base.fold(Motion::ZERO, |sum, (column, x)| sum + *column * x);
        let joints = self.joints.iter().zip(velocity.joints);
        joints.fold(sum, |sum, (column, x)| sum + *column * x)
    }

    /// Jᵀ f: the effort of a wrench on the frame, given in the axes of the Jacobian.
    #[must_use]
    pub fn tr_mul(&self, force: &Force<T>) -> Effort<T, N> {
        Effort {
            base: Force::from_array(self.base.map(|column| column.dot(force))),
            joints: self.joints.map(|column| column.dot(force)),
        }
    }

    /// As one dense 6 × V matrix, base first. `V` must be 6 + N; other sizes do not compile.
    #[must_use]
    pub fn to_dense<const V: usize>(&self) -> SMatrix<T, 6, V> {
        const { assert!(V == 6 + N, "a Jacobian has 6 + N columns") };
        let mut m: SMatrix<T, 6, V> = SMatrix::zeros();
        for (mut to, from) in m
            .column_iter_mut()
            .zip(self.base.iter().chain(&self.joints))
        {
            to.copy_from_slice(&from.to_array());
        }
        m
    }
}

/// Axis of a joint in the world, with the sign of the robot's own coordinate.
#[inline(always)]
pub(crate) fn axis_w<T: Scalar>(body: &Body<T>, xf_wi: &Transform<T>) -> Vector3<T> {
    let [x, y, z] = columns(xf_wi.rotation.matrix());
    let axis = match body.kind.axis() {
        0 => x,
        1 => y,
        _ => z,
    };
    axis * body.sign
}

/// Jacobian of a frame in the chosen axes.
///
/// Cost: the depth of the frame; every other column is zero.
#[inline]
pub fn frame_jacobian<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    kinematics: &Kinematics<T, N>,
    frame: &Frame<T>,
    axes: Axes,
    out: &mut FrameJacobian<T, N>,
) {
    let xf_wf = kinematics.frame(frame);
    // Columns in world axes about `about`, then turned into the frame's own where asked.
    let about = match axes {
        Axes::World => Vector3::zeros(),
        Axes::Local | Axes::LocalWorldAligned => xf_wf.translation,
    };
    let turn = |m: Motion<T>| match axes {
        Axes::Local => Motion {
            linear: xf_wf.rotation.matrix().tr_mul(&m.linear),
            angular: xf_wf.rotation.matrix().tr_mul(&m.angular),
        },
        Axes::World | Axes::LocalWorldAligned => m,
    };

    let base = &kinematics.base;
    let arm = about - base.translation;
    let [x, y, z] = columns(base.rotation.matrix());
    out.base = [
        Motion::new(x, Vector3::zeros()),
        Motion::new(y, Vector3::zeros()),
        Motion::new(z, Vector3::zeros()),
        Motion::new(x.cross(&arm), x),
        Motion::new(y.cross(&arm), y),
        Motion::new(z.cross(&arm), z),
    ]
    .map(turn);

    out.joints = [Motion::ZERO; N];
    let mut link = frame.link;
    // At most N steps from a leaf to the base.
    for _ in 0..N {
        let Link::Joint(j) = link else { break };
        let Some(body) = model.bodies().get(j) else {
            break;
        };
        let xf_wj = at(&kinematics.bodies, j);
        if let Some(column) = out.joints.get_mut(j) {
            *column = turn(joint_column(body, &xf_wj, &about));
        }
        link = body.parent;
    }
}

/// Motion of the point `about` per unit velocity of a joint, world axes.
#[inline(always)]
fn joint_column<T: Scalar>(body: &Body<T>, xf_wj: &Transform<T>, about: &Vector3<T>) -> Motion<T> {
    let axis = axis_w(body, xf_wj);
    if body.kind.is_revolute() {
        Motion::new(axis.cross(&(about - xf_wj.translation)), axis)
    } else {
        Motion::new(axis, Vector3::zeros())
    }
}

/// Column of every joint in world axes about the world's origin, for any frame: the Jacobian of a frame
/// in [`Axes::World`] is the columns of the joints that move it.
#[inline]
pub fn joint_jacobians<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    kinematics: &Kinematics<T, N>,
    out: &mut [Motion<T>; N],
) {
    let origin = Vector3::zeros();
    for ((column, body), pose) in out.iter_mut().zip(model.bodies()).zip(&kinematics.bodies) {
        *column = joint_column(body, pose, &origin);
    }
}

/// The columns of a rotation: the axes of the rotated frame.
#[inline(always)]
pub(crate) fn columns<T: Scalar>(r: &Matrix3<T>) -> [Vector3<T>; 3] {
    [
        Vector3::new(r.m11, r.m21, r.m31),
        Vector3::new(r.m12, r.m22, r.m32),
        Vector3::new(r.m13, r.m23, r.m33),
    ]
}
