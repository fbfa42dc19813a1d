//! What the controller is told: encoders, foot sensors, an IMU, and the base as `state-est` makes it of them; never the truth. In a
//! nominal run the sensors are without error.

use super::{FOOT_COUNT, JOINTS, OWNERS};
use crate::lab::{Disturbance, Encoders, FootSensors, Ground, Interface, Link};
use crate::noise::Noise;
use crate::observer::{Legs, Observer};
use jump_control::Measurement;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use state_est::{Foot, Status};

/// What arrives at 1 kHz.
pub(crate) type Told = jump_machine::Inputs<f64, JOINTS, FOOT_COUNT>;

/// The robot in its lab.
pub(crate) type World = Ground<JOINTS, OWNERS>;

/// Force at which a foot is certainly loaded, N.
const LOADED: f64 = 15.0;

/// Samples that are taken before the controller begins.
const BEGIN: u32 = 5;

/// The sensors of one run.
pub(crate) struct Sensors {
    noise: Noise,
    encoders: Encoders<JOINTS>,
    feet: FootSensors<FOOT_COUNT>,
    robot: Quadruped,
    observer: Observer<JOINTS, FOOT_COUNT, 6>,
    link: Link<Told>,
    /// Largest error of the base's place and of its tilt and heading since the start: m, rad.
    pub(crate) worst: [f64; 2],
}

impl Sensors {
    pub(crate) fn new(
        disturbance: &Disturbance,
        interface: Interface,
        seed: u64,
        task: &Task,
    ) -> Self {
        let mut noise = Noise::new(seed.wrapping_add(0x5eed), 1.0);
        let robot = task.robot;
        let balls = robot.feet.map(|frame| Foot {
            frame,
            radius: robot.foot_radius,
        });
        let observer = Observer::new(&robot, balls, disturbance, &task.start, &mut noise);
        let (share, least) = interface.measuring();
        Self {
            encoders: Encoders::new(disturbance, &mut noise),
            feet: FootSensors::new(disturbance, &mut noise),
            link: Link::new(disturbance, share, least, seed.wrapping_add(0x11e7)),
            noise,
            observer,
            robot,
            worst: [0.0; 2],
        }
    }

    /// Joint positions and speeds as the encoders say now.
    pub(crate) fn encoders(&mut self, world: &World) -> ([f64; JOINTS], [f64; JOINTS]) {
        let (q, v) = (world.configuration(), world.velocity());
        self.encoders.read(&q.joints, &v.joints, &mut self.noise)
    }

    /// Before the controller begins at time `now`, s: the robot rests in its stand, and samples of it arrive by then.
    pub(crate) fn begin(&mut self, now: f64, world: &World) {
        let early = self.link.longest();
        for earlier in (1..=BEGIN).rev() {
            let before = now - early - f64::from(earlier) * 1e-3;
            self.measure(before, world, &[0.0; JOINTS]);
        }
    }

    /// Samples everything at time `now`, s, and hands over what arrives then, given the torques since the last sample.
    pub(crate) fn measure(
        &mut self,
        now: f64,
        world: &World,
        felt: &[f64; JOINTS],
    ) -> Option<Told> {
        let (joints, joint_velocities) = self.encoders(world);
        let forces = world.plant().contact_forces_w();
        let forces = core::array::from_fn(|i| forces[i].norm());
        let foot_forces = self.feet.read(forces, &mut self.noise);
        let legs = Legs {
            joints,
            joint_velocities,
            evidence: foot_forces.map(|f| (f / LOADED).min(1.0)),
        };
        let (q, v) = (world.configuration(), world.velocity());
        let estimate = self
            .observer
            .step(&self.robot, &q, v, &legs, &mut self.noise);
        let turn = so3::log(&(estimate.base.rotation * q.base.rotation.inverse()));
        let place = (estimate.base.translation - q.base.translation).norm();
        self.worst = [self.worst[0].max(place), self.worst[1].max(turn.norm())];
        let lost = estimate.status == Status::Lost;
        let measured = Measurement {
            base: estimate.base,
            base_velocity: estimate.velocity,
            joints,
            joint_velocities,
            foot_forces,
            age: if lost { f64::INFINITY } else { 0.0 },
        };
        let felt = *felt;
        self.link.send(now, Told { measured, felt });
        let (mut told, age) = self.link.receive(now)?;
        told.measured.age += age;
        Some(told)
    }
}
