//! Analytic derivatives of inverse dynamics, ∂τ/∂q, ∂τ/∂ν and ∂τ/∂ν̇ = M.
//!
//! Coordinates are those of [`Tangent`] on both sides. A displacement of the base is taken in base axes
//! (R ← R exp δθ, p ← p + R δp), so that the base's own motion in base axes does not change with it:
//! columns of the base position are zero, and those of its orientation come from gravity alone, which
//! turns by −δθ × g as seen from the base.
//!
//! For two joints of which neither moves the other both derivatives are zero; for j an ancestor of i or
//! i itself (S, Ṡ, S̈, P, Q, F, G are those of `sweep.rs`):
//!
//! | | q | ν | ν̇ |
//! |---|---|---|---|
//! | ∂τ_i/∂(·)_j | F_i·S̈_j + G_i·Ṡ_j | 2 F_i·Ṡ_j + G_i·S_j | F_i·S_j |
//! | ∂τ_j/∂(·)_i | S_j·P_i | S_j·Q_i | the same |
//!
//! Source: Singh, Russell, Wensing, "Efficient analytical derivatives of rigid-body dynamics using
//! spatial vector algebra", RA-L 2022; the base as in Carpentier, Mansard,
//! "Analytical derivatives of rigid body dynamics algorithms", RSS 2018.

use nalgebra::Vector3;
use so3::Scalar;

use super::blocks::BlockMatrix;
use super::crba::MassMatrix;
use super::gravity::gravity;
use super::put;
pub use super::sweep::DerivativesWorkspace;
use super::sweep::{Joint, Moves, set_column, sweep};
use crate::spatial::{Force, Motion};
use crate::state::{Effort, Posture, Tangent, basis};
use crate::tree::Tree;

/// Derivatives of inverse dynamics at one state.
///
/// The change of effort to first order is dτ = `by_position` dq + `by_velocity` dν + M dν̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RneaDerivatives<T, const N: usize> {
    /// ∂τ/∂q, per displacement in the tangent space.
    pub by_position: BlockMatrix<T, N>,
    /// ∂τ/∂ν.
    pub by_velocity: BlockMatrix<T, N>,
    /// ∂τ/∂ν̇ = M(q).
    pub by_acceleration: MassMatrix<T, N>,
}

impl<T: Scalar, const N: usize> RneaDerivatives<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        by_position: BlockMatrix::ZERO,
        by_velocity: BlockMatrix::ZERO,
        by_acceleration: MassMatrix::ZERO,
    };

    /// Change of the effort, to first order, for small changes of configuration, velocity and
    /// acceleration.
    #[must_use]
    pub fn change(
        &self,
        position: &Tangent<T, N>,
        velocity: &Tangent<T, N>,
        acceleration: &Tangent<T, N>,
    ) -> Effort<T, N> {
        let part = |m: &BlockMatrix<T, N>, x: &Tangent<T, N>| {
            let (base, joints) = m.mul(x.base.to_array(), &x.joints);
            Effort {
                base: Force::from_array(base),
                joints,
            }
        };
        part(&self.by_position, position)
            + part(&self.by_velocity, velocity)
            + self.by_acceleration.mul(acceleration)
    }
}

#[inline(always)]
fn set<T: Copy, const N: usize>(m: &mut [[T; N]; N], i: usize, j: usize, x: T) {
    if let Some(slot) = m.get_mut(i).and_then(|row| row.get_mut(j)) {
        *slot = x;
    }
}

/// Row and column of joint i that belong to the base: with v and g those of the base, the base's axes
/// have the rates v × e and, from gravity, −g × e.
#[inline(always)]
fn base_blocks<T: Scalar, const N: usize>(
    i: usize,
    joint: &Joint<T>,
    base_velocity: &Motion<T>,
    gravity_b: &Vector3<T>,
    out: &mut RneaDerivatives<T, N>,
) {
    let turned = Force::new(Vector3::zeros(), gravity_b.cross(&joint.by_a.linear));
    let moved =
        -base_velocity.cross_force(&joint.by_a) + Force::new(Vector3::zeros(), joint.coriolis);
    put(&mut out.by_position.joints_base, i, turned.to_array());
    put(&mut out.by_velocity.joints_base, i, moved.to_array());
    put(&mut out.by_acceleration.coupling, i, joint.by_a);
    set_column(&mut out.by_position.base_joints, i, joint.by_q.to_array());
    set_column(&mut out.by_velocity.base_joints, i, joint.by_v.to_array());
}

/// Rows and columns of the joints, pair by pair.
#[inline(always)]
fn joint_blocks<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    ws: &DerivativesWorkspace<T, N>,
    out: &mut RneaDerivatives<T, N>,
) {
    out.by_position.joints = [[T::ZERO; N]; N];
    out.by_velocity.joints = [[T::ZERO; N]; N];
    out.by_acceleration.joints = [[T::ZERO; N]; N];
    let (q, v) = (&mut out.by_position.joints, &mut out.by_velocity.joints);
    let m = &mut out.by_acceleration.joints;
    let count = model.joint_count();
    for (i, body) in model.bodies().iter().enumerate().take(count) {
        let (x, mass) = ws.pair(i, i);
        set(q, i, i, x[0]);
        set(v, i, i, x[1]);
        set(m, i, i, mass + body.rotor_inertia);
        for j in i + 1..body.subtree_end {
            let (x, mass) = ws.pair(i, j);
            set(q, i, j, x[0]);
            set(v, i, j, x[1]);
            set(q, j, i, x[2]);
            set(v, j, i, x[3]);
            set(m, i, j, mass);
            set(m, j, i, mass);
        }
    }
}

#[inline(always)]
fn derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    applied: Option<&[Force<T>; N]>,
    ws: &mut DerivativesWorkspace<T, N>,
    out: &mut RneaDerivatives<T, N>,
) {
    let gravity_b = posture.base.rotation.matrix().tr_mul(&gravity());
    let lifted = Motion::new(
        acceleration.base.linear - gravity_b,
        acceleration.base.angular,
    );
    let moves = Moves {
        base_velocity: velocity.base,
        base_acceleration: lifted,
        velocity: &velocity.joints,
        acceleration: &acceleration.joints,
        applied,
    };
    let whole = sweep(model, posture, &moves, ws, |i, joint, _| {
        base_blocks(i, joint, &velocity.base, &gravity_b, out);
    });
    joint_blocks(model, ws, out);

    out.by_acceleration.base = whole.inertia;
    for (k, unit) in basis::<T>().iter().enumerate() {
        let turned = Motion::new(-gravity_b.cross(&unit.angular), Vector3::zeros());
        let by_q = whole.inertia.mul(&turned);
        let by_v = whole.inertia.mul(&velocity.base.cross(unit)) + whole.coriolis(&unit.angular);
        for (row, x) in out.by_position.base.iter_mut().zip(by_q.to_array()) {
            put(row, k, x);
        }
        for (row, x) in out.by_velocity.base.iter_mut().zip(by_v.to_array()) {
            put(row, k, x);
        }
    }
}

/// Derivatives of [`rnea`](crate::rnea) with respect to configuration, velocity and acceleration.
///
/// Base rows of the result are those of the base wrench in base axes; the acceleration of the base is
/// its spatial acceleration, and that is what is held constant, as in `rnea` and in Pinocchio's
/// `computeRNEADerivatives`. For a fixed base, the base columns of ∂τ/∂q tell what happens when its
/// mount is tilted, the base rows how the reaction of the ground changes.
#[inline]
pub fn rnea_derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    ws: &mut DerivativesWorkspace<T, N>,
    out: &mut RneaDerivatives<T, N>,
) {
    derivatives(model, posture, velocity, acceleration, None, ws, out);
}

/// Derivatives of [`rnea_with_forces`](crate::rnea_with_forces), the forces held constant in the axes
/// of the bodies on which they act.
///
/// A force held constant in world axes instead turns in its body as the body turns: that changes τ
/// further by −Jᵀ (f × J_ω dq), with the frame's Jacobian J in the axes of the world. A force on the
/// base, constant in base axes, has no derivative and is no argument.
#[inline]
pub fn rnea_derivatives_with_forces<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    forces: &[Force<T>; N],
    ws: &mut DerivativesWorkspace<T, N>,
    out: &mut RneaDerivatives<T, N>,
) {
    derivatives(
        model,
        posture,
        velocity,
        acceleration,
        Some(forces),
        ws,
        out,
    );
}
