//! The algorithms, one per file, each a fold over the tree.

pub mod aba;
pub mod aba_derivatives;
pub mod blocks;
pub mod centroidal;
pub mod centroidal_derivatives;
pub mod com;
pub mod contact;
pub mod crba;
pub mod frame_derivatives;
pub mod friction;
pub mod gravity;
pub mod jacobian;
mod joint_factors;
pub mod kinematics;
pub mod limbs;
pub mod minv;
pub mod motion;
pub mod rnea;
pub mod rnea_derivatives;
mod sweep;

use nalgebra::Vector3;
use so3::Scalar;

use crate::joint::JointKind;
use crate::state::Posture;
use crate::tree::At;

/// Entry `i`, or the default beyond the end: the trees guarantee `i < N`, and no panic path remains
/// where the compiler cannot see it.
#[inline(always)]
pub(crate) fn at<X: Copy + Default>(xs: &[X], i: usize) -> X {
    xs.get(i).copied().unwrap_or_default()
}

/// Writes entry `i`; see [`at`].
#[inline(always)]
pub(crate) fn put<X>(xs: &mut [X], i: usize, x: X) {
    if let Some(slot) = xs.get_mut(i) {
        *slot = x;
    }
}

/// Entries `first..end`, none if there is no such run; loops over slices of one length have one check and not four.
#[inline(always)]
pub(crate) fn run<X>(xs: &[X], first: usize, end: usize) -> &[X] {
    xs.get(first..end).unwrap_or(&[])
}

/// A joint's rotation and offset in a posture.
#[inline(always)]
pub(crate) fn place<J: JointKind, T: Scalar, const N: usize>(
    at_body: At<'_, T>,
    posture: &Posture<T, N>,
) -> (J::Rotation<T>, Vector3<T>) {
    let i = at_body.index;
    (
        J::rotation(at_body.body, at(&posture.sin, i), at(&posture.cos, i)),
        J::offset(at_body.body, at(&posture.q, i)),
    )
}
