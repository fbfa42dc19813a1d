//! The MuJoCo that a program is linked with.

use std::boxed::Box;
use std::string::ToString;
use std::vec::Vec;

use mujoco_rs::prelude::{MjData, MjModel, MjtObjBase};

use crate::engine::{ContactPoint, Engine, EngineFailed, NoEngine};

/// The version of the MuJoCo library that is linked, such as `3.17.0`.
#[must_use]
pub fn mujoco_version() -> &'static str {
    mujoco_rs::mujoco_version()
}

/// Compiles a model by the library that is linked: a [`Compile`](crate::Compile).
///
/// # Errors
/// [`NoEngine::Refused`] for what is no model to MuJoCo.
pub fn linked(mjcf: &str) -> Result<Box<dyn Engine>, NoEngine> {
    let model = MjModel::from_xml_string(mjcf).map_err(|e| NoEngine::Refused(e.to_string()))?;
    Ok(Box::new(Linked {
        data: MjData::new(Box::new(model)),
        contacts: Vec::new(),
    }))
}

#[derive(Debug)]
struct Linked {
    data: MjData<Box<MjModel>>,
    contacts: Vec<ContactPoint>,
}

impl Linked {
    fn apply(&mut self, forces: &[f64]) {
        for (slot, force) in self.data.qfrc_applied_mut().iter_mut().zip(forces) {
            *slot = *force;
        }
    }
}

impl Engine for Linked {
    fn geom_id(&self, name: &str) -> Option<usize> {
        self.data.model().name_to_id(MjtObjBase::mjOBJ_GEOM, name)
    }

    fn reset(&mut self, qpos: &[f64], qvel: &[f64]) {
        self.data.reset();
        for (slot, q) in self.data.qpos_mut().iter_mut().zip(qpos) {
            *slot = *q;
        }
        for (slot, v) in self.data.qvel_mut().iter_mut().zip(qvel) {
            *slot = *v;
        }
    }

    fn forward(&mut self, applied: &[f64]) -> Result<(), EngineFailed> {
        self.apply(applied);
        self.data.forward();
        Ok(())
    }

    fn step(&mut self, applied: &[f64]) -> Result<(), EngineFailed> {
        self.apply(applied);
        self.data.step();
        self.contacts.clear();
        for (index, contact) in self.data.contact().iter().enumerate() {
            if let Ok(force) = self.data.try_contact_force(index) {
                self.contacts.push(ContactPoint {
                    geoms: contact.geom,
                    frame: contact.frame,
                    force,
                });
            }
        }
        Ok(())
    }

    fn qpos(&self) -> &[f64] {
        self.data.qpos()
    }

    fn qvel(&self) -> &[f64] {
        self.data.qvel()
    }

    fn qacc(&self) -> &[f64] {
        self.data.qacc()
    }

    fn sensordata(&self) -> &[f64] {
        self.data.sensordata()
    }

    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
}
