//! Geodesics on SO(3): turning about a fixed axis at constant speed, any number of turns.

use crate::{Rotation3, Scalar, Unit, Vector3, exp, log, log_near};

/// The curve R(f) = R₀ exp(f w), f from 0 to 1: a turn about one axis at constant speed.
///
/// Two orientations do not say how often to turn between them: a double barrel roll starts and ends at the same
/// one. The rotation vector w does; |w| is the whole angle in rad, 4π for 720°.
///
/// # Frames
/// For R₀ = R_wa, w is expressed in a; as the axis does not move in the body, also in the body frame of every R(f).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodesic<T: Scalar> {
    start: Rotation3<T>,
    rotation_vector: Vector3<T>,
}

impl<T: Scalar> Geodesic<T> {
    /// From `start` by a rotation vector in rad, expressed in the body frame.
    #[must_use]
    pub const fn new(start: Rotation3<T>, rotation_vector: Vector3<T>) -> Self {
        Self {
            start,
            rotation_vector,
        }
    }

    /// The shortest way from `start` to `end`: w = log(R₀ᵀ R₁), at most half a turn.
    #[must_use]
    pub fn shortest(start: &Rotation3<T>, end: &Rotation3<T>) -> Self {
        Self::new(*start, log(&(start.transpose() * end)))
    }

    /// The way from `start` to `end` whose rotation vector is nearest to `hint`, so with its whole turns.
    ///
    /// The axis is that of R₀ᵀ R₁ (see [`log_near`]): a hint far from this axis is not followed.
    #[must_use]
    pub fn near(start: &Rotation3<T>, end: &Rotation3<T>, hint: &Vector3<T>) -> Self {
        Self::new(*start, log_near(&(start.transpose() * end), hint))
    }

    /// From `start` by `angle`, in rad and of any size, about an axis of the body frame.
    #[must_use]
    pub fn about(start: &Rotation3<T>, axis: &Unit<Vector3<T>>, angle: T) -> Self {
        Self::new(*start, axis.as_ref() * angle)
    }

    /// Orientation R₀ exp(f w) at the `fraction` f; fractions outside [0, 1] extrapolate.
    ///
    /// Test: `geodesic_*`.
    #[must_use]
    pub fn at(&self, fraction: T) -> Rotation3<T> {
        self.start * exp(&(self.rotation_vector * fraction))
    }

    /// The rotation vector w in rad. Body angular velocity is w ḟ, the same in the body frame for all f.
    #[must_use]
    pub const fn rotation_vector(&self) -> &Vector3<T> {
        &self.rotation_vector
    }
}
