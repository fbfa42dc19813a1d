//! Rigid transforms.

use nalgebra::{Rotation3, Vector3};
use so3::Scalar;

use super::{Force, Motion, cross, matrix_product, product};

/// Pose of frame b in frame a: x_a = R_ab x_b + p_ab. Named `xf_ab` where it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<T: Scalar> {
    /// R_ab: maps b-coordinates to a.
    pub rotation: Rotation3<T>,
    /// p_ab: origin of b in a, m.
    pub translation: Vector3<T>,
}

impl<T: Scalar> Transform<T> {
    /// a and b coincide.
    pub const IDENTITY: Self = Self {
        rotation: Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
            T::ONE,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ONE,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ONE,
        )),
        translation: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
    };

    /// From rotation and origin.
    #[inline(always)]
    #[must_use]
    pub const fn new(rotation: Rotation3<T>, translation: Vector3<T>) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// xf_ab · xf_bc = xf_ac.
    #[inline(always)]
    #[must_use]
    pub fn compose(&self, xf_bc: &Self) -> Self {
        let rotation = self.rotation.matrix();
        Self {
            rotation: Rotation3::from_matrix_unchecked(matrix_product(
                rotation,
                xf_bc.rotation.matrix(),
            )),
            translation: self.translation + product(rotation, &xf_bc.translation),
        }
    }

    /// xf_ba.
    #[inline(always)]
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            rotation,
            translation: -(rotation * self.translation),
        }
    }

    /// A point's coordinates in a, from those in b: R p + t.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, pos_b: &Vector3<T>) -> Vector3<T> {
        self.rotation * pos_b + self.translation
    }

    /// A motion in a from one in b: (R v + p × R ω, R ω).
    #[inline(always)]
    #[must_use]
    pub fn motion(&self, motion_b: &Motion<T>) -> Motion<T> {
        let rotation = self.rotation.matrix();
        let angular = product(rotation, &motion_b.angular);
        Motion {
            linear: product(rotation, &motion_b.linear) + cross(&self.translation, &angular),
            angular,
        }
    }

    /// A motion in b from one in a: (Rᵀ(v − p × ω), Rᵀ ω).
    #[inline(always)]
    #[must_use]
    pub fn inverse_motion(&self, motion_a: &Motion<T>) -> Motion<T> {
        let linear = motion_a.linear - self.translation.cross(&motion_a.angular);
        Motion {
            linear: self.rotation.matrix().tr_mul(&linear),
            angular: self.rotation.matrix().tr_mul(&motion_a.angular),
        }
    }

    /// A force in a from one in b: (R f, R n + p × R f).
    #[inline(always)]
    #[must_use]
    pub fn force(&self, force_b: &Force<T>) -> Force<T> {
        let rotation = self.rotation.matrix();
        let linear = product(rotation, &force_b.linear);
        Force {
            linear,
            angular: product(rotation, &force_b.angular) + cross(&self.translation, &linear),
        }
    }

    /// A force in b from one in a: (Rᵀ f, Rᵀ(n − p × f)).
    #[inline(always)]
    #[must_use]
    pub fn inverse_force(&self, force_a: &Force<T>) -> Force<T> {
        let angular = force_a.angular - self.translation.cross(&force_a.linear);
        Force {
            linear: self.rotation.matrix().tr_mul(&force_a.linear),
            angular: self.rotation.matrix().tr_mul(&angular),
        }
    }
}

impl<T: Scalar> Default for Transform<T> {
    fn default() -> Self {
        Self::IDENTITY
    }
}
