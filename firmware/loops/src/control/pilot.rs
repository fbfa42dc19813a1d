//! The jump machine behind the estimator: for a robot with an IMU instead of a simulator that knows where it is.

use a1_model::{A1Geared, FOOT_RADIUS};
use jump_control::{JointCommand, Measurement, Phase};
use jump_machine::Workspace;
use jump_machine::{Machine, Observation};
use nalgebra::Vector3;
use rbd_core::{Configuration, Model, Transform};
use saltus_probe::Real;
use saltus_probe::flight::{HOLD, Planned, feet, jump, settings};
use state_est::{Estimator, Foot, Sample, Settings, State, Status};

use super::{Control, Heard, Jumper};
use crate::joints::Joints;
use crate::link::Sensed;

/// Time between two ticks, s.
const PERIOD: f64 = 1e-3;
/// Force at which a foot is certainly loaded, N.
const LOADED: f64 = 15.0;
/// Age at which the estimator is to coast, s.
const LATE: f64 = 0.002;

/// Estimator, machine and clock. The robot stands; when the operator wants the jump, it begins after 1.2 s.
#[derive(Debug)]
pub struct Pilot<T: Planned>
where
    A1Geared: Model<T, 12>,
{
    estimator: Estimator<T, 12, 4, 6>,
    /// None before the first report.
    state: Option<State<T, 4, 6>>,
    machine: Machine<'static, T, A1Geared, 12, 4>,
    wanted: bool,
    ticks: u32,
}

impl<T: Planned> Pilot<T>
where
    A1Geared: Model<T, 12>,
{
    /// The robot at rest where the plan begins, with its joints as they are.
    fn at_start(&self, heard: &Sensed<T>) -> State<T, 4, 6> {
        let base = T::nodes()
            .first()
            .map_or(Transform::IDENTITY, |node| node.base);
        let start = Configuration {
            base,
            joints: heard.joints[0],
        };
        State::new(&self.estimator, &A1Geared, &start)
    }

    /// Where the jump is.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.machine.phase()
    }
}

impl<T: Planned> Control<T, 12> for Pilot<T>
where
    A1Geared: Model<T, 12>,
{
    type Heard = Sensed<T>;
    type Memory = Workspace<T, 12, 4>;

    fn memory() -> Self::Memory {
        Workspace::new()
    }

    /// Standing, without a jump; `None` if the plan in flash is refused.
    fn new(workspace: &'static mut Self::Memory) -> Option<Self> {
        jump::<T>()?;
        let radius = T::of(FOOT_RADIUS);
        Some(Self {
            estimator: Estimator {
                feet: feet().map(|frame| Foot { frame, radius }),
                imu: Transform::IDENTITY,
                settings: Settings::new(),
            },
            state: None,
            machine: Machine::new(&A1Geared, settings(), workspace),
            wanted: false,
            ticks: 0,
        })
    }

    fn joints() -> Joints<T, 12> {
        Jumper::joints()
    }

    fn tick(&mut self, heard: &Sensed<T>) {
        let now = T::of(f64::from(self.ticks)) * T::of(PERIOD);
        self.ticks = self.ticks.wrapping_add(1);
        let [joints, joint_velocities] = heard.joints;
        // Where and how it stands is known when it is about to jump: what the estimate has drifted is forgotten.
        let asked = heard.jump && !self.wanted;
        self.wanted = heard.jump;
        let begins =
            asked && jump().is_some_and(|jump| self.machine.arm(jump, now + T::of(HOLD)).is_ok());
        let mut state = match self.state {
            Some(state) if !begins => state,
            _ if heard.age <= T::of(LATE) => self.at_start(heard),
            Some(state) => state,
            // Nothing has been heard yet: the machine begins with the first report.
            None => return,
        };
        let sample = Sample {
            specific_force_i: heard.imu[0],
            angular_velocity_i: heard.imu[1],
            joints,
            joint_velocities,
            evidence: heard
                .foot_forces
                .map(|force| so3::math::clamp(force / T::of(LOADED), T::ZERO, T::ONE)),
        };
        let sample = (heard.age <= T::of(LATE)).then_some(&sample);
        let estimate = self
            .estimator
            .step(&A1Geared, &mut state, sample, T::of(PERIOD));
        self.state = Some(state);
        let age = match estimate.status {
            Status::Lost => T::INFINITY,
            _ => heard.age,
        };
        let inputs = Observation {
            measured: Measurement {
                base: estimate.base,
                base_velocity: estimate.velocity,
                joints,
                joint_velocities,
                foot_forces: heard.foot_forces,
                age,
            },
            joint_torques: heard.joint_torques,
        };
        self.machine.tick(now, Some(&inputs));
    }

    fn command(&self) -> &JointCommand<T, 12> {
        self.machine.command()
    }
}

impl<T: Real> Heard<T> for Sensed<T> {
    fn read(mut next: impl FnMut() -> T) -> Self {
        Self {
            joints: core::array::from_fn(|_| core::array::from_fn(|_| next())),
            joint_torques: core::array::from_fn(|_| next()),
            imu: core::array::from_fn(|_| Vector3::new(next(), next(), next())),
            foot_forces: core::array::from_fn(|_| next()),
            age: next(),
            jump: next() > T::ZERO,
        }
    }
}
