//! Forward dynamics: the articulated-body algorithm, as a bias and a sweep.
//!
//! With c = C ν + g − Σ Jᵀ f from one inverse-dynamics sweep at zero acceleration, M ν̇ = τ − c is
//! solved without forming M: on the way up each subtree appears as an articulated inertia A and a bias
//! force p; at joint i with U = A S, D = Sᵀ U + rotor, u = τ_i − c_i − Sᵀ p the parent feels
//! A − U Uᵀ/D and p + U u/D; on the way down ν̇_i = (u − Uᵀ a)/D (Featherstone 2008, chapter 7).
//! Splitting the velocity terms off makes the sweep cheaper and serves M⁻¹ as well.

use so3::Scalar;

use super::rnea::{gravity, sweep};
use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::model::BaseKind;
use crate::spatial::{ArticulatedInertia, Force, Motion};
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
    /// τ − c.
    drive: &'a [T; N],
    joints: &'a mut [Pivot<T>; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Inward<'_, T, N> {
    type Down = Nothing;
    type Keep = Nothing;
    type Up = Articulated<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing) -> (Nothing, Nothing) {
        (Nothing, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        _: &Nothing,
        children: Articulated<T>,
    ) -> Articulated<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let whole = ArticulatedInertia::from(here.body.inertia()) + children.inertia;
        let (force, along, bias) = if J::KIND.is_revolute() {
            let angular = J::column(&whole.angular);
            let force = Force {
                linear: J::matrix_column(&whole.cross),
                angular,
            };
            (
                force,
                J::component(&angular),
                J::component(&children.bias.angular),
            )
        } else {
            let linear = J::column(&whole.linear);
            let force = Force {
                linear,
                angular: J::matrix_row(&whole.cross),
            };
            (
                force,
                J::component(&linear),
                J::component(&children.bias.linear),
            )
        };
        let pivot = along + here.body.rotor_inertia;
        let inverse = if pivot > T::ZERO {
            T::ONE / pivot
        } else {
            T::ZERO
        };
        let drive = (at(self.drive, here.index) * here.body.sign - bias) * inverse;
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
        let bias = children.bias + force * drive;
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
                angular: rotation.up(&bias.angular) + offset.cross(&linear),
            },
        }
    }
}

struct Outward<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    joints: &'a [Pivot<T>; N],
    acceleration: [T; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Outward<'_, T, N> {
    type Down = Motion<T>;
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Motion<T>) -> (Motion<T>, Nothing) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let moved = Motion {
            linear: rotation.down(&(up.linear + up.angular.cross(&offset))),
            angular: rotation.down(&up.angular),
        };
        let pivot = at(self.joints, here.index);
        let qdd = pivot.drive - moved.dot(&pivot.force) * pivot.inverse;
        put(&mut self.acceleration, here.index, qdd * here.body.sign);
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

/// Solves M(q) x = b by the articulated sweep.
#[inline(always)]
pub(crate) fn solve<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    ws: &mut AbaWorkspace<T, N>,
    b: &Effort<T, N>,
) -> Tangent<T, N> {
    let mut inward = Inward {
        posture,
        drive: &b.joints,
        joints: &mut ws.joints,
    };
    let children = model.fold(&mut inward, &Nothing);
    let base = match model.base_kind() {
        BaseKind::Floating => {
            let whole = ArticulatedInertia::from(model.base().inertia()) + children.inertia;
            whole.solve(&(b.base - children.bias))
        }
        BaseKind::Fixed => Motion::ZERO,
    };
    let mut outward = Outward {
        posture,
        joints: &ws.joints,
        acceleration: [T::ZERO; N],
    };
    model.fold(&mut outward, &base);
    Tangent {
        base,
        joints: outward.acceleration,
    }
}

/// Forward dynamics: the acceleration ν̇ = M⁻¹(τ − C ν − g) under an effort.
///
/// `effort.base` is the wrench applied to the base (zero for a free robot). Joint friction is not
/// included: subtract it from `effort` (paper A eq. (4) has it as B_fric τ_fric).
///
/// A joint that carries no inertia at all does not accelerate.
#[inline]
#[must_use]
pub fn aba<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    let bias = sweep(model, posture, Some(velocity), None, &gravity(), None);
    let mut drive = Effort {
        base: effort.base - bias.base,
        joints: effort.joints,
    };
    for (x, y) in drive.joints.iter_mut().zip(bias.joints) {
        *x -= y;
    }
    solve(model, posture, ws, &drive)
}

/// Forward dynamics with forces applied from outside, each in its body's canonical frame: see
/// [`rnea_with_forces`](crate::rnea_with_forces).
#[inline]
#[must_use]
pub fn aba_with_forces<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    effort: &Effort<T, N>,
    forces: &[Force<T>; N],
    ws: &mut AbaWorkspace<T, N>,
) -> Tangent<T, N> {
    let none = Force::ZERO;
    let bias = sweep(
        model,
        posture,
        Some(velocity),
        None,
        &gravity(),
        Some((&none, forces)),
    );
    let mut drive = Effort {
        base: effort.base - bias.base,
        joints: effort.joints,
    };
    for (x, y) in drive.joints.iter_mut().zip(bias.joints) {
        *x -= y;
    }
    solve(model, posture, ws, &drive)
}
