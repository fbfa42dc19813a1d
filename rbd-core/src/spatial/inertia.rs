//! Rigid-body inertia as moments of mass of order 0, 1 and 2.

use core::ops::{Add, AddAssign};

use nalgebra::Vector3;
use so3::Scalar;

use super::{Force, Motion, Symmetric3, Transform, cross};

/// Inertia of one rigid body, or of several moving as one, about the origin of its frame.
///
/// Kept as the moments of mass ∫dm, ∫r dm, ∫r rᵀ dm. Composition is then plain addition, a shift of
/// the origin by p adds p hᵀ + h pᵀ + m p pᵀ, and the Newton–Euler moment is the axial vector of
/// U∫r rᵀdm with U = hat(ω̇) + hat(ω)² (Luh, Walker, Paul 1980), cheaper than with ∫(r·r 1 − r rᵀ)dm.
///
/// # Notation
/// | symbol | field | unit |
/// |---|---|---|
/// | m | `mass` | kg |
/// | h = m c | `first` | kg m |
/// | Σ | `second` | kg m² |
/// | I = tr(Σ) 1 − Σ | [`Inertia::rotational`] | kg m² |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<T> {
    /// Mass, kg.
    pub mass: T,
    /// First moment of mass, mass × centre of mass, kg m.
    pub first: Vector3<T>,
    /// Second moments of mass ∫r rᵀ dm about the frame's origin, kg m².
    pub second: Symmetric3<T>,
}

impl<T: Scalar> Inertia<T> {
    /// No mass.
    pub const ZERO: Self = Self {
        mass: T::ZERO,
        first: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        second: Symmetric3::ZERO,
    };

    /// From mass, centre of mass and the rotational inertia about the *centre of mass*, in the axes of
    /// the frame: Σ = ½ tr(I_c) 1 − I_c + m c cᵀ.
    #[must_use]
    pub fn from_com(mass: T, com: Vector3<T>, rotational_com: Symmetric3<T>) -> Self {
        let second = Symmetric3::diagonal(rotational_com.trace() * T::HALF) - rotational_com
            + Symmetric3::outer(&com, mass);
        Self {
            mass,
            first: com * mass,
            second,
        }
    }

    /// Centre of mass in the frame, m; the origin for a massless body.
    #[inline]
    #[must_use]
    pub fn com(&self) -> Vector3<T> {
        if self.mass > T::ZERO {
            self.first * (T::ONE / self.mass)
        } else {
            Vector3::zeros()
        }
    }

    /// Rotational inertia about the frame's origin, I = tr(Σ) 1 − Σ, kg m².
    #[inline(always)]
    #[must_use]
    pub fn rotational(&self) -> Symmetric3<T> {
        self.second.trace_complement()
    }

    /// Rotational inertia about the centre of mass, kg m².
    #[must_use]
    pub fn rotational_com(&self) -> Symmetric3<T> {
        (self.second - Symmetric3::outer(&self.com(), self.mass)).trace_complement()
    }

    /// Momentum at a velocity, or force at an acceleration: (m v + ω × h, h × v + I ω).
    #[inline(always)]
    #[must_use]
    pub fn mul(&self, motion: &Motion<T>) -> Force<T> {
        Force {
            linear: motion.linear * self.mass + cross(&motion.angular, &self.first),
            angular: cross(&self.first, &motion.linear) + self.rotational().mul(&motion.angular),
        }
    }

    /// ½ v·I v, J.
    #[inline(always)]
    #[must_use]
    pub fn kinetic_energy(&self, velocity: &Motion<T>) -> T {
        velocity.dot(&self.mul(velocity)) * T::HALF
    }

    /// The same body described in frame `a`, from its description in frame `b`.
    #[inline]
    #[must_use]
    pub fn transformed(&self, xf_ab: &Transform<T>) -> Self {
        let r = xf_ab.rotation.matrix();
        self.assembled(r * self.first, self.second.rotated(r), &xf_ab.translation)
    }

    /// Second half of a change of frame: the moments are already rotated, the origin moves by `p`.
    #[inline(always)]
    pub(crate) fn assembled(
        &self,
        first: Vector3<T>,
        second: Symmetric3<T>,
        p: &Vector3<T>,
    ) -> Self {
        // Σ' = Σ + p hᵀ + h pᵀ + m p pᵀ = Σ + p (h + m p/2)ᵀ + (h + m p/2) pᵀ
        let mp = p * self.mass;
        let half = first + mp * T::HALF;
        Self {
            mass: self.mass,
            first: first + mp,
            second: second + Symmetric3::outer_pair(p, &half),
        }
    }
}

impl<T: Scalar> Default for Inertia<T> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<T: Scalar> Add for Inertia<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            mass: self.mass + o.mass,
            first: self.first + o.first,
            second: self.second + o.second,
        }
    }
}

impl<T: Scalar> AddAssign for Inertia<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
