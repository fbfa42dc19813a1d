//! The embedded simulator.
//!
//! One integration step of length h is a position-Verlet step: the configuration moves half a step with
//! the old velocity, the acceleration is found there, and the configuration moves the other half with the new
//! velocity. Forces see the velocity extrapolated to the middle, ν + ½h ν̇_last, in the smooth terms of
//! the dynamics (second order), and the old velocity in contact and joint friction (dissipative).

use nalgebra::Vector3;
use rbd_core::{
    AbaWorkspace, BodyMotions, Configuration, Effort, Force, Kinematics, Link, Posture, Tangent,
    Transform, Tree, aba_with_forces, forward_kinematics, forward_velocities, integrate,
    joint_friction,
};
use so3::{Scalar, math, orthonormalize_step};

use crate::collide::{contact_mass, place};
use crate::shape::{SLOTS, Swept};
use crate::{ContactMass, ContactState, Error, Settings, Shape, Simulator, Terrain, Touch};

/// The embedded simulator: a robot `M` with `N` joints, `S` shapes and `C` owners of shapes, and all its state.
#[derive(Clone, Debug)]
pub struct NativeSimulator<T: Scalar, M, const N: usize, const S: usize, const C: usize> {
    /// The robot.
    pub model: M,
    /// Its shapes.
    pub shapes: [Shape<T>; S],
    /// The world.
    pub terrain: Terrain<T>,
    /// The plant's parameters.
    pub settings: Settings<T, N>,
    /// Pairs of shapes that may touch each other, as [`self_contacts`](crate::self_contacts) finds them.
    pairs: [u64; S],
    /// How hard it is to push each shape; known from the first tick on.
    masses: [ContactMass<T>; S],
    configuration: Configuration<T, N>,
    velocity: Tangent<T, N>,
    acceleration: Tangent<T, N>,
    swept: [Swept<T>; S],
    contacts: [[ContactState<T>; SLOTS]; S],
    mean_forces_w: [Vector3<T>; C],
    mean_link_forces: [T; C],
    delivered: [T; N],
    stops: [T; N],
    ticks: u64,
    kinematics: Kinematics<T, N>,
    motions: BodyMotions<T, N>,
    workspace: AbaWorkspace<T, N>,
}

/// Wrenches on base and bodies, body frames, while they are summed up.
struct Wrenches<T: Scalar, const N: usize> {
    base: Force<T>,
    bodies: [Force<T>; N],
}

impl<T: Scalar, const N: usize> Wrenches<T, N> {
    /// Adds a force on a link, world axes, at a point that is `arm_w` from the link's origin.
    fn add(&mut self, link: Link, xf_wl: &Transform<T>, arm_w: &Vector3<T>, force_w: &Vector3<T>) {
        let linear = xf_wl.rotation.matrix().tr_mul(force_w);
        let arm = xf_wl.rotation.matrix().tr_mul(arm_w);
        let wrench = Force::new(linear, arm.cross(&linear));
        match link {
            Link::Base => self.base += wrench,
            Link::Joint(i) => {
                if let Some(total) = self.bodies.get_mut(i) {
                    *total += wrench;
                }
            }
        }
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const S: usize, const C: usize>
    NativeSimulator<T, M, N, S, C>
{
    /// A robot at the world's origin, at rest, untouched, whose links pass through each other.
    #[must_use]
    pub const fn new(
        model: M,
        shapes: [Shape<T>; S],
        terrain: Terrain<T>,
        settings: Settings<T, N>,
    ) -> Self {
        Self {
            model,
            shapes,
            terrain,
            settings,
            pairs: [0; S],
            masses: [ContactMass {
                link: T::ZERO,
                point: T::ZERO,
            }; S],
            configuration: Configuration::NEUTRAL,
            velocity: Tangent::ZERO,
            acceleration: Tangent::ZERO,
            swept: [Swept::NONE; S],
            contacts: [[ContactState::NONE; SLOTS]; S],
            mean_forces_w: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); C],
            mean_link_forces: [T::ZERO; C],
            delivered: [T::ZERO; N],
            stops: [T::ZERO; N],
            ticks: 0,
            kinematics: Kinematics::IDENTITY,
            motions: BodyMotions::ZERO,
            workspace: AbaWorkspace::new(),
        }
    }

    /// The same robot, whose links collide: pairs as [`self_contacts`](crate::self_contacts) finds them.
    #[must_use]
    pub const fn colliding(mut self, pairs: [u64; S]) -> Self {
        self.pairs = pairs;
        self
    }

    /// The contacts of each shape with the world after the last integration step: at its two ends, and between them.
    #[must_use]
    pub const fn contacts(&self) -> &[[ContactState<T>; SLOTS]; S] {
        &self.contacts
    }

    /// Acceleration found in the last integration step.
    #[must_use]
    pub const fn acceleration(&self) -> &Tangent<T, N> {
        &self.acceleration
    }

    fn advance(&mut self, command: &[T; N], h: T, share: T) {
        let half = h * T::HALF;
        let middle = integrate(&self.configuration, &(self.velocity * half));
        let posture = Posture::new(&self.model, &middle);
        let wrenches = self.contact_forces(&posture, h, share);
        let smooth = self.velocity + self.acceleration * half;
        let effort = Effort {
            base: wrenches.base,
            joints: self.joint_torques(command, &middle.joints),
        };
        self.acceleration = aba_with_forces(
            &self.model,
            &posture,
            &smooth,
            &effort,
            &wrenches.bodies,
            &mut self.workspace,
        );
        self.velocity = self.velocity + self.acceleration * h;
        self.configuration = integrate(&middle, &(self.velocity * half));
    }

    /// Advances the contacts; their wrenches, of which `share` goes into the means of the tick.
    fn contact_forces(&mut self, posture: &Posture<T, N>, h: T, share: T) -> Wrenches<T, N> {
        forward_kinematics(&self.model, posture, &mut self.kinematics);
        forward_velocities(&self.model, posture, &self.velocity, &mut self.motions);
        let mut wrenches = Wrenches {
            base: Force::ZERO,
            bodies: [Force::ZERO; N],
        };
        for (swept, shape) in self.swept.iter_mut().zip(&self.shapes) {
            *swept = place(&self.kinematics, shape);
        }
        self.touch_world(&mut wrenches, h, share);
        self.touch_links(&mut wrenches, h, share);
        wrenches
    }

    /// Velocity of a link's point that is `arm_w` from its origin, world axes.
    fn point_velocity(&self, link: Link, xf_wl: &Transform<T>, arm_w: &Vector3<T>) -> Vector3<T> {
        let motion = match link {
            Link::Base => Some(&self.velocity.base),
            Link::Joint(i) => self.motions.velocities.get(i),
        };
        motion.map_or_else(Vector3::zeros, |m| {
            xf_wl.rotation * m.linear + (xf_wl.rotation * m.angular).cross(arm_w)
        })
    }

    /// Contacts of all shapes with floor and block.
    fn touch_world(&mut self, wrenches: &mut Wrenches<T, N>, h: T, share: T) {
        for i in 0..S {
            let (Some(shape), Some(swept)) = (self.shapes.get(i), self.swept.get(i)) else {
                continue;
            };
            let (shape, swept) = (*shape, *swept);
            let xf_wl = self.kinematics.link(shape.link);
            for (slot, (touch, center_w)) in swept.touches(&self.terrain).into_iter().enumerate() {
                // The force acts in the middle of what overlaps, as in MuJoCo.
                let overlap = math::max(touch.depth, T::ZERO) * T::HALF;
                let arm_w =
                    center_w - touch.normal_w * (swept.radius - overlap) - xf_wl.translation;
                let velocity_w = self.point_velocity(shape.link, &xf_wl, &arm_w);
                let point_w = xf_wl.translation + arm_w;
                let Some(mass) = self.masses.get(i).copied() else {
                    continue;
                };
                let law = self.settings.contact;
                let Some(state) = self.contacts.get_mut(i).and_then(|c| c.get_mut(slot)) else {
                    continue;
                };
                law.advance(state, &touch, (&point_w, &velocity_w), mass, h);
                if touch.depth > T::ZERO {
                    let force_w = state.force_w;
                    wrenches.add(shape.link, &xf_wl, &arm_w, &force_w);
                    if let Some(mean) = self.mean_forces_w.get_mut(shape.owner) {
                        *mean += force_w * share;
                    }
                }
            }
        }
    }

    /// Contacts of the links with each other.
    fn touch_links(&mut self, wrenches: &mut Wrenches<T, N>, h: T, share: T) {
        for i in 0..S {
            let mut left = self.pairs.get(i).copied().unwrap_or(0);
            while left != 0 {
                let j = left.trailing_zeros() as usize;
                left &= left - 1;
                let pair = self.swept.get(i).zip(self.swept.get(j));
                let Some((a, b)) = pair else { continue };
                let ((center_a, reach_a), (center_b, reach_b)) = (a.bound(), b.bound());
                let reach = reach_a + reach_b;
                if (center_a - center_b).norm_squared() < reach * reach {
                    self.touch_pair((i, j), wrenches, h, share);
                }
            }
        }
    }

    /// The contact of two shapes: the ground's law without a memory, which makes a stiff spring and a damper of it.
    fn touch_pair(
        &mut self,
        (i, j): (usize, usize),
        wrenches: &mut Wrenches<T, N>,
        h: T,
        share: T,
    ) {
        let shapes = self.shapes.get(i).zip(self.shapes.get(j));
        let swept = self.swept.get(i).zip(self.swept.get(j));
        let masses = self.masses.get(i).zip(self.masses.get(j));
        let (Some((a, b)), Some((at_a, at_b)), Some((m_a, m_b))) = (shapes, swept, masses) else {
            return;
        };
        let (s, t) = at_a.nearest(at_b);
        let (point_a, point_b) = (at_a.at(s), at_b.at(t));
        let apart = point_a - point_b;
        let distance = math::sqrt(apart.norm_squared());
        let depth = at_a.radius + at_b.radius - distance;
        if depth <= T::ZERO || distance <= T::of(1e-9) {
            return;
        }
        let normal_w = apart / distance;
        let point_w = point_b + normal_w * (at_b.radius - depth * T::HALF);
        let (xf_a, xf_b) = (self.kinematics.link(a.link), self.kinematics.link(b.link));
        let (arm_a, arm_b) = (point_w - xf_a.translation, point_w - xf_b.translation);
        let velocity_w =
            self.point_velocity(a.link, &xf_a, &arm_a) - self.point_velocity(b.link, &xf_b, &arm_b);
        let mut state = ContactState::NONE;
        let both = |a: T, b: T| a * b / (a + b);
        let mass = ContactMass {
            link: both(m_a.link, m_b.link),
            point: both(m_a.point, m_b.point),
        };
        let touch = Touch { depth, normal_w };
        self.settings
            .contact
            .advance(&mut state, &touch, (&point_w, &velocity_w), mass, h);
        wrenches.add(a.link, &xf_a, &arm_a, &state.force_w);
        wrenches.add(b.link, &xf_b, &arm_b, &-state.force_w);
        let size = math::sqrt(state.force_w.norm_squared()) * share;
        for owner in [a.owner, b.owner] {
            if let Some(mean) = self.mean_link_forces.get_mut(owner) {
                *mean += size;
            }
        }
    }

    /// Motor, friction and stop torques.
    fn joint_torques(&mut self, command: &[T; N], q: &[T; N]) -> [T; N] {
        let s = &self.settings;
        let mut torques = joint_friction(&s.limits, &self.velocity.joints, s.friction_smoothing);
        let given = self.delivered.iter_mut().zip(command).zip(&s.motors);
        let state = q.iter().zip(&self.velocity.joints).zip(&s.limits);
        for (((tau, ((delivered, wanted), motor)), ((q, qd), limits)), stop) in torques
            .iter_mut()
            .zip(given)
            .zip(state)
            .zip(&mut self.stops)
        {
            let [low, high] = motor.torque_range(*qd);
            *delivered = math::clamp(*wanted, low, high);
            *stop = s.stops.torque(limits, *q, *qd);
            *tau += *delivered + *stop;
        }
        torques
    }

    fn is_finite(&self) -> bool {
        let base = &self.configuration.base;
        base.translation
            .iter()
            .chain(base.rotation.matrix().iter())
            .all(|x| x.is_finite_number())
            && self
                .configuration
                .joints
                .iter()
                .all(|x| x.is_finite_number())
            && self
                .velocity
                .base
                .to_array()
                .iter()
                .all(|x| x.is_finite_number())
            && self.velocity.joints.iter().all(|x| x.is_finite_number())
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const S: usize, const C: usize> Simulator<T, N, C>
    for NativeSimulator<T, M, N, S, C>
{
    type Error = Error;

    fn reset(&mut self, configuration: &Configuration<T, N>, velocity: &Tangent<T, N>) {
        self.configuration = *configuration;
        self.velocity = *velocity;
        self.acceleration = Tangent::ZERO;
        self.contacts = [[ContactState::NONE; SLOTS]; S];
        self.mean_forces_w = [Vector3::zeros(); C];
        self.mean_link_forces = [T::ZERO; C];
        self.delivered = [T::ZERO; N];
        self.stops = [T::ZERO; N];
        self.ticks = 0;
    }

    fn step(&mut self, command: &[T; N]) -> Result<(), Error> {
        if let Some(joint) = command.iter().position(|tau| !tau.is_finite_number()) {
            return Err(Error::TorqueNotFinite(joint));
        }
        if self.ticks == 0 {
            // Not in `new`, which is `const`.
            for (mass, shape) in self.masses.iter_mut().zip(&self.shapes) {
                *mass = contact_mass(&self.model, shape);
            }
        }
        let count = self.settings.substeps.max(1);
        let share = T::ONE / T::of(f64::from(count));
        let h = self.settings.tick * share;
        self.mean_forces_w = [Vector3::zeros(); C];
        self.mean_link_forces = [T::ZERO; C];
        for _ in 0..count {
            self.advance(command, h, share);
        }
        self.configuration.base.rotation = orthonormalize_step(&self.configuration.base.rotation);
        self.ticks += 1;
        if self.is_finite() {
            Ok(())
        } else {
            Err(Error::StateNotFinite)
        }
    }

    fn tick(&self) -> T {
        self.settings.tick
    }

    fn time(&self) -> T {
        T::of(self.ticks as f64) * self.settings.tick
    }

    fn configuration(&self) -> &Configuration<T, N> {
        &self.configuration
    }

    fn velocity(&self) -> &Tangent<T, N> {
        &self.velocity
    }

    fn delivered(&self) -> &[T; N] {
        &self.delivered
    }

    fn contact_forces_w(&self) -> &[Vector3<T>; C] {
        &self.mean_forces_w
    }

    fn link_forces(&self) -> &[T; C] {
        &self.mean_link_forces
    }

    fn stop_torques(&self) -> &[T; N] {
        &self.stops
    }
}
