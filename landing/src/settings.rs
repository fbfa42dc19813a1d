//! Gains, weights and limits of the landing controller, and where it is to bring the body.

use nalgebra::Rotation3;
use so3::Scalar;

/// Settings; [`Settings::a1`] holds those measured on A1 drops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// Gains on height: s⁻², s⁻¹.
    pub height: (T, T),
    /// Gains on the horizontal position over the feet of a body that moves. Stiffer ones tip over after 1.2 m/s.
    pub horizontal: (T, T),
    /// The same for a body at rest, whose joints' friction holds it off its target.
    pub resting: (T, T),
    /// Speed of the centre of mass, m/s, from which a body counts as moving; below, the gains are blended.
    pub moving: T,
    /// Gains on the rotation.
    pub rotation: (T, T),
    /// Composite inertia of the landing posture about the centre of mass, diagonal, base axes, kg m².
    pub inertia_b: [T; 3],
    /// Weight on the error of the total force, N⁻².
    pub force_weight: T,
    /// Weight on the error of the total moment, (N m)⁻².
    pub moment_weight: T,
    /// Weight on the forces themselves, N⁻²: positive, for it shares the load where the wrench does not say how.
    pub effort_weight: T,
    /// Coulomb coefficient of the friction pyramid.
    pub friction: T,
    /// Largest normal force of one foot, N.
    pub max_normal_force: T,
    /// Damping of the joints of stance legs, N m s/rad.
    pub stance_damping: T,
    /// Stiffness of the joints of swing legs, N m/rad.
    pub swing_stiffness: T,
    /// Damping of the joints of swing legs, N m s/rad.
    pub swing_damping: T,
}

impl<T: Scalar> Settings<T> {
    /// Measured on drops of A1 from 0.3 to 2 m.
    #[must_use]
    pub fn a1() -> Self {
        let of = T::of;
        Self {
            height: (of(120.0), of(14.0)),
            horizontal: (of(20.0), of(8.0)),
            resting: (of(80.0), of(14.0)),
            moving: of(0.2),
            rotation: (of(250.0), of(28.0)),
            inertia_b: [of(0.141), of(0.379), of(0.410)],
            force_weight: T::ONE,
            moment_weight: of(30.0),
            effort_weight: of(1e-4),
            friction: T::HALF,
            max_normal_force: of(400.0),
            stance_damping: T::ONE,
            swing_stiffness: of(60.0),
            swing_damping: of(2.0),
        }
    }
}

/// Where the body is to come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<T: Scalar> {
    /// Height of the centre of mass over the feet in contact, m.
    pub height: T,
    /// Rotation of the base.
    pub rot_wb: Rotation3<T>,
    /// Offset of the centre of mass from the middle of the feet, world x and y, m.
    pub offset_w: [T; 2],
}

impl<T: Scalar> Target<T> {
    /// Level, over the middle of the feet, at no height: set one.
    pub const LEVEL: Self = Self {
        height: T::ZERO,
        rot_wb: Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(
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
        offset_w: [T::ZERO; 2],
    };
}
