//! Compliant contact of one point: normal force and friction.
//!
//! The law is MuJoCo's soft contact, written as the force of a spring and a damper, so that one time constant t_c says how soft the ground
//! is in both simulators. MuJoCo asks for the acceleration a_r = −b v − k r of a contact with penetration −r and rate v, where
//! b = 2/(d₁ t_c) and k = 1/(d₁ t_c)², and lets it have the share d of that against the acceleration that there would be without contact;
//! d grows with the penetration from d₀ to d₁ (MuJoCo, computation, "solver parameters", `solref` and `solimp`). At rest the force of a
//! contact whose effective mass is m is therefore that of a spring m k d/(1 − d), and what slips under friction's share of the load
//! creeps as in a damper.
//!
//! # Normal force
//! f_n = m d/(1 − d) (k δ − b' δ̇), never adhesive; b' is b, or less where a step of the integrator could not follow it.
//!
//! # Friction
//! A bristle with deflection s in the tangent plane resists slip: ṡ = v_t − s k_t c, f_t = −(k_t s + c_t v_t), with the creep c of
//! MuJoCo's friction. Where |f_t| would exceed μ f_n it is cut to μ f_n, and s is set to what the cut force says (Dahl's idea, as in
//! elasto-plastic friction models). A ball that rolls has v_t = 0 at its lowest point and meets no resistance.

use nalgebra::Vector3;
use so3::{Scalar, math};

use crate::Touch;

/// Penetration at which d has reached d₁, m: `solimp`'s width.
pub(crate) const WIDTH: f64 = 1e-3;
/// How much harder friction is than the normal force: MuJoCo's `impratio`.
pub(crate) const FRICTION_RATIO: f64 = 10.0;
/// Frequency of a bristle with the contact's effective mass, rad/s: stiffer than any ground is soft, and slow beside a step.
const BRISTLE: f64 = 1000.0;
/// Largest damping of a contact's speed in one step, share, and largest phase of its spring, rad: an explicit step follows no more.
const MOST_DAMPING: f64 = 0.3;
const MOST_PHASE: f64 = 0.5;
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

/// How hard it is to push a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMass<T> {
    /// Effective mass of its link, by which MuJoCo scales a contact's softness, kg.
    pub link: T,
    /// Effective mass of the point of contact, which bounds what an explicit step can follow, kg.
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

    /// d/(1 − d) at a penetration.
    fn share(&self, depth: T) -> T {
        let [d0, d1] = self.impedance();
        let x = math::min(depth / T::of(WIDTH), T::ONE);
        // MuJoCo's default: two parabolas that meet in the middle.
        let y = if x < T::HALF {
            T::TWO * x * x
        } else {
            T::ONE - T::TWO * (T::ONE - x) * (T::ONE - x)
        };
        let d = d0 + (d1 - d0) * y;
        d / (T::ONE - d)
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
        let reach = self.impedance()[1] * self.time_constant;
        let share = self.share(touch.depth);
        let quick = T::of(MOST_PHASE) / dt;
        let damping = math::min(
            share * T::TWO / reach * mass.link,
            T::of(MOST_DAMPING) / dt * mass.point,
        );
        let stiffness = math::min(
            share / (reach * reach) * mass.link,
            quick * quick * mass.point,
        );
        let normal = math::max(stiffness * touch.depth - damping * rate, T::ZERO);
        let slip = velocity_w - n * rate;
        let least = math::min(mass.link, mass.point);
        let bristle_stiffness = T::of(BRISTLE * BRISTLE) * least;
        let bristle_damping = T::of(BRISTLE) * least;
        let creep = reach / (T::TWO * share * mass.link * T::of(FRICTION_RATIO));
        let leak = math::min(bristle_stiffness * creep * dt, T::ONE);
        let mut bristle = state.bristle_w * (T::ONE - leak) + slip * dt;
        bristle -= n * bristle.dot(n);
        let wanted = -(bristle * bristle_stiffness + slip * bristle_damping);
        let limit = self.friction * normal;
        let size = math::sqrt(wanted.norm_squared());
        state.sliding = size > limit;
        let friction = if state.sliding {
            wanted * (limit / size)
        } else {
            wanted
        };
        if state.sliding {
            bristle = -(friction + slip * bristle_damping) / bristle_stiffness;
        }
        state.bristle_w = bristle;
        state.force_w = n * normal + friction;
    }
}
