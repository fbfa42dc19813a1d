//! Compliant contact of one sphere: normal force and friction.
//!
//! # Normal force
//! With penetration d and its rate ḋ, f_n = k d max(0, 1 + c ḋ) (Hunt and Crossley 1975): zero at first touch,
//! never adhesive, and its damping grows with the load, so that a hard impact loses more than a soft one.
//!
//! # Friction
//! A bristle with deflection s in the tangent plane resists slip: ṡ = v_t, f_t = −(k_t s + c_t v_t). Where
//! |f_t| would exceed μ f_n it is cut to μ f_n, and s is set to what the cut force says (Dahl's idea, as in
//! elasto-plastic friction models): sticking is exact, a foot under a steady load does not creep, and a ball that rolls
//! has v_t = 0 at its lowest point and meets no resistance.

use nalgebra::Vector3;
use rbd_core::{Contact, ContactShape, Link};
use so3::{Scalar, math};

use crate::Touch;

/// A sphere on the robot that may touch the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSphere<T> {
    /// The link it is fixed to.
    pub link: Link,
    /// Its centre in the link's frame, m.
    pub offset: [T; 3],
    /// Its radius, m.
    pub radius: T,
}

impl<T: Scalar> ContactSphere<T> {
    /// A robot's contact as a sphere; `None` for other shapes.
    #[must_use]
    pub fn of(contact: &Contact<T>) -> Option<Self> {
        match contact.shape {
            ContactShape::Sphere { radius } => Some(Self {
                link: contact.frame.link,
                offset: contact.frame.offset,
                radius,
            }),
            ContactShape::Rectangle { .. } => None,
        }
    }

    /// A robot's rectangular sole as four balls inside its corners that touch the sole's plane from above, in the order
    /// (x⁻, y⁻), (x⁻, y⁺), (x⁺, y⁻), (x⁺, y⁺); `None` for other shapes. Several points of friction resist a turn about
    /// the normal, so a sole needs no torsional friction of its own.
    #[must_use]
    pub fn corners(contact: &Contact<T>, radius: T) -> Option<[Self; 4]> {
        let ContactShape::Rectangle {
            x: [xl, xh],
            y: [yl, yh],
        } = contact.shape
        else {
            return None;
        };
        let (xl, xh, yl, yh) = (xl + radius, xh - radius, yl + radius, yh - radius);
        let placement = contact.frame.placement();
        Some([(xl, yl), (xl, yh), (xh, yl), (xh, yh)].map(|(x, y)| Self {
            link: contact.frame.link,
            offset: placement.point(&Vector3::new(x, y, radius)).into(),
            radius,
        }))
    }
}

/// Stiffness, dissipation and friction of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLaw<T> {
    /// Normal stiffness k, N/m.
    pub stiffness: T,
    /// Dissipation c, s/m.
    pub dissipation: T,
    /// Tangential stiffness k_t, N/m.
    pub tangential_stiffness: T,
    /// Tangential damping c_t, N s/m.
    pub tangential_damping: T,
    /// Coulomb coefficient μ.
    pub friction: T,
}

/// What a contact remembers and shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState<T: Scalar> {
    /// Bristle deflection s, world axes, m.
    pub bristle_w: Vector3<T>,
    /// Force of the ground on the robot, N.
    pub force_w: Vector3<T>,
    /// Point of contact in the world, m.
    pub point_w: Vector3<T>,
    /// Penetration, m; negative is the gap.
    pub depth: T,
    /// Whether the contact slides.
    pub sliding: bool,
}

impl<T: Scalar> ContactState<T> {
    /// No contact.
    pub const NONE: Self = Self {
        bristle_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        force_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        point_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        depth: T::ZERO,
        sliding: false,
    };
}

impl<T: Scalar> ContactLaw<T> {
    /// Rubber foot on a hard floor: 1 mm of penetration at 100 N.
    pub fn new(friction: T) -> Self {
        Self {
            stiffness: T::of(1.0e5),
            dissipation: T::of(1.0),
            tangential_stiffness: T::of(8.0e4),
            tangential_damping: T::of(60.0),
            friction,
        }
    }

    /// Advances one contact by `dt`, given where it touches and the velocity of its material point.
    pub fn advance(
        &self,
        state: &mut ContactState<T>,
        touch: &Touch<T>,
        point_w: &Vector3<T>,
        velocity_w: &Vector3<T>,
        dt: T,
    ) {
        state.depth = touch.depth;
        state.point_w = *point_w;
        if touch.depth <= T::ZERO {
            *state = ContactState {
                depth: touch.depth,
                point_w: *point_w,
                ..ContactState::NONE
            };
            return;
        }
        let n = &touch.normal_w;
        let rate = velocity_w.dot(n);
        let gain = math::max(T::ZERO, T::ONE - self.dissipation * rate);
        let normal = self.stiffness * touch.depth * gain;
        let slip = velocity_w - n * rate;
        let mut bristle = state.bristle_w + slip * dt;
        bristle -= n * bristle.dot(n);
        let wanted = -(bristle * self.tangential_stiffness + slip * self.tangential_damping);
        let limit = self.friction * normal;
        let size = math::sqrt(wanted.norm_squared());
        state.sliding = size > limit;
        let friction = if state.sliding {
            wanted * (limit / size)
        } else {
            wanted
        };
        if state.sliding {
            bristle = -(friction + slip * self.tangential_damping) / self.tangential_stiffness;
        }
        state.bristle_w = bristle;
        state.force_w = n * normal + friction;
    }
}
