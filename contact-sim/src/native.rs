//! The embedded simulator.
//!
//! One integration step of length h is a position-Verlet step: the configuration moves half a step with
//! the old velocity, the acceleration is found there, and the configuration moves the other half with the new
//! velocity. Forces see the velocity extrapolated to the middle, ν + ½h ν̇_last, in the smooth terms of
//! the dynamics (second order), and the old velocity in contact and joint friction (dissipative).

use nalgebra::Vector3;
use rbd_core::{
    AbaWorkspace, BodyMotions, Configuration, Effort, Force, Kinematics, Link, Posture, Tangent,
    Tree, aba_with_forces, forward_kinematics, forward_velocities, integrate, joint_friction,
};
use so3::{Scalar, math, orthonormalize_step};

use crate::{ContactSphere, ContactState, Error, Settings, Simulator, Terrain};

/// The embedded simulator: a robot `M` with `N` joints and `C` contact spheres, and all its state.
#[derive(Clone, Debug)]
pub struct NativeSimulator<T: Scalar, M, const N: usize, const C: usize> {
    /// The robot.
    pub model: M,
    /// Its contact spheres.
    pub spheres: [ContactSphere<T>; C],
    /// The world.
    pub terrain: Terrain<T>,
    /// The plant's parameters.
    pub settings: Settings<T, N>,
    configuration: Configuration<T, N>,
    velocity: Tangent<T, N>,
    acceleration: Tangent<T, N>,
    contacts: [ContactState<T>; C],
    mean_forces_w: [Vector3<T>; C],
    delivered: [T; N],
    ticks: u64,
    kinematics: Kinematics<T, N>,
    motions: BodyMotions<T, N>,
    workspace: AbaWorkspace<T, N>,
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const C: usize> NativeSimulator<T, M, N, C> {
    /// A robot at the world's origin, at rest, untouched.
    #[must_use]
    pub const fn new(
        model: M,
        spheres: [ContactSphere<T>; C],
        terrain: Terrain<T>,
        settings: Settings<T, N>,
    ) -> Self {
        Self {
            model,
            spheres,
            terrain,
            settings,
            configuration: Configuration::NEUTRAL,
            velocity: Tangent::ZERO,
            acceleration: Tangent::ZERO,
            contacts: [ContactState::NONE; C],
            mean_forces_w: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); C],
            delivered: [T::ZERO; N],
            ticks: 0,
            kinematics: Kinematics::IDENTITY,
            motions: BodyMotions::ZERO,
            workspace: AbaWorkspace::new(),
        }
    }

    /// The contacts after the last integration step.
    #[must_use]
    pub const fn contacts(&self) -> &[ContactState<T>; C] {
        &self.contacts
    }

    /// Acceleration found in the last integration step.
    #[must_use]
    pub const fn acceleration(&self) -> &Tangent<T, N> {
        &self.acceleration
    }

    fn advance(&mut self, command: &[T; N], h: T) {
        let half = h * T::HALF;
        let middle = integrate(&self.configuration, &(self.velocity * half));
        let posture = Posture::new(&self.model, &middle);
        let (base, bodies) = self.contact_forces(&posture, h);
        let smooth = self.velocity + self.acceleration * half;
        let effort = Effort {
            base,
            joints: self.joint_torques(command, &middle.joints),
        };
        self.acceleration = aba_with_forces(
            &self.model,
            &posture,
            &smooth,
            &effort,
            &bodies,
            &mut self.workspace,
        );
        self.velocity = self.velocity + self.acceleration * h;
        self.configuration = integrate(&middle, &(self.velocity * half));
    }

    /// Advances the contacts; returns their wrenches on the base and on the bodies, in body frames.
    fn contact_forces(&mut self, posture: &Posture<T, N>, h: T) -> (Force<T>, [Force<T>; N]) {
        forward_kinematics(&self.model, posture, &mut self.kinematics);
        forward_velocities(&self.model, posture, &self.velocity, &mut self.motions);
        let mut base = Force::ZERO;
        let mut bodies = [Force::ZERO; N];
        for (sphere, state) in self.spheres.iter().zip(&mut self.contacts) {
            let xf_wl = self.kinematics.link(sphere.link);
            let center_w = xf_wl.point(&Vector3::from(sphere.offset));
            let touch = self.terrain.touch(&center_w, sphere.radius);
            let arm_w = center_w - touch.normal_w * sphere.radius - xf_wl.translation;
            let motion = match sphere.link {
                Link::Base => Some(&self.velocity.base),
                Link::Joint(i) => self.motions.velocities.get(i),
            };
            let velocity_w = motion.map_or_else(Vector3::zeros, |m| {
                xf_wl.rotation * m.linear + (xf_wl.rotation * m.angular).cross(&arm_w)
            });
            let point_w = xf_wl.translation + arm_w;
            self.settings
                .contact
                .advance(state, &touch, &point_w, &velocity_w, h);
            if touch.depth <= T::ZERO {
                continue;
            }
            let linear = xf_wl.rotation.matrix().tr_mul(&state.force_w);
            let arm = xf_wl.rotation.matrix().tr_mul(&arm_w);
            let wrench = Force::new(linear, arm.cross(&linear));
            match sphere.link {
                Link::Base => base += wrench,
                Link::Joint(i) => {
                    if let Some(total) = bodies.get_mut(i) {
                        *total += wrench;
                    }
                }
            }
        }
        (base, bodies)
    }

    /// Motor, friction and stop torques.
    fn joint_torques(&mut self, command: &[T; N], q: &[T; N]) -> [T; N] {
        let s = &self.settings;
        let mut torques = joint_friction(&s.limits, &self.velocity.joints, s.friction_smoothing);
        let given = self.delivered.iter_mut().zip(command).zip(&s.motors);
        let state = q.iter().zip(&self.velocity.joints).zip(&s.limits);
        for ((tau, ((delivered, wanted), motor)), ((q, qd), limits)) in
            torques.iter_mut().zip(given).zip(state)
        {
            let [low, high] = motor.torque_range(*qd);
            *delivered = math::clamp(*wanted, low, high);
            *tau += *delivered + s.stops.torque(limits, *q, *qd);
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

impl<T: Scalar, M: Tree<T, N>, const N: usize, const C: usize> Simulator<T, N, C>
    for NativeSimulator<T, M, N, C>
{
    type Error = Error;

    fn reset(&mut self, configuration: &Configuration<T, N>, velocity: &Tangent<T, N>) {
        self.configuration = *configuration;
        self.velocity = *velocity;
        self.acceleration = Tangent::ZERO;
        self.contacts = [ContactState::NONE; C];
        self.mean_forces_w = [Vector3::zeros(); C];
        self.delivered = [T::ZERO; N];
        self.ticks = 0;
    }

    fn step(&mut self, command: &[T; N]) -> Result<(), Error> {
        if let Some(joint) = command.iter().position(|tau| !tau.is_finite_number()) {
            return Err(Error::TorqueNotFinite(joint));
        }
        let count = self.settings.substeps.max(1);
        let share = T::ONE / T::of(f64::from(count));
        let h = self.settings.tick * share;
        self.mean_forces_w = [Vector3::zeros(); C];
        for _ in 0..count {
            self.advance(command, h);
            for (mean, contact) in self.mean_forces_w.iter_mut().zip(&self.contacts) {
                *mean += contact.force_w * share;
            }
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
}
