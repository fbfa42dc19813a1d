//! What all derivatives share: joint axes with their rates, and composites of subtrees, in base axes.
//!
//! Everything is expressed in the base's axes about its origin, so that nothing is transformed on the
//! way through the tree. For the joint of body i, with v and a the velocity and acceleration of body i:
//!
//! - S, the axis; Ṡ = v × S, how it moves; S̈ = a × S + v × Ṡ.
//! - I, h, Σ: mass moments of the subtree; f = Σ (I a + v ×* I v) − Σ f_ext its net force;
//! - p = ∫ ṙ dm and K = ∫ ṙ rᵀ dm: a rotation rate w of the whole subtree, on top of what it already
//!   does, adds the Coriolis acceleration 2 w × ṙ to every particle, hence the wrench
//!   B w = (2 w × p, 2 (tr(K) 1 − K) w).
//!
//! This B is twice the matrix B^C of Singh, Russell, Wensing 2022 ("Efficient analytical derivatives of
//! rigid-body dynamics using spatial vector algebra", RA-L); only its three rotational columns are
//! not zero. With them the force on the subtree of i changes, per unit of q_i, q̇_i and q̈_i, by
//!
//! - `by_q` = I S̈ + B Ṡ + S ×* f,
//! - `by_v` = 2 I Ṡ + B S,
//! - `by_a` = I S,
//!
//! and the effort of i, when an ancestor j moves, by F·S̈_j + G·Ṡ_j, 2 F·Ṡ_j + G·S_j and F·S_j, with
//! F = I S (`by_a`) and G = Bᵀ S (`coriolis`).

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::spatial::{Force, Inertia, Motion};
use crate::state::Posture;
use crate::tree::{At, Fold, Tree};

/// Axis of a joint and its first two rates of change; all zero for a joint that the model does not have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<T> {
    /// S.
    pub(crate) axis: Motion<T>,
    /// Ṡ.
    pub(crate) rate: Motion<T>,
    /// S̈.
    pub(crate) second: Motion<T>,
}

impl<T: Scalar> Axis<T> {
    pub(crate) const ZERO: Self = Self {
        axis: Motion::ZERO,
        rate: Motion::ZERO,
        second: Motion::ZERO,
    };
}

/// How the force on a subtree answers to its own joint, and the joint to its ancestors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response<T> {
    /// ∂f/∂q of the joint, the rest at rest.
    pub(crate) by_q: Force<T>,
    /// ∂f/∂q̇.
    pub(crate) by_v: Force<T>,
    /// ∂f/∂q̈ = F.
    pub(crate) by_a: Force<T>,
    /// G.
    pub(crate) coriolis: Vector3<T>,
}

impl<T: Scalar> Response<T> {
    pub(crate) const ZERO: Self = Self {
        by_q: Force::ZERO,
        by_v: Force::ZERO,
        by_a: Force::ZERO,
        coriolis: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
    };
}

/// A subtree moving as it does, in base axes about the base's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Composite<T> {
    /// Mass moments.
    pub(crate) inertia: Inertia<T>,
    /// p = ∫ ṙ dm.
    pub(crate) momentum: Vector3<T>,
    /// K = ∫ ṙ rᵀ dm.
    pub(crate) stir: Matrix3<T>,
    /// f: net force, without what acts from outside.
    pub(crate) force: Force<T>,
}

impl<T: Scalar> Default for Composite<T> {
    fn default() -> Self {
        Self {
            inertia: Inertia::ZERO,
            momentum: Vector3::zeros(),
            stir: Matrix3::zeros(),
            force: Force::ZERO,
        }
    }
}

impl<T: Scalar> core::ops::Add for Composite<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            inertia: self.inertia + o.inertia,
            momentum: self.momentum + o.momentum,
            stir: self.stir + o.stir,
            force: self.force + o.force,
        }
    }
}

impl<T: Scalar> Composite<T> {
    /// One rigid body with this velocity and (spatial) acceleration.
    #[inline(always)]
    pub(crate) fn of(inertia: Inertia<T>, v: &Motion<T>, a: &Motion<T>) -> Self {
        let (h, s, w) = (&inertia.first, &inertia.second, &v.angular);
        let momentum = v.linear * inertia.mass + w.cross(h);
        // K = ∫ (v + ω × r) rᵀ dm
        let stir = Matrix3::new(
            v.linear.x * h.x + (w.y * s.xz - w.z * s.xy),
            v.linear.x * h.y + (w.y * s.yz - w.z * s.yy),
            v.linear.x * h.z + (w.y * s.zz - w.z * s.yz),
            v.linear.y * h.x + (w.z * s.xx - w.x * s.xz),
            v.linear.y * h.y + (w.z * s.xy - w.x * s.yz),
            v.linear.y * h.z + (w.z * s.xz - w.x * s.zz),
            v.linear.z * h.x + (w.x * s.xy - w.y * s.xx),
            v.linear.z * h.y + (w.x * s.yy - w.y * s.xy),
            v.linear.z * h.z + (w.x * s.yz - w.y * s.xz),
        );
        let mut own = Self {
            inertia,
            momentum,
            stir,
            force: inertia.mul(a),
        };
        own.force += v.cross_force(&own.momentum_wrench());
        own
    }

    /// Momentum about the base's origin; its angular part is the axial part of K: ∫ r × ṙ dm.
    #[inline(always)]
    pub(crate) fn momentum_wrench(&self) -> Force<T> {
        let k = &self.stir;
        Force {
            linear: self.momentum,
            angular: Vector3::new(k.m32 - k.m23, k.m13 - k.m31, k.m21 - k.m12),
        }
    }

    /// B w: wrench of the Coriolis forces when the whole turns with w besides.
    #[inline(always)]
    pub(crate) fn coriolis(&self, w: &Vector3<T>) -> Force<T> {
        let trace = self.stir.m11 + self.stir.m22 + self.stir.m33;
        let moment = w * trace - self.stir * w;
        Force {
            linear: w.cross(&self.momentum) * T::TWO,
            angular: moment * T::TWO,
        }
    }

    /// Bᵀ m.
    #[inline(always)]
    pub(crate) fn coriolis_transposed(&self, m: &Motion<T>) -> Vector3<T> {
        let trace = self.stir.m11 + self.stir.m22 + self.stir.m33;
        let moment = m.angular * trace - self.stir.tr_mul(&m.angular);
        (self.momentum.cross(&m.linear) + moment) * T::TWO
    }

    /// What the force on this subtree does when its joint moves.
    #[inline(always)]
    pub(crate) fn response(&self, joint: &Axis<T>) -> Response<T> {
        let twice = joint.rate * T::TWO;
        Response {
            by_q: self.inertia.mul(&joint.second)
                + self.coriolis(&joint.rate.angular)
                + joint.axis.cross_force(&self.force),
            by_v: self.inertia.mul(&twice) + self.coriolis(&joint.axis.angular),
            by_a: self.inertia.mul(&joint.axis),
            coriolis: self.coriolis_transposed(&joint.axis),
        }
    }
}

/// Where a body is in the base's axes, and how it moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving<T> {
    rotation: Matrix3<T>,
    origin: Vector3<T>,
    velocity: Motion<T>,
    acceleration: Motion<T>,
}

impl<T: Scalar> Moving<T> {
    /// The base itself, with gravity as an upward acceleration where it counts.
    #[inline(always)]
    pub(crate) fn base(velocity: &Motion<T>, acceleration: &Motion<T>) -> Self {
        Self {
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
            velocity: *velocity,
            acceleration: *acceleration,
        }
    }

    /// The body that a joint carries, and the joint's axis.
    #[inline(always)]
    fn step<J: JointKind, const N: usize>(
        &self,
        here: At<'_, T>,
        posture: &Posture<T, N>,
        qd: T,
        qdd: T,
    ) -> (Self, Axis<T>) {
        let (turn, offset) = place::<J, T, N>(here, posture);
        let rotation = turn.after(&self.rotation);
        let origin = self.origin + self.rotation * offset;
        let sign = here.body.sign;
        let z = match J::KIND.axis() {
            0 => Vector3::new(rotation.m11, rotation.m21, rotation.m31),
            1 => Vector3::new(rotation.m12, rotation.m22, rotation.m32),
            _ => Vector3::new(rotation.m13, rotation.m23, rotation.m33),
        } * sign;
        let axis = if J::KIND.is_revolute() {
            Motion::new(origin.cross(&z), z)
        } else {
            Motion::new(z, Vector3::zeros())
        };
        let velocity = self.velocity + axis * qd;
        let rate = velocity.cross(&axis);
        let acceleration = self.acceleration + axis * qdd + rate * qd;
        let joint = Axis {
            axis,
            rate,
            second: acceleration.cross(&axis) + velocity.cross(&rate),
        };
        let body = Self {
            rotation,
            origin,
            velocity,
            acceleration,
        };
        (body, joint)
    }

    /// An inertia given in this body's frame, in the base's.
    #[inline(always)]
    fn carried(&self, inertia: &Inertia<T>) -> Inertia<T> {
        let r = &self.rotation;
        inertia.assembled(r * inertia.first, inertia.second.rotated(r), &self.origin)
    }

    /// A force given in this body's frame, in the base's.
    #[inline(always)]
    fn force(&self, force: &Force<T>) -> Force<T> {
        let linear = self.rotation * force.linear;
        Force {
            linear,
            angular: self.rotation * force.angular + self.origin.cross(&linear),
        }
    }
}

/// One pass over the tree: axes on the way down, composites and responses on the way up; `pair` is told
/// of every joint when its whole subtree is known.
pub(crate) struct Sweep<'a, T: Scalar, V: Visit<T>, const N: usize> {
    pub(crate) posture: &'a Posture<T, N>,
    pub(crate) velocity: &'a [T; N],
    pub(crate) acceleration: &'a [T; N],
    pub(crate) applied: Option<&'a [Force<T>; N]>,
    pub(crate) axes: &'a mut [Axis<T>; N],
    pub(crate) visit: V,
}

/// What to do with the subtree of a joint.
pub(crate) trait Visit<T: Scalar> {
    /// Joint `here`, its axis and its subtree.
    fn visit(&mut self, here: At<'_, T>, axis: &Axis<T>, subtree: &Composite<T>);
}

impl<T: Scalar, V: Visit<T>, const N: usize> Fold<T> for Sweep<'_, T, V, N> {
    type Down = Moving<T>;
    type Keep = Composite<T>;
    type Up = Composite<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Moving<T>) -> (Moving<T>, Composite<T>) {
        let i = here.index;
        let (qd, qdd) = (at(self.velocity, i), at(self.acceleration, i));
        let (body, axis) = up.step::<J, N>(here, self.posture, qd, qdd);
        put(self.axes, i, axis);
        let inertia = body.carried(&here.body.inertia());
        let mut own = Composite::of(inertia, &body.velocity, &body.acceleration);
        if let Some(applied) = self.applied {
            own.force = own.force - body.force(&at(applied, i));
        }
        (body, own)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        own: &Composite<T>,
        children: Composite<T>,
    ) -> Composite<T> {
        let subtree = *own + children;
        if let Some(axis) = self.axes.get(here.index) {
            let axis = *axis;
            self.visit.visit(here, &axis, &subtree);
        }
        subtree
    }
}

/// Runs the sweep over a robot whose base moves so; returns the composite of the whole robot.
#[inline(always)]
pub(crate) fn sweep<T: Scalar, M: Tree<T, N>, V: Visit<T>, const N: usize>(
    model: &M,
    fold: &mut Sweep<'_, T, V, N>,
    velocity: &Motion<T>,
    acceleration: &Motion<T>,
) -> Composite<T> {
    let children = model.fold(fold, &Moving::base(velocity, acceleration));
    Composite::of(model.base().inertia(), velocity, acceleration) + children
}
