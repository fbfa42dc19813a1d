//! The mass matrix: the composite-rigid-body algorithm.
//!
//! On the way up, the inertias of a subtree add up as if it were one rigid body. The force that gives
//! the subtree of joint i a unit acceleration, F_i = I_c S_i, then walks to the base; its component on
//! each joint j it passes is M_ij = S_j · F_i, and what arrives at the base is column i of the coupling
//! between base and joints (Featherstone 2008, chapter 6).

use nalgebra::SMatrix;
use so3::Scalar;

use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::spatial::{ArticulatedInertia, Force, Inertia};
use crate::state::{Effort, Posture, Tangent};
use crate::tree::{At, Fold, Nothing, Tree};

/// The joint-space mass matrix M(q), by blocks:
///
/// ```text
/// M = ⎡ base      coupling ⎤   6
///     ⎣ couplingᵀ joints   ⎦   N
/// ```
///
/// The base block is that of one rigid body: the whole robot with its joints locked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassMatrix<T, const N: usize> {
    /// The robot with locked joints, about the base's origin in base axes.
    pub base: Inertia<T>,
    /// Column i: wrench on the base that goes with a unit acceleration of joint i.
    pub coupling: [Force<T>; N],
    /// Symmetric; entries between joints of which neither moves the other are zero.
    pub joints: [[T; N]; N],
}

impl<T: Scalar, const N: usize> MassMatrix<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        base: Inertia::ZERO,
        coupling: [Force::ZERO; N],
        joints: [[T::ZERO; N]; N],
    };

    /// M ν: momentum at a velocity, effort at an acceleration.
    #[must_use]
    pub fn mul(&self, motion: &Tangent<T, N>) -> Effort<T, N> {
        let mut effort = Effort {
            base: self.base.mul(&motion.base),
            joints: [T::ZERO; N],
        };
        for (column, &x) in self.coupling.iter().zip(&motion.joints) {
            effort.base += *column * x;
        }
        for ((y, row), column) in effort
            .joints
            .iter_mut()
            .zip(&self.joints)
            .zip(&self.coupling)
        {
            let joints = row.iter().zip(&motion.joints);
            *y = joints.fold(motion.base.dot(column), |sum, (&m, &x)| sum + m * x);
        }
        effort
    }

    /// Kinetic energy ½ νᵀ M ν, J.
    #[must_use]
    pub fn kinetic_energy(&self, velocity: &Tangent<T, N>) -> T {
        velocity.dot(&self.mul(velocity)) * T::HALF
    }

    /// As one dense matrix, base first. `V` must be 6 + N; other sizes do not compile.
    #[must_use]
    pub fn to_dense<const V: usize>(&self) -> SMatrix<T, V, V> {
        const { assert!(V == 6 + N, "a mass matrix has 6 + N rows") };
        let mut m: SMatrix<T, V, V> = SMatrix::zeros();
        let locked = ArticulatedInertia::from(self.base);
        for (j, column) in crate::state::basis::<T>().iter().enumerate() {
            for (i, x) in locked.mul(column).to_array().into_iter().enumerate() {
                m[(i, j)] = x;
            }
        }
        for (j, (column, row)) in self.coupling.iter().zip(&self.joints).enumerate() {
            for (i, x) in column.to_array().into_iter().enumerate() {
                m[(i, 6 + j)] = x;
                m[(6 + j, i)] = x;
            }
            for (i, &x) in row.iter().enumerate() {
                m[(6 + i, 6 + j)] = x;
            }
        }
        m
    }
}

struct Crba<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    /// F_i on its way to the base.
    forces: &'a mut [Force<T>; N],
    joints: &'a mut [[T; N]; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Crba<'_, T, N> {
    type Down = Nothing;
    type Keep = Nothing;
    type Up = Inertia<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing) -> (Nothing, Nothing) {
        (Nothing, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        _: &Nothing,
        children: Inertia<T>,
    ) -> Inertia<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let composite = here.body.inertia() + children;
        let i = here.index;
        let sign = here.body.sign;
        put(self.forces, i, unit_force::<J, T>(&composite) * sign);
        for j in i..here.end {
            let force = at(self.forces, j);
            let entry = sign
                * J::component(if J::KIND.is_revolute() {
                    &force.angular
                } else {
                    &force.linear
                });
            if j == i {
                set(self.joints, i, i, entry + here.body.rotor_inertia);
            } else {
                set(self.joints, i, j, entry);
                set(self.joints, j, i, entry);
            }
            let linear = rotation.up(&force.linear);
            let angular = rotation.up(&force.angular) + offset.cross(&linear);
            put(self.forces, j, Force { linear, angular });
        }
        composite.assembled_up(&rotation, &offset)
    }
}

/// I_c S: the force that gives a rigid body unit acceleration along or about the joint's axis.
#[inline(always)]
pub(crate) fn unit_force<J: JointKind, T: Scalar>(body: &Inertia<T>) -> Force<T> {
    if J::KIND.is_revolute() {
        Force {
            linear: J::axis_cross(&body.first),
            angular: J::column(&body.rotational()),
        }
    } else {
        Force {
            linear: J::along_axis(nalgebra::Vector3::zeros(), body.mass),
            angular: -J::axis_cross(&body.first),
        }
    }
}

#[inline(always)]
fn set<T: Copy, const N: usize>(m: &mut [[T; N]; N], i: usize, j: usize, x: T) {
    if let Some(slot) = m.get_mut(i).and_then(|row| row.get_mut(j)) {
        *slot = x;
    }
}

impl<T: Scalar> Inertia<T> {
    /// This inertia in the parent's frame.
    #[inline(always)]
    pub(crate) fn assembled_up<R: JointRotation<T>>(
        &self,
        rotation: &R,
        offset: &nalgebra::Vector3<T>,
    ) -> Self {
        self.assembled(
            rotation.up(&self.first),
            rotation.up_symmetric(&self.second),
            offset,
        )
    }
}

/// The mass matrix M(q) of paper A eq. (4) (there H) and paper B eq. (1).
#[inline]
pub fn crba<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    out: &mut MassMatrix<T, N>,
) {
    out.joints = [[T::ZERO; N]; N];
    let MassMatrix {
        base,
        coupling,
        joints,
    } = out;
    let children = model.fold(
        &mut Crba {
            posture,
            forces: coupling,
            joints,
        },
        &Nothing,
    );
    *base = model.base().inertia() + children;
}
