//! Compliant contact of one point: normal force and friction, by MuJoCo's own equations.
//!
//! MuJoCo asks for the acceleration a_r = −b v + d k δ of a contact with penetration δ and velocity v, where b = 2/(d₁ t_c) and k = 1/(d₁ t_c)²
//! follow from one time constant t_c; a force f of the contact costs R f on top of the acceleration a that it leads to:
//!
//! ```text
//! a + R f = a_r,   R = (1 − d)/(d m),   f_n ≥ 0,   |f_t| ≤ μ f_n
//! ```
//!
//! with the effective mass m of the contact's link and a share d that grows with the penetration from d₀ to d₁; friction has R/10 and no
//! k (MuJoCo, computation, "solver parameters": `solref`, `solimp`, `impratio`). So a soft ground gives way, and a foot creeps on it under
//! friction's share of its load.
//!
//! MuJoCo solves this for all contacts at once. Here each contact takes one relaxation step per step of the integrator: with the
//! acceleration that its point had in the last one under the last force,
//!
//! ```text
//! f ← f + ω (a_r − a − R f)/(1/m_p + R)
//! ```
//!
//! where m_p is the effective mass of the point. What all contacts settle at within a millisecond is the solution above, however they are
//! coupled.

use nalgebra::Vector3;
use so3::{Scalar, math};

use crate::Touch;

/// Penetration at which d has reached d₁, m: `solimp`'s width.
pub(crate) const WIDTH: f64 = 1e-3;
/// How much harder friction is than the normal force: MuJoCo's `impratio`.
pub(crate) const FRICTION_RATIO: f64 = 10.0;
/// ω: below one, since the other contacts of a link answer as well, and its effective mass changes with the posture.
const RELAXATION: f64 = 0.5;
/// Time constant up to which the ground is hard, s: d from 0.95 to 0.99, as MuJoCo is told; beyond it 0.9 to 0.95, its default.
const HARD: f64 = 0.0025;

/// Softness and friction of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLaw<T> {
    /// Time in which a contact that is pressed in comes back, s: 2 ms is concrete, 20 ms (MuJoCo's default) a gym mat.
    pub time_constant: T,
    /// Coulomb coefficient μ.
    pub friction: T,
}

/// What a contact remembers and shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState<T: Scalar> {
    /// Velocity of the material point, world axes, m/s.
    pub velocity_w: Vector3<T>,
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
        velocity_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        force_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        point_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        depth: T::ZERO,
        sliding: false,
    };
}

/// How hard it is to push a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMass<T> {
    /// Effective mass of its link, by which MuJoCo scales a contact's softness, kg.
    pub link: T,
    /// Effective mass of the point of contact, by which its force is relaxed, kg.
    pub point: T,
}

impl<T: Scalar> ContactLaw<T> {
    /// A rubber foot on concrete.
    pub fn new(friction: T) -> Self {
        Self {
            time_constant: T::of(0.002),
            friction,
        }
    }

    /// d₀ and d₁.
    #[must_use]
    pub fn impedance(&self) -> [T; 2] {
        if self.time_constant <= T::of(HARD) {
            [T::of(0.95), T::of(0.99)]
        } else {
            [T::of(0.9), T::of(0.95)]
        }
    }

    /// d at a penetration.
    fn share(&self, depth: T) -> T {
        let [d0, d1] = self.impedance();
        let x = math::min(depth / T::of(WIDTH), T::ONE);
        // MuJoCo's default: two parabolas that meet in the middle.
        let y = if x < T::HALF {
            T::TWO * x * x
        } else {
            T::ONE - T::TWO * (T::ONE - x) * (T::ONE - x)
        };
        d0 + (d1 - d0) * y
    }

    /// Advances one contact by `dt`, given where it touches, the velocity of its material point and how hard it is to push.
    pub fn advance(
        &self,
        state: &mut ContactState<T>,
        touch: &Touch<T>,
        (point_w, velocity_w): (&Vector3<T>, &Vector3<T>),
        mass: ContactMass<T>,
        dt: T,
    ) {
        if touch.depth <= T::ZERO {
            *state = ContactState {
                depth: touch.depth,
                point_w: *point_w,
                ..ContactState::NONE
            };
            return;
        }
        // Not in the step of the first touch: there is no force yet that an acceleration could answer to.
        let acceleration_w = if state.depth > T::ZERO {
            (velocity_w - state.velocity_w) / dt
        } else {
            Vector3::zeros()
        };
        let n = &touch.normal_w;
        let reach = self.impedance()[1] * self.time_constant;
        let share = self.share(touch.depth);
        let spring = share * touch.depth / (reach * reach);
        let wanted_w = n * spring - velocity_w * (T::TWO / reach);
        let missing_w = wanted_w - acceleration_w;
        let soft = (T::ONE - share) / (share * mass.link);
        let relax = |last: &Vector3<T>, missing: &Vector3<T>, soft: T| {
            let step = T::of(RELAXATION) / (T::ONE / mass.point + soft);
            last + (missing - last * soft) * step
        };
        let last = state.force_w.dot(n);
        let normal_w = relax(&(n * last), &(n * missing_w.dot(n)), soft);
        let normal = math::max(normal_w.dot(n), T::ZERO);
        let across = |x: &Vector3<T>| x - n * x.dot(n);
        let harder = soft / T::of(FRICTION_RATIO);
        let mut friction_w = relax(&across(&state.force_w), &across(&missing_w), harder);
        let limit = self.friction * normal;
        let size = math::sqrt(friction_w.norm_squared());
        state.sliding = size > limit;
        if state.sliding {
            friction_w *= limit / size;
        }
        state.depth = touch.depth;
        state.point_w = *point_w;
        state.velocity_w = *velocity_w;
        state.force_w = n * normal + friction_w;
    }
}
