//! MuJoCo as the plant: an independent judge of what the native simulator says.
//!
//! Torques are limited by the motors as in the native simulator and applied as generalised forces; joint damping,
//! Coulomb friction, stops and contacts are MuJoCo's own, with the softness and friction of
//! [`Settings::contact`](crate::Settings::contact).

use std::boxed::Box;
use std::vec::Vec;

use nalgebra::Vector3;
use rbd_core::convert::{
    acceleration_from_mujoco, base_from_mujoco, base_to_mujoco, velocity_from_mujoco,
    velocity_to_mujoco,
};
use rbd_core::{BaseKind, Configuration, Tangent, Tree};
use so3::math;

use crate::engine::{Compile, Engine, EngineFailed, NoEngine};
use crate::mjcf::{Geom, geom_name, mjcf, stopped};
use crate::{Error, Settings, Simulator, Terrain};

/// A robot with `N` joints and `C` owners of shapes in MuJoCo.
#[derive(Debug)]
pub struct MujocoSimulator<const N: usize, const C: usize> {
    settings: Settings<f64, N>,
    engine: Box<dyn Engine>,
    /// The owner that each of MuJoCo's geoms counts for.
    owners: Vec<Option<usize>>,
    /// Length of the base's part of the positions and of the velocities.
    base: (usize, usize),
    /// Generalised forces of the next call: none on the base.
    applied: Vec<f64>,
    configuration: Configuration<f64, N>,
    velocity: Tangent<f64, N>,
    mean_forces_w: [Vector3<f64>; C],
    mean_link_forces: [f64; C],
    delivered: [f64; N],
    /// Joints in the order of the sensors that tell the torques of their stops.
    stopped: Vec<usize>,
    stops: [f64; N],
    ticks: u64,
}

impl<const N: usize, const C: usize> MujocoSimulator<N, C> {
    /// A robot at the world's origin, at rest; `compile` says where MuJoCo comes from. `geoms` whose owner is not below `C` touch, but nobody
    /// sees their force. Of `pairs`, bit j of number i says that geoms i and j touch each other
    /// ([`self_contacts`](crate::self_contacts)).
    ///
    /// # Errors
    /// [`NoEngine`] for tables that are no robot to MuJoCo, such as an inertia that no mass distribution has, or where there is no MuJoCo.
    pub fn new<M: Tree<f64, N>>(
        compile: Compile,
        model: &M,
        (geoms, pairs): (&[Geom], &[u64]),
        terrain: &Terrain<f64>,
        settings: Settings<f64, N>,
    ) -> Result<Self, NoEngine> {
        let engine = compile(&mjcf(model, (geoms, pairs), terrain, &settings))?;
        let mut owners = Vec::new();
        for (index, geom) in geoms.iter().enumerate() {
            if let Some(id) = engine.geom_id(&geom_name(index)) {
                owners.resize(owners.len().max(id + 1), None);
                owners[id] = Some(geom.owner());
            }
        }
        let base = match model.base_kind() {
            BaseKind::Floating => (7, 6),
            BaseKind::Fixed => (0, 0),
        };
        Ok(Self {
            engine,
            owners,
            base,
            applied: std::vec![0.0; base.1 + model.joint_count()],
            configuration: Configuration::NEUTRAL,
            velocity: Tangent::ZERO,
            mean_forces_w: [Vector3::zeros(); C],
            mean_link_forces: [0.0; C],
            delivered: [0.0; N],
            stopped: stopped(model.joint_count(), &settings).collect(),
            stops: [0.0; N],
            settings,
            ticks: 0,
        })
    }

    /// The acceleration in the present state under these joint torques, whatever the motors can do; no step is taken.
    ///
    /// # Errors
    /// [`Error::EngineFailed`].
    pub fn acceleration(&mut self, torques: &[f64; N]) -> Result<Tangent<f64, N>, Error> {
        self.apply(torques);
        self.engine.forward(&self.applied)?;
        let mut acceleration = Tangent::ZERO;
        let (base, joints) = self.engine.qacc().split_at(self.base.1);
        if let Some(qacc) = base.first_chunk() {
            acceleration.base =
                acceleration_from_mujoco(&self.configuration.base, &self.velocity.base, qacc);
        }
        copy(&mut acceleration.joints, joints);
        Ok(acceleration)
    }

    fn apply(&mut self, torques: &[f64; N]) {
        copy(
            self.applied.get_mut(self.base.1..).unwrap_or_default(),
            torques,
        );
    }

    /// Adds the contact forces of the last MuJoCo step, and reads the stops' torques.
    fn add_forces(&mut self, share: f64) {
        for contact in self.engine.contacts() {
            let mut force_w = Vector3::zeros();
            for (axis, f) in contact.frame.chunks(3).zip(contact.force) {
                force_w += Vector3::from_row_slice(axis) * (share * f);
            }
            let owner = |geom: i32| {
                let id = usize::try_from(geom).ok()?;
                *self.owners.get(id)?
            };
            // The force acts on the second geom.
            match contact.geoms.map(owner) {
                [Some(a), Some(b)] => {
                    for owner in [a, b] {
                        if let Some(sum) = self.mean_link_forces.get_mut(owner) {
                            *sum += math::sqrt(force_w.norm_squared());
                        }
                    }
                }
                [Some(first), None] => add(&mut self.mean_forces_w, first, &-force_w),
                [None, Some(second)] => add(&mut self.mean_forces_w, second, &force_w),
                [None, None] => {}
            }
        }
        for (joint, torque) in self.stopped.iter().zip(self.engine.sensordata()) {
            if let Some(stop) = self.stops.get_mut(*joint) {
                *stop = *torque;
            }
        }
    }

    /// Reads MuJoCo's state; whether it is finite.
    fn read(&mut self) -> bool {
        let (base, joints) = self.engine.qpos().split_at(self.base.0);
        let mut good = true;
        if let Some(qpos) = base.first_chunk() {
            match base_from_mujoco(qpos) {
                Ok(pose) => self.configuration.base = pose,
                Err(_) => good = false,
            }
        }
        copy(&mut self.configuration.joints, joints);
        let (base, joints) = self.engine.qvel().split_at(self.base.1);
        if let Some(qvel) = base.first_chunk() {
            self.velocity.base = velocity_from_mujoco(&self.configuration.base, qvel);
        }
        copy(&mut self.velocity.joints, joints);
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        good && finite(self.engine.qpos()) && finite(self.engine.qvel())
    }
}

impl From<EngineFailed> for Error {
    fn from(_: EngineFailed) -> Self {
        Self::EngineFailed
    }
}

fn add(sums: &mut [Vector3<f64>], owner: usize, force_w: &Vector3<f64>) {
    if let Some(sum) = sums.get_mut(owner) {
        *sum += force_w;
    }
}

fn copy(to: &mut [f64], from: &[f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

impl<const N: usize, const C: usize> Simulator<f64, N, C> for MujocoSimulator<N, C> {
    type Error = Error;

    fn reset(&mut self, configuration: &Configuration<f64, N>, velocity: &Tangent<f64, N>) {
        let (q, v) = (&configuration.joints, &velocity.joints);
        let base = base_to_mujoco(&configuration.base);
        let moving = velocity_to_mujoco(&configuration.base, &velocity.base);
        let joined = |base: &[f64], joints: &[f64]| -> Vec<f64> { [base, joints].concat() };
        self.engine.reset(
            &joined(&base[..self.base.0], q),
            &joined(&moving[..self.base.1], v),
        );
        self.configuration = *configuration;
        self.velocity = *velocity;
        self.mean_forces_w = [Vector3::zeros(); C];
        self.mean_link_forces = [0.0; C];
        self.delivered = [0.0; N];
        self.stops = [0.0; N];
        self.ticks = 0;
    }

    fn step(&mut self, command: &[f64; N]) -> Result<(), Error> {
        if let Some(joint) = command.iter().position(|tau| !tau.is_finite()) {
            return Err(Error::TorqueNotFinite(joint));
        }
        let count = self.settings.substeps.max(1);
        self.mean_forces_w = [Vector3::zeros(); C];
        self.mean_link_forces = [0.0; C];
        for _ in 0..count {
            let mut delivered = *command;
            let state = self.velocity.joints.iter().zip(&self.settings.motors);
            for (tau, (qd, motor)) in delivered.iter_mut().zip(state) {
                let [low, high] = motor.torque_range(*qd);
                *tau = math::clamp(*tau, low, high);
            }
            self.delivered = delivered;
            self.apply(&delivered);
            self.engine.step(&self.applied)?;
            self.add_forces(1.0 / f64::from(count));
            if !self.read() {
                return Err(Error::StateNotFinite);
            }
        }
        self.ticks += 1;
        Ok(())
    }

    fn tick(&self) -> f64 {
        self.settings.tick
    }

    fn time(&self) -> f64 {
        self.ticks as f64 * self.settings.tick
    }

    fn configuration(&self) -> &Configuration<f64, N> {
        &self.configuration
    }

    fn velocity(&self) -> &Tangent<f64, N> {
        &self.velocity
    }

    fn delivered(&self) -> &[f64; N] {
        &self.delivered
    }

    fn contact_forces_w(&self) -> &[Vector3<f64>; C] {
        &self.mean_forces_w
    }

    fn link_forces(&self) -> &[f64; C] {
        &self.mean_link_forces
    }

    fn stop_torques(&self) -> &[f64; N] {
        &self.stops
    }
}
