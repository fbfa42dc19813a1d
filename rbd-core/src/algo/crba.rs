//! The mass matrix: the composite-rigid-body algorithm.
//!
//! On the way up, the inertias of a subtree add up as if it were one rigid body. The force that gives
//! the subtree of joint i a unit acceleration, F_i = I_c S_i, then walks to the base; its component on
//! each joint j it passes is M_ij = S_j · F_i, and what arrives at the base is column i of the coupling
//! between base and joints (Featherstone 2008, chapter 6).

use nalgebra::{SMatrix, Vector3};
use so3::Scalar;

use super::table::{set_window, window};
use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::spatial::{ArticulatedInertia, Force, Inertia, add_cross};
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
    /// F_i on its way to the base, by components, so that several walk at once.
    forces: &'a mut [[T; N]; 6],
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
        let own = unit_force::<J, T>(&composite) * sign;
        for (row, x) in self.forces.iter_mut().zip(own.to_array()) {
            put(row, i, x);
        }
        // Counted from the tip, so that joint after joint loads the lanes together that the last one stored together.
        let mut j = here.end;
        while j >= i + LANES {
            j -= LANES;
            self.pass::<J, LANES>(i, j, sign, &rotation, &offset);
        }
        while j > i {
            j -= 1;
            self.pass::<J, 1>(i, j, sign, &rotation, &offset);
        }
        if let Some(x) = self.joints.get_mut(i).and_then(|row| row.get_mut(i)) {
            *x += here.body.rotor_inertia;
        }
        composite.assembled_up(&rotation, &offset)
    }
}

/// Forces that pass a joint at once, where that many remain.
const LANES: usize = 4;

impl<T: Scalar, const N: usize> Crba<'_, T, N> {
    /// Takes the forces of joints `j .. j + L` past joint `i`: their components on it, and they themselves to the
    /// parent's frame.
    #[inline(always)]
    fn pass<J: JointKind, const L: usize>(
        &mut self,
        i: usize,
        j: usize,
        sign: T,
        rotation: &J::Rotation<T>,
        offset: &Vector3<T>,
    ) {
        let mut force = [[T::ZERO; L]; 6];
        for (to, from) in force.iter_mut().zip(self.forces.iter()) {
            *to = window(from, j);
        }
        let mut entries = [T::ZERO; L];
        let [fx, fy, fz, mx, my, mz] = &mut force;
        for l in 0..L {
            let linear = Vector3::new(fx[l], fy[l], fz[l]);
            let angular = Vector3::new(mx[l], my[l], mz[l]);
            let part = if J::KIND.is_revolute() {
                &angular
            } else {
                &linear
            };
            entries[l] = sign * J::component(part);
            let linear = rotation.up(&linear);
            let angular = add_cross(&rotation.up(&angular), offset, &linear);
            [fx[l], fy[l], fz[l]] = linear.into();
            [mx[l], my[l], mz[l]] = angular.into();
        }
        for (to, from) in self.forces.iter_mut().zip(&force) {
            set_window(to, j, from);
        }
        if let Some(row) = self.joints.get_mut(i) {
            set_window(row, j, &entries);
        }
        for (row, &x) in self.joints.iter_mut().skip(j).zip(&entries) {
            put(row, i, x);
        }
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
            linear: J::along_axis(Vector3::zeros(), body.mass),
            angular: -J::axis_cross(&body.first),
        }
    }
}

impl<T: Scalar> Inertia<T> {
    /// This inertia in the parent's frame.
    #[inline(always)]
    pub(crate) fn assembled_up<R: JointRotation<T>>(
        &self,
        rotation: &R,
        offset: &Vector3<T>,
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
    let mut forces = [[T::ZERO; N]; 6];
    let mut fold = Crba {
        posture,
        forces: &mut forces,
        joints,
    };
    let children = model.fold(&mut fold, &Nothing);
    let [fx, fy, fz, mx, my, mz] = &forces;
    for (i, column) in coupling.iter_mut().enumerate() {
        *column = Force {
            linear: Vector3::new(at(fx, i), at(fy, i), at(fz, i)),
            angular: Vector3::new(at(mx, i), at(my, i), at(mz, i)),
        };
    }
    *base = model.base().inertia() + children;
}
