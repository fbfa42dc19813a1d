//! Analytic derivatives of inverse dynamics, ∂τ/∂q, ∂τ/∂ν and ∂τ/∂ν̇ = M.
//!
//! Coordinates are those of [`Tangent`] on both sides. A displacement of the base is taken in base axes
//! (R ← R exp δθ, p ← p + R δp), so that the base's own motion in base axes does not change with it:
//! columns of the base position are zero, and those of its orientation come from gravity alone, which
//! turns by −δθ × g as seen from the base.
//!
//! For two joints of which neither moves the other both derivatives are zero; for j an ancestor of i or
//! i itself (S, Ṡ, S̈, F, G and the responses are those of `sweep.rs`):
//!
//! | | q | ν | ν̇ |
//! |---|---|---|---|
//! | ∂τ_i/∂(·)_j | F_i·S̈_j + G_i·Ṡ_j | 2 F_i·Ṡ_j + G_i·S_j | F_i·S_j |
//! | ∂τ_j/∂(·)_i | S_j·∂f_i/∂q_i | S_j·∂f_i/∂q̇_i | the same |
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
use super::sweep::{Axis, Composite, Response, Sweep, Visit, sweep};
use crate::spatial::{Force, Motion};
use crate::state::{Effort, Posture, Tangent, basis};
use crate::tree::{At, Tree};

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

/// Scratch of the derivatives: axes and responses of every joint.
#[derive(Clone, Copy, Debug)]
pub struct DerivativesWorkspace<T, const N: usize> {
    pub(crate) axes: [Axis<T>; N],
    pub(crate) responses: [Response<T>; N],
}

impl<T: Scalar, const N: usize> DerivativesWorkspace<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            axes: [Axis::ZERO; N],
            responses: [Response::ZERO; N],
        }
    }
}

impl<T: Scalar, const N: usize> Default for DerivativesWorkspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

struct Pairs<'a, T: Scalar, const N: usize> {
    responses: &'a mut [Response<T>; N],
    out: &'a mut RneaDerivatives<T, N>,
    base_velocity: Motion<T>,
    gravity_b: Vector3<T>,
}

impl<T: Scalar, const N: usize> Visit<T> for Pairs<'_, T, N> {
    #[inline(always)]
    fn visit(&mut self, here: At<'_, T>, axis: &Axis<T>, subtree: &Composite<T>) {
        let i = here.index;
        let own = subtree.response(axis);
        put(self.responses, i, own);
        self.base_blocks(i, &own);

        let twice = axis.rate * T::TWO;
        let RneaDerivatives {
            by_position,
            by_velocity,
            by_acceleration,
        } = &mut *self.out;
        let descendants = self.responses.iter().enumerate().take(here.end).skip(i);
        for (j, below) in descendants {
            // Row j, column i first: on the diagonal both are the same but for rounding.
            let q = below.by_a_on(&axis.second) + below.coriolis.dot(&axis.rate.angular);
            let v = below.by_a_on(&twice) + below.coriolis.dot(&axis.axis.angular);
            set(&mut by_position.joints, j, i, q);
            set(&mut by_velocity.joints, j, i, v);
            let m = below.by_a_on(&axis.axis);
            set(&mut by_acceleration.joints, j, i, m);
            set(&mut by_acceleration.joints, i, j, m);
            set(&mut by_position.joints, i, j, axis.axis.dot(&below.by_q));
            set(&mut by_velocity.joints, i, j, axis.axis.dot(&below.by_v));
        }
        if let Some(x) = by_acceleration.joints.get_mut(i).and_then(|r| r.get_mut(i)) {
            *x += here.body.rotor_inertia;
        }
    }
}

impl<T: Scalar, const N: usize> Pairs<'_, T, N> {
    /// Row and column of joint i that belong to the base: with v and g those of the base, the base's
    /// axes have the rates v × e and, from gravity, −g × e.
    #[inline(always)]
    fn base_blocks(&mut self, i: usize, own: &Response<T>) {
        let turned = self.gravity_b.cross(&own.by_a.linear);
        let moved = -self.base_velocity.cross_force(&own.by_a);
        let out = &mut *self.out;
        let z = T::ZERO;
        put(
            &mut out.by_position.joints_base,
            i,
            [z, z, z, turned.x, turned.y, turned.z],
        );
        put(
            &mut out.by_velocity.joints_base,
            i,
            Force::new(moved.linear, moved.angular + own.coriolis).to_array(),
        );
        put(&mut out.by_acceleration.coupling, i, own.by_a);
        for (row, x) in out
            .by_position
            .base_joints
            .iter_mut()
            .zip(own.by_q.to_array())
        {
            put(row, i, x);
        }
        for (row, x) in out
            .by_velocity
            .base_joints
            .iter_mut()
            .zip(own.by_v.to_array())
        {
            put(row, i, x);
        }
    }
}

impl<T: Scalar> Response<T> {
    /// F·m.
    #[inline(always)]
    fn by_a_on(&self, m: &Motion<T>) -> T {
        m.dot(&self.by_a)
    }
}

#[inline(always)]
fn set<T: Copy, const N: usize>(m: &mut [[T; N]; N], i: usize, j: usize, x: T) {
    if let Some(slot) = m.get_mut(i).and_then(|row| row.get_mut(j)) {
        *slot = x;
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
    out.by_position.joints = [[T::ZERO; N]; N];
    out.by_velocity.joints = [[T::ZERO; N]; N];
    out.by_acceleration.joints = [[T::ZERO; N]; N];
    let mut fold = Sweep {
        posture,
        velocity: &velocity.joints,
        acceleration: &acceleration.joints,
        applied,
        axes: &mut ws.axes,
        visit: Pairs {
            responses: &mut ws.responses,
            out,
            base_velocity: velocity.base,
            gravity_b,
        },
    };
    let whole = sweep(model, &mut fold, &velocity.base, &lifted);

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
