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

use core::array::from_fn;
use core::ops::Range;

use nalgebra::Vector3;
use so3::Scalar;

use super::blocks::BlockMatrix;
use super::crba::MassMatrix;
use super::gravity::gravity;
use super::put;
use super::subtree::Composite;
pub use super::sweep::DerivativesWorkspace;
use super::sweep::{Moves, sweep};
use super::table::{LANES, set_window};
use crate::model::Body;
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

/// Writes what joint `i` and [`LANES`] joints from the start of `lanes` on do to each other: entries (j, i) and (i, j) for all j
/// of `lanes` from `i` on.
#[inline(always)]
fn put_pairs<T: Scalar, const N: usize>(
    m: &mut [[T; N]; N],
    i: usize,
    lanes: Range<usize>,
    below: &[T; LANES],
    above: &[T; LANES],
) {
    let rows = m
        .get_mut(lanes.start..)
        .and_then(|rows| rows.first_chunk_mut::<LANES>());
    match rows {
        Some(rows) if lanes.start >= i => {
            // No joint behind the end is on the branch of i: what stands there is zero and stays zero.
            let kept = |x: &[T; LANES]| -> [T; LANES] {
                from_fn(|l| {
                    if lanes.start + l < lanes.end {
                        x[l]
                    } else {
                        T::ZERO
                    }
                })
            };
            for (row, x) in rows.iter_mut().zip(kept(below)) {
                put(row, i, x);
            }
            if let Some(row) = m.get_mut(i) {
                set_window(row, lanes.start, &kept(above));
            }
        }
        // At the end of the table lanes begin before joint i, or there are fewer joints than lanes: one by one.
        _ => {
            for (j, (&x, &y)) in lanes.zip(below.iter().zip(above)).filter(|&(j, _)| j >= i) {
                if let Some(row) = m.get_mut(j) {
                    put(row, i, x);
                }
                if let Some(row) = m.get_mut(i) {
                    put(row, j, y);
                }
            }
        }
    }
}

/// The base that the derivatives are taken at.
#[derive(Clone, Copy)]
pub(crate) struct BaseState<T> {
    /// Velocity.
    pub(crate) velocity: Motion<T>,
    /// Gravity in base axes.
    pub(crate) gravity_b: Vector3<T>,
}

/// Blocks of M from the workspace.
pub(crate) fn mass_blocks<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    ws: &DerivativesWorkspace<T, N>,
    whole: &Composite<T>,
    out: &mut RneaDerivatives<T, N>,
) {
    coupling_block(ws, &mut out.by_acceleration.coupling);
    joint_blocks::<T, true, false, N>(model.bodies(), model.joint_count(), ws, out);
    out.by_acceleration.base = whole.inertia;
}

/// Blocks of ∂τ/∂q and ∂τ/∂ν from the workspace.
pub(crate) fn gradient_blocks<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    ws: &DerivativesWorkspace<T, N>,
    base: &BaseState<T>,
    whole: &Composite<T>,
    out: &mut RneaDerivatives<T, N>,
) {
    border_blocks(ws, base, out);
    joint_blocks::<T, false, true, N>(model.bodies(), model.joint_count(), ws, out);
    base_block(base, whole, out);
}

/// Column of the coupling for each joint.
#[inline(always)]
fn coupling_block<T: Scalar, const N: usize>(
    ws: &DerivativesWorkspace<T, N>,
    coupling: &mut [Force<T>; N],
) {
    for (i, column) in coupling.iter_mut().enumerate() {
        *column = ws.joint(i).by_a;
    }
}

/// Rows and columns between base and joints: with v and g those of the base, the base's axes have the rates
/// v × e and, from gravity, −g × e.
#[inline(never)]
fn border_blocks<T: Scalar, const N: usize>(
    ws: &DerivativesWorkspace<T, N>,
    base: &BaseState<T>,
    out: &mut RneaDerivatives<T, N>,
) {
    let [a, b, c, d, e, f, g, h, i, j, k, l, ..] = &ws.answers;
    out.by_position.base_joints = [*a, *b, *c, *d, *e, *f];
    out.by_velocity.base_joints = [*g, *h, *i, *j, *k, *l];
    for i in 0..N {
        let joint = ws.joint(i);
        let turned = Force::new(Vector3::zeros(), base.gravity_b.cross(&joint.by_a.linear));
        let moved =
            Force::new(Vector3::zeros(), joint.coriolis) - base.velocity.cross_force(&joint.by_a);
        out.by_position.joints_base[i] = turned.to_array();
        out.by_velocity.joints_base[i] = moved.to_array();
    }
}

/// Rows and columns of the base itself.
#[inline(never)]
fn base_block<T: Scalar, const N: usize>(
    base: &BaseState<T>,
    whole: &Composite<T>,
    out: &mut RneaDerivatives<T, N>,
) {
    for (k, unit) in basis::<T>().iter().enumerate() {
        let turned = Motion::new(-base.gravity_b.cross(&unit.angular), Vector3::zeros());
        let by_q = whole.inertia.mul(&turned);
        let by_v = whole.inertia.mul(&base.velocity.cross(unit)) + whole.coriolis(&unit.angular);
        for (row, x) in out.by_position.base.iter_mut().zip(by_q.to_array()) {
            put(row, k, x);
        }
        for (row, x) in out.by_velocity.base.iter_mut().zip(by_v.to_array()) {
            put(row, k, x);
        }
    }
}

/// Rows and columns of the joints, a joint against its branch: of M, of the derivatives, or of both.
#[inline(never)]
fn joint_blocks<T: Scalar, const MASS: bool, const GRADIENT: bool, const N: usize>(
    bodies: &[Body<T>; N],
    count: usize,
    ws: &DerivativesWorkspace<T, N>,
    out: &mut RneaDerivatives<T, N>,
) {
    if GRADIENT {
        out.by_position.joints = [[T::ZERO; N]; N];
        out.by_velocity.joints = [[T::ZERO; N]; N];
    }
    if MASS {
        out.by_acceleration.joints = [[T::ZERO; N]; N];
    }
    let (q, v) = (&mut out.by_position.joints, &mut out.by_velocity.joints);
    let m = &mut out.by_acceleration.joints;
    for (i, body) in bodies.iter().enumerate().take(count) {
        let mut from = i;
        while from < body.subtree_end {
            // The last lanes of the table are taken together with some that are not meant.
            let first = from.min(N.saturating_sub(LANES));
            let pairs = ws.pairs::<MASS, GRADIENT>(i, first);
            let end = body.subtree_end;
            if GRADIENT {
                put_pairs(q, i, first..end, &pairs.below_q, &pairs.above_q);
                put_pairs(v, i, first..end, &pairs.below_v, &pairs.above_v);
            }
            if MASS {
                put_pairs(m, i, first..end, &pairs.mass, &pairs.mass);
            }
            from = first + LANES;
        }
        if MASS && let Some(x) = m.get_mut(i).and_then(|row| row.get_mut(i)) {
            *x += body.rotor_inertia;
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
    let base = BaseState {
        velocity: velocity.base,
        gravity_b,
    };
    let moves = Moves {
        base_inertia: model.base().inertia(),
        base_velocity: velocity.base,
        base_acceleration: Motion::new(
            acceleration.base.linear - gravity_b,
            acceleration.base.angular,
        ),
        velocity: &velocity.joints,
        acceleration: &acceleration.joints,
        applied,
    };
    let whole = sweep(model, posture, &moves, ws);
    ws.answer();
    border_blocks(ws, &base, out);
    coupling_block(ws, &mut out.by_acceleration.coupling);
    joint_blocks::<T, true, true, N>(model.bodies(), model.joint_count(), ws, out);
    base_block(&base, &whole, out);
    out.by_acceleration.base = whole.inertia;
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
