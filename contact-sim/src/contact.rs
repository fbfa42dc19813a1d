//! Compliant contact of one point: normal force and friction, by MuJoCo's own equations.
//!
//! MuJoCo asks for the acceleration a_r = −b v + d k δ n of a contact with normal n, penetration δ and velocity v, where b = 2/(d₁ t_c) and
//! k = 1/(d₁ t_c)² follow from one time constant t_c. A force f in the cone of friction C = {|f_t| ≤ μ f_n} leads to the acceleration a and
//! costs R f on top of it; what is missing to a_r is
//!
//! ```text
//! r = a + R f − a_r,   R = (1 − d)/(d m)
//! ```
//!
//! with the effective mass m of the contact's link and a share d that grows with the penetration from d₀ to d₁; friction has R/10 and no
//! k (MuJoCo, computation, "solver parameters": `solref`, `solimp`, `impratio`). So a soft ground gives way, and a foot creeps on it under
//! friction's share of its load. The force is the one with least ½ f·a + ½ R f² − f·a_r in C, so that r = 0 where the contact sticks.
//!
//! # Where this is MuJoCo's approximation and not Coulomb's contact
//!
//! Both are followed since the simulators are to agree, and both are small on hard ground, where b is large.
//!
//! - On the edge of the cone the least force has r perpendicular to it: r_n = μ |r_t|. A foot that slides with v_t is asked to
//!   leave the ground with about μ v_t, as if friction dilated it (the price of a convex problem). Coulomb would have r_n = 0.
//! - a is J ν̇, without the term J̇ ν of a turning leg: a foot that sticks creeps by J̇ ν / b.
//!
//! # How it is solved
//!
//! MuJoCo solves this for all contacts at once. Here each contact takes one relaxation step per step of the integrator, with the
//! acceleration a that the last step's forces gave its point:
//!
//! ```text
//! f ← P(f − ω r/(1/m_p + R))
//! ```
//!
//! where m_p is the effective mass of the point and P the nearest force in C, in the metric 1/m_p + R of its components. What all contacts
//! settle at within a millisecond is the solution above, however they are coupled.

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
    /// Force of the ground on the robot, N.
    pub force_w: Vector3<T>,
    /// Point of contact in the world, m.
    pub point_w: Vector3<T>,
    /// Penetration, m; negative is the gap.
    pub depth: T,
    /// Whether the force is on the edge of the cone of friction.
    pub sliding: bool,
}

impl<T: Scalar> ContactState<T> {
    /// No contact.
    pub const NONE: Self = Self {
        force_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        point_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        depth: T::ZERO,
        sliding: false,
    };
}

/// Where the material point of a contact is, and how it moves: world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMotion<T: Scalar> {
    /// Point of contact, m.
    pub point_w: Vector3<T>,
    /// Velocity J ν, m/s.
    pub velocity_w: Vector3<T>,
    /// Acceleration J ν̇ under the last forces, without J̇ ν, m/s².
    pub acceleration_w: Vector3<T>,
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

    /// Takes one relaxation step of one contact's force, given where it touches, how its material point moves and how hard it is to push.
    pub fn advance(
        &self,
        state: &mut ContactState<T>,
        touch: &Touch<T>,
        motion: &ContactMotion<T>,
        mass: ContactMass<T>,
    ) {
        state.depth = touch.depth;
        state.point_w = motion.point_w;
        if touch.depth <= T::ZERO {
            state.force_w = Vector3::zeros();
            state.sliding = false;
            return;
        }
        let n = &touch.normal_w;
        let reach = self.impedance()[1] * self.time_constant;
        let share = self.share(touch.depth);
        let spring = share * touch.depth / (reach * reach);
        let wanted_w = n * spring - motion.velocity_w * (T::TWO / reach);
        let missing_w = wanted_w - motion.acceleration_w;
        let soft = (T::ONE - share) / (share * mass.link);
        let harder = soft / T::of(FRICTION_RATIO);
        // 1/m_p + R, of the normal force and of friction.
        let metric = [soft, harder].map(|soft| T::ONE / mass.point + soft);
        let omega = T::of(RELAXATION);
        let last = state.force_w.dot(n);
        let normal = last + (missing_w.dot(n) - last * soft) * (omega / metric[0]);
        let across = |x: &Vector3<T>| x - n * x.dot(n);
        let last_w = across(&state.force_w);
        let friction_w = last_w + (across(&missing_w) - last_w * harder) * (omega / metric[1]);
        let size = math::sqrt(friction_w.norm_squared());
        state.sliding = normal < T::ZERO || size > self.friction * normal;
        state.force_w = if state.sliding {
            let nearest = self.edge([normal, size], metric);
            // Where there is no friction to scale, nothing of it is left either.
            let across_w = friction_w * (self.friction * nearest / math::max(size, T::of(1e-30)));
            n * nearest + across_w
        } else {
            n * normal + friction_w
        };
    }

    /// Normal force of the force on the edge of the cone that is nearest to one outside of it: the least
    /// m_n (x − f_n)² + m_t (μ x − |f_t|)² with x ≥ 0.
    fn edge(&self, [normal, friction]: [T; 2], [along, across]: [T; 2]) -> T {
        let mu = self.friction;
        let nearest = (along * normal + across * mu * friction) / (along + across * mu * mu);
        math::max(nearest, T::ZERO)
    }
}
