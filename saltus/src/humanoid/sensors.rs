//! What the controller is told: encoders, force sensors of the soles, an IMU, and the base as `state-est` makes it of them; never the
//! truth. In a nominal run the sensors are without error.

use super::{JOINTS, ROBOT, SPHERES, State, World};
use crate::lab::{Disturbance, Encoders, FootSensors, Link};
use crate::noise::Noise;
use crate::observer::{Legs, Observer};
use icub_model::SOLES;
use jump_control::Measurement;
use jump_machine::Observation;
use nalgebra::Vector3;
use state_est::{Foot, Status};

/// Force at which a sole is certainly loaded, N.
const LOADED: f64 = 40.0;

/// What arrives in one millisecond.
pub(crate) type Told = Observation<f64, JOINTS, 2>;

/// The sensors of one run.
pub(crate) struct Sensors {
    noise: Noise,
    encoders: Encoders<JOINTS>,
    soles: FootSensors<2>,
    observer: Observer<JOINTS, 2, 4>,
    link: Link<Told>,
    /// Whether anything has been measured.
    begun: bool,
    /// Largest error of the base's place and of its orientation since the start: m, rad.
    pub(crate) worst: [f64; 2],
}

impl Sensors {
    pub(crate) fn new(disturbance: &Disturbance, seed: u64, start: &State) -> Self {
        let mut noise = Noise::new(seed, 1.0);
        let feet = SOLES.map(|sole| Foot::of(&sole));
        let observer = Observer::new(&ROBOT, feet, disturbance, start, &mut noise);
        Self {
            encoders: Encoders::new(disturbance, &mut noise),
            soles: FootSensors::new(disturbance, &mut noise),
            link: Link::new(disturbance, 1.0, 0.0, seed.wrapping_add(0x11e7)),
            noise,
            observer,
            begun: false,
            worst: [0.0; 2],
        }
    }

    /// Joint positions and speeds as the encoders say now.
    pub(crate) fn encoders(&mut self, world: &World) -> ([f64; JOINTS], [f64; JOINTS]) {
        let (q, v) = (world.configuration().joints, world.velocity().joints);
        self.encoders.read(&q, &v, &mut self.noise)
    }

    /// The newest that has arrived at time `now`, s; the first sample at once, since the robot stands still before it.
    pub(crate) fn measure(&mut self, now: f64, world: &World) -> Option<Told> {
        let (q, v) = (world.configuration(), *world.velocity());
        let forces = sole_forces(world).map(|f| f.norm());
        let forces = self.soles.read(forces, &mut self.noise);
        let (joints, joint_velocities) = self.encoders(world);
        let legs = Legs {
            joints,
            joint_velocities,
            evidence: forces.map(|f| (f / LOADED).min(1.0)),
        };
        let estimate = self.observer.step(&ROBOT, &q, &v, &legs, &mut self.noise);
        let turn = so3::log(&(estimate.base.rotation * q.base.rotation.inverse()));
        let place = (estimate.base.translation - q.base.translation).norm();
        self.worst = [self.worst[0].max(place), self.worst[1].max(turn.norm())];
        let lost = estimate.status == Status::Lost;
        let measured = Measurement {
            base: estimate.base,
            base_velocity: estimate.velocity,
            joints,
            joint_velocities,
            foot_forces: forces,
            age: if lost { f64::INFINITY } else { 0.0 },
        };
        let sampled = Told {
            measured,
            felt: [0.0; JOINTS],
        };
        self.link.send(now, sampled);
        let arrived = self.link.receive(now);
        let first = !core::mem::replace(&mut self.begun, true);
        let Some((mut told, age)) = arrived else {
            return first.then_some(sampled);
        };
        told.measured.age += age;
        Some(told)
    }
}

/// Force of the ground on each sole.
pub(crate) fn sole_forces(world: &World) -> [Vector3<f64>; 2] {
    let f = world.plant().contact_forces_w();
    [f[..4].iter().sum(), f[4..SPHERES].iter().sum()]
}
