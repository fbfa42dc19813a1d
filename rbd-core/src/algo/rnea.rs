//! Inverse dynamics: the recursive Newton–Euler algorithm.
//!
//! τ = M(q) ν̇ + C(q, ν) ν + g(q) − Σ Jᵀ f, the left side of paper A eq. (4) and of paper B eq. (1).
//!
//! In the form of Luh, Walker and Paul (1980): on the way down go angular velocity ω, angular
//! acceleration ω̇ and the classical acceleration a of the body's origin, gravity included, all in body
//! axes. With U = hat(ω̇) + hat(ω)² the acceleration field of the body is a + U r, hence
//!
//! - the child's origin at p: a' = Rᵀ(a + U p);
//! - force: f = m a + U h;
//! - moment about the origin: n = h × a + ax(U Σ − (U Σ)ᵀ), with Σ = ∫ r rᵀ dm;
//!
//! and forces add up on the way back. The linear velocity is not needed below the base.

use nalgebra::{Matrix3, Vector3};
use so3::{Scalar, math};

use super::gravity::gravity;
use super::{at, place, put};
use crate::abreast::abreast_as;
use crate::joint::{JointKind, JointRotation};
use crate::spatial::{Force, Inertia, Motion, add_cross, add_product};
use crate::state::{Effort, Posture, Tangent};
use crate::tree::{At, Fold, Tree};

/// How a body moves, as its children need it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<T> {
    pub(crate) omega: Vector3<T>,
    pub(crate) alpha: Vector3<T>,
    pub(crate) acceleration: Vector3<T>,
    /// U = hat(ω̇) + hat(ω)².
    pub(crate) gradient: Matrix3<T>,
}

abreast_as!(
    Field<T> => (Vector3<T>, (Vector3<T>, (Vector3<T>, Matrix3<T>))),
    |f| (f.omega, (f.alpha, (f.acceleration, f.gradient))),
    |(omega, (alpha, (acceleration, gradient)))| Self { omega, alpha, acceleration, gradient }
);

impl<T: Scalar> Field<T> {
    #[inline(always)]
    pub(crate) fn new(omega: Vector3<T>, alpha: Vector3<T>, acceleration: Vector3<T>) -> Self {
        let (xx, yy, zz) = (omega.x * omega.x, omega.y * omega.y, omega.z * omega.z);
        let (xy, xz, yz) = (omega.x * omega.y, omega.x * omega.z, omega.y * omega.z);
        let gradient = Matrix3::new(
            -(yy + zz),
            xy - alpha.z,
            xz + alpha.y,
            xy + alpha.z,
            -(xx + zz),
            yz - alpha.x,
            xz - alpha.y,
            yz + alpha.x,
            -(xx + yy),
        );
        Self {
            omega,
            alpha,
            acceleration,
            gradient,
        }
    }

    /// Field of the body behind a joint, from that of its parent.
    #[inline(always)]
    pub(crate) fn child<J: JointKind>(
        &self,
        rotation: &J::Rotation<T>,
        offset: &Vector3<T>,
        qd: T,
        qdd: T,
    ) -> Self {
        let omega = rotation.down(&self.omega);
        let alpha = rotation.down(&self.alpha);
        let acceleration = rotation.down(&add_product(&self.acceleration, &self.gradient, offset));
        if J::KIND.is_revolute() {
            let alpha = J::add_cross_axis(J::along_axis(alpha, qdd), &omega, qd);
            Self::new(J::along_axis(omega, qd), alpha, acceleration)
        } else {
            // The body slides in a turning frame: Coriolis acceleration 2 ω × ṗ.
            let coriolis = J::add_cross_axis(acceleration, &omega, qd + qd);
            Self::new(omega, alpha, J::along_axis(coriolis, qdd))
        }
    }

    /// Field of the base: gravity enters as an acceleration of the world the other way.
    #[inline(always)]
    pub(crate) fn base<const N: usize>(
        posture: &Posture<T, N>,
        velocity: &Motion<T>,
        acceleration: &Motion<T>,
        gravity_w: &Vector3<T>,
    ) -> Self {
        let gravity_b = posture.base.rotation.matrix().tr_mul(gravity_w);
        let a = acceleration.to_classical(velocity);
        Self::new(velocity.angular, a.angular, a.linear - gravity_b)
    }

    /// Force that gives a body this motion.
    #[inline(always)]
    pub(crate) fn force(&self, body: &Inertia<T>) -> Force<T> {
        let (u, s) = (&self.gradient, &body.second);
        // Rows of U Σ that the axial part of U Σ needs.
        let row =
            |a: T, b: T, c: T, x: T, y: T, z: T| math::mul_add(c, z, math::mul_add(b, y, a * x));
        let moment = Vector3::new(
            row(u.m31, u.m32, u.m33, s.xy, s.yy, s.yz) - row(u.m21, u.m22, u.m23, s.xz, s.yz, s.zz),
            row(u.m11, u.m12, u.m13, s.xz, s.yz, s.zz) - row(u.m31, u.m32, u.m33, s.xx, s.xy, s.xz),
            row(u.m21, u.m22, u.m23, s.xx, s.xy, s.xz) - row(u.m11, u.m12, u.m13, s.xy, s.yy, s.yz),
        );
        Force {
            linear: add_product(&(self.acceleration * body.mass), u, &body.first),
            angular: add_cross(&moment, &body.first, &self.acceleration),
        }
    }
}

struct Rnea<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    velocity: &'a [T; N],
    /// `None` stands for zero.
    acceleration: Option<&'a [T; N]>,
    /// Forces applied to the bodies, each in its body's frame; `None` stands for zero.
    applied: Option<&'a [Force<T>; N]>,
    effort: &'a mut [T; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Rnea<'_, T, N> {
    type Down = Field<T>;
    /// Force that the body itself takes.
    type Keep = Force<T>;
    type Up = Force<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Field<T>) -> (Field<T>, Force<T>) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let sign = here.body.sign;
        let qd = at(self.velocity, here.index) * sign;
        let qdd = self
            .acceleration
            .map_or(T::ZERO, |x| at(x, here.index) * sign);

        let field = up.child::<J>(&rotation, &offset, qd, qdd);
        let mut force = field.force(&here.body.inertia());
        if let Some(applied) = self.applied {
            force = force - at(applied, here.index);
        }
        (field, force)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        own: &Force<T>,
        children: Force<T>,
    ) -> Force<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let force = *own + children;
        let along = J::component(if J::KIND.is_revolute() {
            &force.angular
        } else {
            &force.linear
        });
        let rotor = at_rotor(self.acceleration, here);
        put(self.effort, here.index, along * here.body.sign + rotor);
        let linear = rotation.up(&force.linear);
        Force {
            linear,
            angular: add_cross(&rotation.up(&force.angular), &offset, &linear),
        }
    }
}

/// Torque that turns the rotor behind the gear.
#[inline(always)]
fn at_rotor<T: Scalar, const N: usize>(acceleration: Option<&[T; N]>, here: At<'_, T>) -> T {
    acceleration.map_or(T::ZERO, |x| at(x, here.index) * here.body.rotor_inertia)
}

/// Everything that can be switched off at compile time passes through here. The base of the effort is what the limbs
/// ask of the base; the field is the base's, for what the base asks for itself.
#[inline(always)]
pub(crate) fn reactions<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: Option<&Tangent<T, N>>,
    gravity_w: &Vector3<T>,
    applied: Option<(&Force<T>, &[Force<T>; N])>,
) -> (Field<T>, Effort<T, N>) {
    let a = acceleration.map_or(Motion::ZERO, |a| a.base);
    let field = Field::base(posture, &velocity.base, &a, gravity_w);
    let mut joints = [T::ZERO; N];
    let mut fold = Rnea {
        posture,
        velocity: &velocity.joints,
        acceleration: acceleration.map(|a| &a.joints),
        applied: applied.map(|f| f.1),
        effort: &mut joints,
    };
    let base = model.fold(&mut fold, &field);
    (field, Effort { base, joints })
}

/// The effort of the whole robot, base included.
#[inline(always)]
fn sweep<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: Option<&Tangent<T, N>>,
    gravity_w: &Vector3<T>,
    applied: Option<(&Force<T>, &[Force<T>; N])>,
) -> Effort<T, N> {
    let (field, mut effort) = reactions(model, posture, velocity, acceleration, gravity_w, applied);
    effort.base = field.force(&model.base().inertia()) + effort.base;
    if let Some((applied, _)) = applied {
        effort.base = effort.base - *applied;
    }
    effort
}

/// Inverse dynamics: the effort that causes an acceleration, τ = M ν̇ + C ν + g.
///
/// Shapes: N joints; base wrench in base axes about the base's origin. For a fixed base, the base
/// entries of `velocity` and `acceleration` should be zero and the base wrench is the reaction of the
/// ground. Includes the rotors' inertia, but no friction (see
/// [`joint_friction`](crate::algo::friction::joint_friction)).
///
/// Source: Luh, Walker, Paul 1980; Featherstone 2008, chapter 5; paper A eq. (4).
#[inline]
#[must_use]
pub fn rnea<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
) -> Effort<T, N> {
    sweep(
        model,
        posture,
        velocity,
        Some(acceleration),
        &gravity(),
        None,
    )
}

/// Inverse dynamics with forces applied from outside: τ = M ν̇ + C ν + g − Σ Jᵀ f.
///
/// `base_force` acts on the base in base axes about its origin; `forces[i]` on body i in its canonical
/// frame about its origin; a force known in the world is brought there by
/// [`Transform::inverse_force`](crate::Transform::inverse_force) of the body's pose.
#[inline]
#[must_use]
pub fn rnea_with_forces<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    base_force: &Force<T>,
    forces: &[Force<T>; N],
) -> Effort<T, N> {
    let applied = Some((base_force, forces));
    sweep(
        model,
        posture,
        velocity,
        Some(acceleration),
        &gravity(),
        applied,
    )
}

/// Coriolis, centrifugal and gravity terms, C(q, ν) ν + g(q): the effort at zero acceleration.
#[inline]
#[must_use]
pub fn nonlinear_effects<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
) -> Effort<T, N> {
    sweep(model, posture, velocity, None, &gravity(), None)
}
