//! What the machine is told: encoders, foot sensors, an IMU, and the base as `state-est` makes it of them; never the truth. In a
//! nominal run the sensors are without error.

use super::imu::{Legs, Observer};
use crate::lab::{Disturbance, Encoders, FootSensors, Ground, Interface, Link};
use crate::noise::Noise;
use jump_control::Measurement;
use jump_machine::Observation;
use nalgebra::Vector3;
use rbd_core::{Configuration, Tangent, Transform, Tree};
use state_est::{Foot, Status};

/// The feet of a robot in a world of `C` contacts.
#[derive(Clone, Copy)]
pub struct Feet<const N: usize, const F: usize, const C: usize> {
    /// Where they are.
    pub feet: [Foot<f64>; F],
    /// Force at which a foot is certainly loaded, N.
    pub loaded: f64,
    /// Samples that the estimator is given before the machine begins.
    pub settling: u32,
    /// The ground's force on each, N.
    pub forces: fn(&Ground<N, C>) -> [f64; F],
}

/// What else sensors depend on.
pub struct Setting<'a, const N: usize> {
    /// How the lab differs from the plan.
    pub disturbance: &'a Disturbance,
    /// How the motors are commanded: it says where the link's latency lies.
    pub interface: Interface,
    /// Of all noise.
    pub seed: u64,
    /// Where the robot is at first.
    pub start: &'a Configuration<f64, N>,
    /// How it moves there: not at all, unless it is thrown.
    pub moving: &'a Tangent<f64, N>,
}

/// The sensors of one run.
pub struct Sensors<R, const N: usize, const F: usize, const C: usize, const E: usize> {
    noise: Noise,
    encoders: Encoders<N>,
    soles: FootSensors<F>,
    robot: R,
    feet: Feet<N, F, C>,
    observer: Observer<N, F, E>,
    link: Link<Observation<f64, N, F>>,
    /// Pose of the simulator's world in the machine's.
    world: Transform<f64>,
    /// Largest error of the estimated base's place and of its orientation since the start: m, rad.
    pub worst: [f64; 2],
}

impl<R: Tree<f64, N>, const N: usize, const F: usize, const C: usize, const E: usize>
    Sensors<R, N, F, C, E>
{
    /// Draws the errors that stay for the whole run.
    pub fn new(robot: R, feet: Feet<N, F, C>, setting: &Setting<'_, N>) -> Self {
        let disturbance = setting.disturbance;
        let mut noise = Noise::new(setting.seed.wrapping_add(0x5eed), 1.0);
        let start = (setting.start, setting.moving);
        let observer = Observer::new(&robot, feet.feet, disturbance, start, &mut noise);
        let (share, least) = setting.interface.measuring();
        Self {
            encoders: Encoders::new(disturbance, &mut noise),
            soles: FootSensors::new(disturbance, &mut noise),
            link: Link::new(disturbance, share, least, setting.seed.wrapping_add(0x11e7)),
            noise,
            observer,
            robot,
            feet,
            world: Transform::IDENTITY,
            worst: [0.0; 2],
        }
    }

    /// The robot, which stands, begins anew where it is: the machine is told that the middle of its feet is at `middle_w` and that its base heads along
    /// `heading`, rad, as [`state_est::State::stand_at`] has it, in a world in which the simulator's has the pose `world`. False where a foot does not stand.
    #[must_use]
    pub fn stand_at(
        &mut self,
        middle_w: &Vector3<f64>,
        heading: f64,
        world: Transform<f64>,
    ) -> bool {
        let stands = self.observer.stand_at(middle_w, heading);
        if stands {
            self.world = world;
            self.worst = [0.0; 2];
        }
        stands
    }

    /// Where the feet stand, as [`state_est::State::feet`] has it.
    #[must_use]
    pub fn feet_w(&self) -> Option<[Vector3<f64>; F]> {
        self.observer.feet()
    }

    /// Joint positions and speeds as the encoders say now.
    pub fn encoders(&mut self, world: &Ground<N, C>) -> ([f64; N], [f64; N]) {
        let (q, v) = (world.configuration(), world.velocity());
        self.encoders.read(&q.joints, &v.joints, &mut self.noise)
    }

    /// Before the machine begins at time `now`, s: the robot rests in its stand, and samples of it arrive by then, at least one where the
    /// link is late.
    pub fn begin(&mut self, now: f64, world: &Ground<N, C>) {
        let early = self.link.longest();
        let count = self.feet.settling.max(u32::from(early > 0.0));
        for earlier in (1..=count).rev() {
            let before = now - early - f64::from(earlier) * 1e-3;
            self.measure(before, world, &[0.0; N]);
        }
    }

    /// Samples everything at time `now`, s, and hands over what arrives then, given the torques since the last sample.
    pub fn measure(
        &mut self,
        now: f64,
        world: &Ground<N, C>,
        joint_torques: &[f64; N],
    ) -> Option<Observation<f64, N, F>> {
        let (joints, joint_velocities) = self.encoders(world);
        let forces = (self.feet.forces)(world);
        let foot_forces = self.soles.read(forces, &mut self.noise);
        let legs = Legs {
            joints,
            joint_velocities,
            evidence: foot_forces.map(|f| (f / self.feet.loaded).min(1.0)),
        };
        let (q, v) = (world.configuration(), world.velocity());
        let estimate = self
            .observer
            .step(&self.robot, &q, v, &legs, &mut self.noise);
        let base = self.world.compose(&q.base);
        let turn = so3::log(&(estimate.base.rotation * base.rotation.inverse()));
        let place = (estimate.base.translation - base.translation).norm();
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
        let joint_torques = *joint_torques;
        self.link.send(
            now,
            Observation {
                measured,
                joint_torques,
            },
        );
        let (mut told, age) = self.link.receive(now)?;
        told.measured.age += age;
        Some(told)
    }
}
