//! Analytic derivatives of forward dynamics, ∂ν̇/∂q, ∂ν̇/∂ν and ∂ν̇/∂τ = M⁻¹.
//!
//! From τ(q, ν, ν̇(q, ν, τ)) = τ: ∂ν̇/∂q = −M⁻¹ ∂τ/∂q and ∂ν̇/∂ν = −M⁻¹ ∂τ/∂ν, the derivatives of
//! inverse dynamics at the acceleration that forward dynamics gives (Carpentier, Mansard, "Analytical
//! derivatives of rigid body dynamics algorithms", RSS 2018).
//!
//! One sweep at zero acceleration gives M and the bias forces; M is factored along the branches of the tree
//! (see [`minv`](super::minv)) and gives ν̇; what the acceleration adds to the sweep is linear in it and cheap.

use nalgebra::Vector3;
use so3::Scalar;

use super::blocks::{BlockMatrix, add_scaled};
use super::gravity::gravity;
use super::minv::MassFactors;
use super::rnea_derivatives::{
    BaseState, DerivativesWorkspace, RneaDerivatives, gradient_blocks, mass_blocks,
};
use super::sweep::{Moves, sweep};
use crate::spatial::{Force, Motion};
use crate::state::{Effort, Posture, Tangent};
use crate::tree::Tree;

/// Derivatives of forward dynamics at one state, and the acceleration itself.
///
/// The change of acceleration to first order is dν̇ = `by_position` dq + `by_velocity` dν +
/// `by_effort` dτ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbaDerivatives<T, const N: usize> {
    /// ν̇.
    pub acceleration: Tangent<T, N>,
    /// ∂ν̇/∂q, per displacement in the tangent space.
    pub by_position: BlockMatrix<T, N>,
    /// ∂ν̇/∂ν.
    pub by_velocity: BlockMatrix<T, N>,
    /// ∂ν̇/∂τ = M⁻¹.
    pub by_effort: BlockMatrix<T, N>,
}

impl<T: Scalar, const N: usize> AbaDerivatives<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        acceleration: Tangent::ZERO,
        by_position: BlockMatrix::ZERO,
        by_velocity: BlockMatrix::ZERO,
        by_effort: BlockMatrix::ZERO,
    };

    /// Change of the acceleration, to first order, for small changes of configuration, velocity and
    /// effort.
    #[must_use]
    pub fn change(
        &self,
        position: &Tangent<T, N>,
        velocity: &Tangent<T, N>,
        effort: &Effort<T, N>,
    ) -> Tangent<T, N> {
        let part = |m: &BlockMatrix<T, N>, base: [T; 6], joints: &[T; N]| {
            let (base, joints) = m.mul(base, joints);
            Tangent {
                base: Motion::from_array(base),
                joints,
            }
        };
        part(
            &self.by_position,
            position.base.to_array(),
            &position.joints,
        ) + part(
            &self.by_velocity,
            velocity.base.to_array(),
            &velocity.joints,
        ) + part(&self.by_effort, effort.base.to_array(), &effort.joints)
    }
}

/// Scratch of [`aba_derivatives`]: the derivatives of inverse dynamics and the factors of M; [`AbaDerivativesWorkspace::factors`] can solve with M afterwards.
#[derive(Clone, Copy, Debug)]
pub struct AbaDerivativesWorkspace<T, const N: usize> {
    inverse_dynamics: DerivativesWorkspace<T, N>,
    efforts: RneaDerivatives<T, N>,
    factors: MassFactors<T, N>,
    joints_inverse: [[T; N]; N],
}

impl<T: Scalar, const N: usize> AbaDerivativesWorkspace<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            inverse_dynamics: DerivativesWorkspace::new(),
            efforts: RneaDerivatives::ZERO,
            factors: MassFactors::new(),
            joints_inverse: [[T::ZERO; N]; N],
        }
    }

    /// Factors of M at the state of the last call.
    #[must_use]
    pub const fn factors(&self) -> &MassFactors<T, N> {
        &self.factors
    }

    /// Derivatives of inverse dynamics at the state of the last call.
    #[must_use]
    pub const fn inverse_dynamics(&self) -> &RneaDerivatives<T, N> {
        &self.efforts
    }
}

impl<T: Scalar, const N: usize> Default for AbaDerivativesWorkspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

#[inline(always)]
fn derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    applied: Option<&[Force<T>; N]>,
    ws: &mut AbaDerivativesWorkspace<T, N>,
    out: &mut AbaDerivatives<T, N>,
) {
    let AbaDerivativesWorkspace {
        inverse_dynamics: id,
        efforts,
        factors,
        joints_inverse,
    } = ws;
    let gravity_b = posture.base.rotation.matrix().tr_mul(&gravity());
    let base = BaseState {
        velocity: velocity.base,
        gravity_b,
    };
    let still = [T::ZERO; N];
    let moves = Moves {
        base_inertia: model.base().inertia(),
        base_velocity: velocity.base,
        base_acceleration: Motion::new(-gravity_b, Vector3::zeros()),
        velocity: &velocity.joints,
        acceleration: &still,
        applied,
    };
    let whole = sweep(model, posture, &moves, id);
    id.answer_mass();
    mass_blocks(model, id, &whole, efforts);
    factors.factor(model, &efforts.by_acceleration);

    let mut drive = Effort {
        base: effort.base - whole.force,
        joints: effort.joints,
    };
    for (x, y) in drive.joints.iter_mut().zip(id.efforts()) {
        *x -= y;
    }
    factors.joints().inverse(joints_inverse);
    out.by_effort.joints = *joints_inverse;
    factors.complete_inverse(&mut out.by_effort);
    // M⁻¹ is there, and symmetric: its rows together are quicker than another solve.
    let (mut base_acceleration, mut joint_accelerations) = ([T::ZERO; 6], [T::ZERO; N]);
    let inverse = &out.by_effort;
    let rows = inverse.base.iter().zip(&inverse.base_joints);
    let rows = rows.chain(inverse.joints_base.iter().zip(&inverse.joints));
    for (x, (left, right)) in drive.base.to_array().iter().chain(&drive.joints).zip(rows) {
        add_scaled(&mut base_acceleration, *x, left);
        add_scaled(&mut joint_accelerations, *x, right);
    }
    out.acceleration = Tangent {
        base: Motion::from_array(base_acceleration),
        joints: joint_accelerations,
    };
    id.accelerate(model, &out.acceleration.base, &out.acceleration.joints);
    gradient_blocks(model, id, &base, &whole, efforts);
    for (d, to) in [
        (&efforts.by_position, &mut out.by_position),
        (&efforts.by_velocity, &mut out.by_velocity),
    ] {
        factors.solve_derivatives(&out.by_effort, joints_inverse, d, to);
    }
}

/// Derivatives of [`aba`](crate::aba) with respect to configuration, velocity and effort, and its value.
///
/// For a fixed base the rows of the base are zero, and the base columns of ∂ν̇/∂q tell what happens
/// when its mount is tilted.
#[inline]
pub fn aba_derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    ws: &mut AbaDerivativesWorkspace<T, N>,
    out: &mut AbaDerivatives<T, N>,
) {
    derivatives(model, posture, velocity, effort, None, ws, out);
}

/// Derivatives of [`aba_with_forces`](crate::aba_with_forces), the forces held constant in the axes of the
/// bodies on which they act (see [`rnea_derivatives_with_forces`](crate::rnea_derivatives_with_forces)).
#[inline]
pub fn aba_derivatives_with_forces<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    forces: &[Force<T>; N],
    ws: &mut AbaDerivativesWorkspace<T, N>,
    out: &mut AbaDerivatives<T, N>,
) {
    derivatives(model, posture, velocity, effort, Some(forces), ws, out);
}
