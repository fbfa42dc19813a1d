//! The controller's end: states in, commands out, with an estimator and a jump machine between them.

use jump_control::Measurement;
use jump_machine::{JumpMachine, Observation};
use nalgebra::Vector3;
use rbd_core::{Configuration, Transform, Tree};
use so3::{Scalar, math};
use state_est::{Estimate, Estimator, Sample, Status};

use crate::command::Command;
use crate::end::End;
use crate::peer::{Peer, Tally};
use crate::state::State;

/// Time between a robot's first sample and the one before, which nobody has heard, s.
const PERIOD: f64 = 1e-3;

/// The controller of a robot of model `M` with `N` joints and `F` feet, by the machine `K`; `E` is F + 2.
///
/// The estimator takes a step per state, as long as the robot's own stamps say that it was. The machine ticks once per turn, at 1 kHz; where no
/// state has come since the last it goes on with that one's, and its own watch ends in damping when that is too old. A robot whose watchdog
/// has tripped is not listened to, which ends there as well.
pub struct Pilot<'a, T: Scalar, M, K, const N: usize, const F: usize, const E: usize> {
    /// What commands. It ticks from the first state in force on.
    pub machine: K,
    model: &'a M,
    estimator: Estimator<T, N, F, E>,
    settings: Settings<T>,
    peer: Peer<State<N, F>>,
    state: Option<state_est::State<T, F, E>>,
    /// Of the last sample, on the robot's clock, ns.
    stamp: u64,
    /// What the machine is to be told; its age is that of its state when it is told.
    observed: Option<Observation<T, N, F>>,
    is_news: bool,
    /// When the machine's clock was zero, ns.
    origin: Option<u64>,
    turns: u32,
}

/// What a pilot is told of its robot and its link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T: Scalar> {
    /// Pose of the base in the world where the robot stands at first.
    pub base: Transform<T>,
    /// Force at which a foot is certainly loaded, N.
    pub loaded: T,
    /// Turns per command: 1 for a link of 1 kHz, 2 for one of 500 Hz.
    pub turns_per_command: u32,
}

impl<'a, T, M, K, const N: usize, const F: usize, const E: usize> Pilot<'a, T, M, K, N, F, E>
where
    T: Scalar,
    M: Tree<T, N>,
    K: JumpMachine<T, N, F>,
{
    /// Nothing heard yet.
    pub const fn new(
        model: &'a M,
        estimator: Estimator<T, N, F, E>,
        machine: K,
        settings: Settings<T>,
    ) -> Self {
        Self {
            machine,
            model,
            estimator,
            settings,
            peer: Peer::new(),
            state: None,
            stamp: 0,
            observed: None,
            is_news: false,
            origin: None,
            turns: 0,
        }
    }

    /// The time on the machine's clock, s, at `now`, ns: zero at the first turn.
    #[must_use]
    pub fn time(&self, now: u64) -> T {
        let since = now.saturating_sub(self.origin.unwrap_or(now));
        T::of(since as f64 * 1e-9)
    }

    /// Whether a state has ever been in force: from then on the machine ticks.
    #[must_use]
    pub const fn is_told(&self) -> bool {
        self.observed.is_some()
    }

    /// The end of the link: its newest state in force, and what was said and heard.
    #[must_use]
    pub const fn peer(&self) -> &Peer<State<N, F>> {
        &self.peer
    }

    /// What was said and heard so far.
    #[must_use]
    pub const fn tally(&self) -> &Tally {
        self.peer.tally()
    }

    /// A step of the estimator from the last sample to this one.
    fn estimate(&mut self, sample: &Sample<T, N, F>, stamp: u64) -> Estimate<T, F> {
        let (model, estimator) = (self.model, &self.estimator);
        let dt = match self.state {
            // A stamp that goes back is a step of zero, which the estimator refuses.
            Some(_) => T::of(stamp.saturating_sub(self.stamp) as f64 * 1e-9),
            None => T::of(PERIOD),
        };
        self.stamp = stamp;
        let state = self.state.get_or_insert_with(|| {
            let start = Configuration {
                base: self.settings.base,
                joints: sample.joints,
            };
            state_est::State::new(estimator, model, &start)
        });
        estimator.step(model, state, Some(sample), dt)
    }
}

impl<T, M, K, const N: usize, const F: usize, const E: usize> End for Pilot<'_, T, M, K, N, F, E>
where
    T: Scalar,
    M: Tree<T, N>,
    K: JumpMachine<T, N, F>,
{
    fn hear(&mut self, bytes: &[u8], now: u64) {
        let Ok(heard) = self.peer.hear(bytes, now) else {
            return;
        };
        let (state, stamp) = (heard.packet, heard.stamp);
        if state.tripped {
            return;
        }
        let number = |x: f32| T::of(f64::from(x));
        let foot_forces = state.foot_forces.map(number);
        let loaded = self.settings.loaded;
        let sample = Sample {
            specific_force_i: Vector3::from(state.specific_force_i.map(number)),
            angular_velocity_i: Vector3::from(state.angular_velocity_i.map(number)),
            joints: state.joints.map(number),
            joint_velocities: state.joint_velocities.map(number),
            evidence: foot_forces.map(|force| math::clamp(force / loaded, T::ZERO, T::ONE)),
        };
        let estimate = self.estimate(&sample, stamp);
        self.observed = Some(Observation {
            measured: Measurement {
                base: estimate.base,
                base_velocity: estimate.velocity,
                joints: sample.joints,
                joint_velocities: sample.joint_velocities,
                foot_forces,
                age: match estimate.status {
                    Status::Lost => T::INFINITY,
                    _ => T::ZERO,
                },
            },
            joint_torques: state.joint_torques.map(number),
        });
        self.is_news = true;
    }

    fn turn(&mut self, now: u64, out: &mut [u8]) -> Option<usize> {
        self.origin = self.origin.or(Some(now));
        let time = self.time(now);
        if let Some(mut told) = self.observed {
            let age = self.peer.in_force(now).map(|heard| heard.age(now));
            told.measured.age += age.map_or(T::INFINITY, |age| T::of(age as f64 * 1e-9));
            let is_news = core::mem::replace(&mut self.is_news, false);
            self.machine.tick(time, is_news.then_some(&told));
        }
        let turns = self.turns;
        self.turns = turns.wrapping_add(1);
        if !turns.is_multiple_of(self.settings.turns_per_command.max(1)) {
            return None;
        }
        let command = Command::of(self.machine.command());
        self.peer.say(&command, now, out)
    }
}
