//! The algorithms, one per file, each a fold over the tree.
//!
//! # Fixed bases
//! The base of a [`BaseKind::Fixed`] model, with every link that is welded to it, is part of the world. It counts
//! neither in the mass, the centre of mass, its Jacobian and its motion, nor in the momentum, its map, rate and
//! derivatives, nor in the energies: all of these are those of the links that joints move, as in Pinocchio, which
//! leaves the inertia of its "universe" out. Base columns of maps and Jacobians say what the moved links would do if
//! the base moved. The base wrench of inverse dynamics is the reaction of the ground and does carry the base's weight;
//! so do the base blocks of the mass matrix and of the derivatives of inverse dynamics.

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
mod pairs;
pub mod rnea;
pub mod rnea_derivatives;
pub mod second_order;
mod subtree;
mod sweep;
mod table;

use nalgebra::Vector3;
use so3::Scalar;

use crate::joint::JointKind;
use crate::model::BaseKind;
use crate::spatial::Inertia;
use crate::state::Posture;
use crate::tree::{At, Tree};

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

/// The base's inertia as far as it is part of the moving robot: a fixed base is part of the world and has none.
#[inline(always)]
pub(crate) fn moving_base<T: Scalar, M: Tree<T, N>, const N: usize>(model: &M) -> Inertia<T> {
    match model.base_kind() {
        BaseKind::Floating => model.base().inertia(),
        BaseKind::Fixed => Inertia::ZERO,
    }
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
