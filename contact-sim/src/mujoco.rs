//! MuJoCo as the plant: an independent judge of what the native simulator says.
//!
//! Torques are limited by the motors as in the native simulator and applied as generalised forces; joint damping,
//! Coulomb friction, stops and contacts are MuJoCo's own. Of [`Settings::contact`](crate::Settings::contact) only
//! the friction coefficient has a meaning here.

use core::fmt;
use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;

use mujoco_rs::prelude::{MjData, MjModel, MjtObjBase};
use nalgebra::Vector3;
use rbd_core::convert::{
    acceleration_from_mujoco, base_from_mujoco, base_to_mujoco, velocity_from_mujoco,
    velocity_to_mujoco,
};
use rbd_core::{BaseKind, Configuration, Tangent, Tree};
use so3::math;

use crate::mjcf::{Geom, geom_name, mjcf};
use crate::{Error, Settings, Simulator, Terrain};

/// The version of the MuJoCo library that is linked, such as `3.17.0`.
#[must_use]
pub fn mujoco_version() -> &'static str {
    mujoco_rs::mujoco_version()
}

/// A robot with `N` joints and `C` contacts in MuJoCo.
#[derive(Debug)]
pub struct MujocoSimulator<const N: usize, const C: usize> {
    settings: Settings<f64, N>,
    data: MjData<Box<MjModel>>,
    /// The contact that each of MuJoCo's geoms counts for.
    owners: Vec<Option<usize>>,
    /// Length of the base's part of the positions and of the velocities.
    base: (usize, usize),
    configuration: Configuration<f64, N>,
    velocity: Tangent<f64, N>,
    mean_forces_w: [Vector3<f64>; C],
    delivered: [f64; N],
    ticks: u64,
}

/// MuJoCo refused the model, in its own words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelRefused(String);

impl fmt::Display for ModelRefused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MuJoCo refused the model: {}", self.0)
    }
}

impl core::error::Error for ModelRefused {}

impl<const N: usize, const C: usize> MujocoSimulator<N, C> {
    /// A robot at the world's origin, at rest; `geoms` whose contact is not below `C` touch, but nobody sees their force.
    ///
    /// # Errors
    /// [`ModelRefused`] for tables that are no robot to MuJoCo, such as an inertia that no mass distribution has.
    pub fn new<M: Tree<f64, N>>(
        model: &M,
        geoms: &[Geom],
        terrain: &Terrain<f64>,
        settings: Settings<f64, N>,
    ) -> Result<Self, ModelRefused> {
        let xml = mjcf(model, geoms, terrain, &settings);
        let compiled = MjModel::from_xml_string(&xml).map_err(|e| ModelRefused(e.to_string()))?;
        let mut owners = Vec::new();
        for (index, geom) in geoms.iter().enumerate() {
            if let Some(id) = compiled.name_to_id(MjtObjBase::mjOBJ_GEOM, &geom_name(index)) {
                owners.resize(owners.len().max(id + 1), None);
                owners[id] = Some(geom.contact);
            }
        }
        let mut data = MjData::new(Box::new(compiled));
        data.forward();
        Ok(Self {
            settings,
            data,
            owners,
            base: match model.base_kind() {
                BaseKind::Floating => (7, 6),
                BaseKind::Fixed => (0, 0),
            },
            configuration: Configuration::NEUTRAL,
            velocity: Tangent::ZERO,
            mean_forces_w: [Vector3::zeros(); C],
            delivered: [0.0; N],
            ticks: 0,
        })
    }

    /// The acceleration in the present state under these joint torques, whatever the motors can do; no step is taken.
    pub fn acceleration(&mut self, torques: &[f64; N]) -> Tangent<f64, N> {
        self.apply(torques);
        self.data.forward();
        let mut acceleration = Tangent::ZERO;
        let (base, joints) = self.data.qacc().split_at(self.base.1);
        if let Some(qacc) = base.first_chunk() {
            acceleration.base =
                acceleration_from_mujoco(&self.configuration.base, &self.velocity.base, qacc);
        }
        copy(&mut acceleration.joints, joints);
        acceleration
    }

    fn apply(&mut self, torques: &[f64; N]) {
        let slots = self.data.qfrc_applied_mut().iter_mut().skip(self.base.1);
        for (slot, tau) in slots.zip(torques) {
            *slot = *tau;
        }
    }

    /// Adds the contact forces of the last MuJoCo step.
    fn add_forces(&mut self, share: f64) {
        for (index, contact) in self.data.contact().iter().enumerate() {
            // The force acts on the second geom; of the two, one is the robot's.
            for (geom, sign) in contact.geom.iter().zip([-1.0, 1.0]) {
                let owner = usize::try_from(*geom)
                    .ok()
                    .and_then(|id| *self.owners.get(id)?);
                let Some(sum) = owner.and_then(|i| self.mean_forces_w.get_mut(i)) else {
                    continue;
                };
                let Ok(force) = self.data.try_contact_force(index) else {
                    continue;
                };
                for (axis, f) in contact.frame.chunks(3).zip(force) {
                    *sum += Vector3::from_row_slice(axis) * (sign * share * f);
                }
            }
        }
    }

    /// Reads MuJoCo's state; whether it is finite.
    fn read(&mut self) -> bool {
        let (base, joints) = self.data.qpos().split_at(self.base.0);
        let mut good = true;
        if let Some(qpos) = base.first_chunk() {
            match base_from_mujoco(qpos) {
                Ok(pose) => self.configuration.base = pose,
                Err(_) => good = false,
            }
        }
        copy(&mut self.configuration.joints, joints);
        let (base, joints) = self.data.qvel().split_at(self.base.1);
        if let Some(qvel) = base.first_chunk() {
            self.velocity.base = velocity_from_mujoco(&self.configuration.base, qvel);
        }
        copy(&mut self.velocity.joints, joints);
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        good && finite(self.data.qpos()) && finite(self.data.qvel())
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
        self.data.reset();
        let (base, joints) = self.data.qpos_mut().split_at_mut(self.base.0);
        copy(base, &base_to_mujoco(&configuration.base));
        copy(joints, &configuration.joints);
        let (base, joints) = self.data.qvel_mut().split_at_mut(self.base.1);
        copy(
            base,
            &velocity_to_mujoco(&configuration.base, &velocity.base),
        );
        copy(joints, &velocity.joints);
        self.configuration = *configuration;
        self.velocity = *velocity;
        self.mean_forces_w = [Vector3::zeros(); C];
        self.delivered = [0.0; N];
        self.ticks = 0;
    }

    fn step(&mut self, command: &[f64; N]) -> Result<(), Error> {
        if let Some(joint) = command.iter().position(|tau| !tau.is_finite()) {
            return Err(Error::TorqueNotFinite(joint));
        }
        let count = self.settings.substeps.max(1);
        self.mean_forces_w = [Vector3::zeros(); C];
        for _ in 0..count {
            let mut delivered = *command;
            let state = self.velocity.joints.iter().zip(&self.settings.motors);
            for (tau, (qd, motor)) in delivered.iter_mut().zip(state) {
                let [low, high] = motor.torque_range(*qd);
                *tau = math::clamp(*tau, low, high);
            }
            self.delivered = delivered;
            self.apply(&delivered);
            self.data.step();
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
}
