//! Where a robot is and how it moves: configurations, velocities and forces of the whole robot.

use core::ops::{Add, Mul, Neg, Sub};

use nalgebra::{Rotation3, Vector3};
use so3::{Scalar, math};

use crate::spatial::{Force, Motion, Transform};
use crate::tree::Tree;

/// Configuration of a robot with `N` joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration<T: Scalar, const N: usize> {
    /// Pose of the base in the world.
    pub base: Transform<T>,
    /// Joint positions, rad or m.
    pub joints: [T; N],
}

impl<T: Scalar, const N: usize> Configuration<T, N> {
    /// Base at the world's origin, joints at zero.
    pub const NEUTRAL: Self = Self {
        base: Transform::IDENTITY,
        joints: [T::ZERO; N],
    };
}

impl<T: Scalar, const N: usize> Default for Configuration<T, N> {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

/// A velocity, acceleration or small displacement of the whole robot: base linear, base angular, both
/// in base axes, then joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent<T, const N: usize> {
    /// Of the base, in base axes.
    pub base: Motion<T>,
    /// Of the joints.
    pub joints: [T; N],
}

/// A generalised force: wrench on the base, in base axes about the base's origin, and joint torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort<T, const N: usize> {
    /// On the base, in base axes.
    pub base: Force<T>,
    /// On the joints, N m or N.
    pub joints: [T; N],
}

macro_rules! vector_space {
    ($($Type:ident $Spatial:ident),*) => { $(
        impl<T: Scalar, const N: usize> $Type<T, N> {
            /// All coordinates zero.
            pub const ZERO: Self = Self { base: $Spatial::ZERO, joints: [T::ZERO; N] };

            /// Coordinate `i` of the whole vector: 0 to 5 for the base, then the joints; 0 beyond the end.
            #[must_use]
            pub fn coordinate(&self, i: usize) -> T {
                match i.checked_sub(6) {
                    None => self.base.to_array().get(i).copied().unwrap_or(T::ZERO),
                    Some(j) => self.joints.get(j).copied().unwrap_or(T::ZERO),
                }
            }

            /// The unit vector of coordinate `i`: 0 to 5 for the base, then the joints; zero beyond the end.
            #[must_use]
            pub fn unit(i: usize) -> Self {
                let mut base = [T::ZERO; 6];
                let mut joints = [T::ZERO; N];
                if let Some(x) = base.iter_mut().chain(joints.iter_mut()).nth(i) {
                    *x = T::ONE;
                }
                Self { base: $Spatial::from_array(base), joints }
            }
        }

        impl<T: Scalar, const N: usize> Default for $Type<T, N> {
            fn default() -> Self {
                Self::ZERO
            }
        }

        impl<T: Scalar, const N: usize> Add for $Type<T, N> {
            type Output = Self;
            fn add(mut self, other: Self) -> Self {
                self.base += other.base;
                for (x, y) in self.joints.iter_mut().zip(other.joints) {
                    *x += y;
                }
                self
            }
        }

        impl<T: Scalar, const N: usize> Neg for $Type<T, N> {
            type Output = Self;
            fn neg(self) -> Self {
                self * -T::ONE
            }
        }

        impl<T: Scalar, const N: usize> Sub for $Type<T, N> {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                self + -other
            }
        }

        impl<T: Scalar, const N: usize> Mul<T> for $Type<T, N> {
            type Output = Self;
            fn mul(self, factor: T) -> Self {
                Self { base: self.base * factor, joints: self.joints.map(|x| x * factor) }
            }
        }
    )* };
}

vector_space!(Tangent Motion, Effort Force);

impl<T: Scalar, const N: usize> Tangent<T, N> {
    /// Power of an effort on this velocity: ν·τ, W.
    #[must_use]
    pub fn dot(&self, effort: &Effort<T, N>) -> T {
        let joints = self.joints.iter().zip(&effort.joints);
        joints.fold(self.base.dot(&effort.base), |sum, (&v, &f)| sum + v * f)
    }
}

/// A configuration made ready for the algorithms: the sine and cosine of every joint, once per tick.
///
/// Every algorithm of this crate starts from a posture, so a controller that calls several at the same
/// configuration pays for the trigonometry once.
#[derive(Clone, Copy, Debug)]
pub struct Posture<T: Scalar, const N: usize> {
    pub(crate) base: Transform<T>,
    /// Canonical joint positions: the sign of the table applied.
    pub(crate) q: [T; N],
    pub(crate) sin: [T; N],
    pub(crate) cos: [T; N],
}

impl<T: Scalar, const N: usize> Posture<T, N> {
    /// All zero: only storage, to be overwritten before use.
    pub const ZERO: Self = Self {
        base: Transform::new(
            Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
            )),
            Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        ),
        q: [T::ZERO; N],
        sin: [T::ZERO; N],
        cos: [T::ZERO; N],
    };

    /// The posture of `model` in a configuration.
    #[inline]
    #[must_use]
    pub fn new<M: Tree<T, N>>(model: &M, configuration: &Configuration<T, N>) -> Self {
        let mut posture = Self::ZERO;
        posture.update(model, configuration);
        posture
    }

    /// Overwrites with [`Posture::new`], in place.
    #[inline]
    pub(crate) fn update<M: Tree<T, N>>(&mut self, model: &M, configuration: &Configuration<T, N>) {
        self.base = configuration.base;
        self.q = configuration.joints;
        for (x, body) in self.q.iter_mut().zip(model.bodies()) {
            *x *= body.sign;
        }
        math::sin_cos_into(&self.q, &mut self.sin, &mut self.cos);
    }

    /// Pose of the base in the world.
    #[must_use]
    pub const fn base(&self) -> &Transform<T> {
        &self.base
    }
}

/// The six unit motions, linear first.
#[inline]
pub(crate) fn basis<T: Scalar>() -> [Motion<T>; 6] {
    let mut i = 0;
    [(); 6].map(|()| {
        let mut x = [T::ZERO; 6];
        if let Some(slot) = x.get_mut(i) {
            *slot = T::ONE;
        }
        i += 1;
        Motion::from_array(x)
    })
}
