//! Forward dynamics: the articulated-body algorithm.
//!
//! One way in and one way out. On the way down goes the motion that the bodies would have at zero
//! generalised acceleration, as in [`rnea`](super::rnea), and gives each body its bias force. On the way up
//! each subtree appears as an articulated inertia A and a force p; at joint i with U = A S,
//! D = Sᵀ U + rotor and u = τ_i − Sᵀ p the parent feels A − U Uᵀ/D and p + U u/D. On the way out a is the
//! *additional* acceleration, ν̇_i = (u − Uᵀ a)/D (Featherstone 2008, chapter 7). With the bias in the
//! forces, the articulated recursion itself has no velocity terms, and the same code solves M x = b.

use nalgebra::Vector3;
use so3::Scalar;

use super::gravity::gravity;
use super::rnea::Field;
use super::{at, place, put};
use crate::abreast::abreast_as;
use crate::joint::{JointKind, JointRotation};
use crate::model::BaseKind;
use crate::spatial::{ArticulatedInertia, Force, Motion, add_cross};
use crate::state::{Effort, Posture, Tangent};
use crate::tree::{At, Fold, Nothing, Tree};

/// Scratch of [`aba`]: U, 1/D and u of every joint.
#[derive(Clone, Copy, Debug)]
pub struct AbaWorkspace<T, const N: usize> {
    joints: [Pivot<T>; N],
}

#[derive(Clone, Copy, Debug)]
struct Pivot<T> {
    /// U = A S, force in the body's frame.
    force: Force<T>,
    /// 1/D.
    inverse: T,
    /// u/D.
    drive: T,
}

impl<T: Scalar> Default for Pivot<T> {
    fn default() -> Self {
        Self {
            force: Force::ZERO,
            inverse: T::ZERO,
            drive: T::ZERO,
        }
    }
}

impl<T: Scalar, const N: usize> AbaWorkspace<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            joints: [Pivot {
                force: Force::ZERO,
                inverse: T::ZERO,
                drive: T::ZERO,
            }; N],
        }
    }
}

impl<T: Scalar, const N: usize> Default for AbaWorkspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// What a subtree looks like from its parent.
#[derive(Clone, Copy, Debug, Default)]
struct Articulated<T: Scalar> {
    inertia: ArticulatedInertia<T>,
    bias: Force<T>,
}

abreast_as!(
    Articulated<T> => (ArticulatedInertia<T>, Force<T>),
    |a| (a.inertia, a.bias),
    |(inertia, bias)| Self { inertia, bias }
);

impl<T: Scalar> core::ops::Add for Articulated<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            inertia: self.inertia + o.inertia,
            bias: self.bias + o.bias,
        }
    }
}

struct Inward<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    /// Joint velocities; `None` when the robot is at rest and weightless.
    velocity: Option<&'a [T; N]>,
    /// Forces applied to the bodies, each in its body's frame; `None` stands for zero.
    applied: Option<&'a [Force<T>; N]>,
    effort: &'a [T; N],
    joints: &'a mut [Pivot<T>; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Inward<'_, T, N> {
    const LONG: bool = true;
    type Down = Field<T>;
    /// Bias force of the body.
    type Keep = Force<T>;
    type Up = Articulated<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Field<T>) -> (Field<T>, Force<T>) {
        let Some(velocity) = self.velocity else {
            return (*up, Force::ZERO);
        };
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let qd = at(velocity, here.index) * here.body.sign;
        let field = up.child::<J>(&rotation, &offset, qd, T::ZERO);
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
        children: Articulated<T>,
    ) -> Articulated<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let whole = children.inertia.with(&here.body.inertia());
        let bias = *own + children.bias;
        let (force, along, felt) = if J::KIND.is_revolute() {
            let angular = J::column(&whole.angular);
            let force = Force {
                linear: J::matrix_column(&whole.cross),
                angular,
            };
            (force, J::component(&angular), J::component(&bias.angular))
        } else {
            let linear = J::column(&whole.linear);
            let force = Force {
                linear,
                angular: J::matrix_row(&whole.cross),
            };
            (force, J::component(&linear), J::component(&bias.linear))
        };
        let pivot = along + here.body.rotor_inertia;
        let inverse = if pivot > T::ZERO {
            T::ONE / pivot
        } else {
            T::ZERO
        };
        let drive = (at(self.effort, here.index) * here.body.sign - felt) * inverse;
        put(
            self.joints,
            here.index,
            Pivot {
                force,
                inverse,
                drive,
            },
        );

        let rest = whole.without(&force, inverse);
        let bias = bias.plus(&force, drive);
        let turned = ArticulatedInertia {
            linear: rotation.up_symmetric(&rest.linear),
            cross: rotation.up_matrix(&rest.cross),
            angular: rotation.up_symmetric(&rest.angular),
        };
        let linear = rotation.up(&bias.linear);
        Articulated {
            inertia: turned.shifted(&offset),
            bias: Force {
                linear,
                angular: add_cross(&rotation.up(&bias.angular), &offset, &linear),
            },
        }
    }
}

struct Outward<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    joints: &'a [Pivot<T>; N],
    acceleration: &'a mut [T; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Outward<'_, T, N> {
    type Down = Motion<T>;
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Motion<T>) -> (Motion<T>, Nothing) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let moved = Motion {
            linear: rotation.down(&add_cross(&up.linear, &up.angular, &offset)),
            angular: rotation.down(&up.angular),
        };
        let pivot = at(self.joints, here.index);
        let qdd = pivot.drive - moved.dot(&pivot.force) * pivot.inverse;
        put(self.acceleration, here.index, qdd * here.body.sign);
        let own = if J::KIND.is_revolute() {
            Motion {
                angular: J::along_axis(moved.angular, qdd),
                ..moved
            }
        } else {
            Motion {
                linear: J::along_axis(moved.linear, qdd),
                ..moved
            }
        };
        (own, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing, _: Nothing) -> Nothing {
        Nothing
    }
}

/// The way in, the base, and the way out.
#[inline(always)]
fn accelerate<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    mut inward: Inward<'_, T, N>,
    base_motion: &Field<T>,
    base_bias: &Force<T>,
    base_effort: &Force<T>,
) -> Tangent<T, N> {
    let children = model.fold(&mut inward, base_motion);
    let base = match model.base_kind() {
        BaseKind::Floating => {
            let whole = ArticulatedInertia::from(model.base().inertia()) + children.inertia;
            whole.solve(&(*base_effort - children.bias - *base_bias))
        }
        BaseKind::Fixed => Motion::ZERO,
    };
    let Inward {
        posture, joints, ..
    } = inward;
    let mut acceleration = [T::ZERO; N];
    let mut outward = Outward {
        posture,
        joints,
        acceleration: &mut acceleration,
    };
    model.fold(&mut outward, &base);
    Tangent {
        base,
        joints: acceleration,
    }
}

/// Forward dynamics: the acceleration ν̇ = M⁻¹(τ − C ν − g) under an effort.
///
/// `effort.base` is the wrench applied to the base (zero for a free robot). Joint friction is not
/// included: add [`joint_friction`](crate::joint_friction) to `effort` (paper A eq. (4) has it as
/// B_fric τ_fric). A joint that carries no inertia at all does not accelerate.
#[inline(never)]
#[must_use]
pub fn aba<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    forward(model, posture, velocity, effort, None, ws)
}

/// Forward dynamics with forces applied from outside, each in its body's canonical frame: see
/// [`rnea_with_forces`](crate::rnea_with_forces). A force on the base belongs in `effort.base`.
#[inline(never)]
#[must_use]
pub fn aba_with_forces<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    forces: &[Force<T>; N],
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    forward(model, posture, velocity, effort, Some(forces), ws)
}

/// Its callers are out of line: only there do compilers know that the workspace is no part of what is read, without which
/// they do not take limbs abreast (A1: 0.5 instead of 0.85 µs).
#[inline(always)]
fn forward<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    applied: Option<&[Force<T>; N]>,
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    let field = Field::base(posture, &velocity.base, &Motion::ZERO, &gravity());
    let bias = field.force(&model.base().inertia());
    let inward = Inward {
        posture,
        velocity: Some(&velocity.joints),
        applied,
        effort: &effort.joints,
        joints: &mut ws.joints,
    };
    accelerate(model, inward, &field, &bias, &effort.base)
}

/// Solves M(q) x = b without forming M.
#[inline(never)]
#[must_use]
pub fn mass_solve<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    b: &Effort<T, N>,
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    let zero = Vector3::zeros();
    let inward = Inward {
        posture,
        velocity: None,
        applied: None,
        effort: &b.joints,
        joints: &mut ws.joints,
    };
    accelerate(
        model,
        inward,
        &Field::new(zero, zero, zero),
        &Force::ZERO,
        &b.base,
    )
}
