//! The closed loop of a jump without `std`: the counterpart of `jump_lab::closed_loop` for boards, where nothing is allocated, the sensors tell
//! the truth and every call is recorded.

use contact_sim::{NativeSimulator, Simulator};
use jump_control::Measurement;
use jump_machine::{JumpMachine, Observation, Tick};
use nalgebra::Vector3;
use rbd_core::{Configuration, Tangent, Tree, joint_friction};
use so3::Scalar;

use super::{digest, digested};
use crate::{Numbers, Real, Recorder};

/// Joint ticks per tick of the machine.
pub(super) const RATIO: usize = 10;
/// Period of the machine, s.
const PERIOD: f64 = 1e-3;
/// Period of the joint loop, s.
const JOINT_PERIOD: f64 = 1e-4;

/// A robot of model `M` with `N` joints and `F` feet that is simulated in the place of the hardware, on `B` balls.
#[derive(Clone, Debug)]
pub struct Simulated<T: Scalar, M, const N: usize, const F: usize, const B: usize> {
    plant: NativeSimulator<T, M, N, B, B>,
    /// The foot of each ball; none where there is no such foot.
    foot: fn(usize) -> usize,
    /// Mean torques since they were told last; none for a machine that does not read them, whose simulation is faster so.
    joint_torques: Option<[T; N]>,
    /// Ticks until the robot has landed and come to rest.
    left: usize,
}

impl<T: Real, M: Tree<T, N>, const N: usize, const F: usize, const B: usize>
    Simulated<T, M, N, F, B>
{
    /// A robot at rest, for so many milliseconds.
    pub(super) fn at_rest(
        mut plant: NativeSimulator<T, M, N, B, B>,
        start: &Configuration<T, N>,
        (foot, feels): (fn(usize) -> usize, bool),
        time: usize,
    ) -> Self {
        plant.reset(start, &Tangent::ZERO);
        Self {
            plant,
            foot,
            joint_torques: feels.then_some([T::ZERO; N]),
            left: time * RATIO,
        }
    }

    /// Joint positions and velocities of now.
    pub fn joints(&self) -> ([T; N], [T; N]) {
        let (q, v) = (self.plant.configuration(), self.plant.velocity());
        (q.joints, v.joints)
    }

    /// What a controller is told, the truth, and the mean torques since it was told last.
    pub fn hear(&mut self) -> Observation<T, N, F> {
        let mut forces = [Vector3::zeros(); F];
        for (i, force) in self.plant.contact_forces_w().iter().enumerate() {
            if let Some(foot) = forces.get_mut((self.foot)(i)) {
                *foot += force;
            }
        }
        let zero = [T::ZERO; N];
        let felt = self.joint_torques.as_mut();
        Observation {
            joint_torques: felt.map_or(zero, |torques| core::mem::replace(torques, zero)),
            ..told(
                self.plant.configuration(),
                self.plant.velocity(),
                forces.map(|force| force.norm()),
            )
        }
    }

    /// 100 µs under these torques.
    pub fn step(&mut self, torques: &[T; N]) {
        let speeds = self.plant.velocity().joints;
        let worked = self.plant.step(torques).is_ok();
        self.left = if worked {
            self.left.saturating_sub(1)
        } else {
            0
        };
        if let Some(felt) = &mut self.joint_torques {
            let settings = &self.plant.settings;
            let losses = joint_friction(&settings.limits, &speeds, settings.friction_smoothing);
            let given = self.plant.delivered().iter().zip(losses);
            for (felt, (tau, loss)) in felt.iter_mut().zip(given) {
                *felt += (*tau + loss) / T::of(RATIO as f64);
            }
        }
    }

    /// Whether enough time has passed to land and to come to rest.
    pub const fn is_over(&self) -> bool {
        self.left == 0
    }
}

/// A state with forces on the feet, as a fresh observation without torques.
pub(super) const fn told<T: Real, const N: usize, const F: usize>(
    q: &Configuration<T, N>,
    v: &Tangent<T, N>,
    foot_forces: [T; F],
) -> Observation<T, N, F> {
    Observation {
        measured: Measurement {
            base: q.base,
            base_velocity: v.base,
            joints: q.joints,
            joint_velocities: v.joints,
            foot_forces,
            age: T::ZERO,
        },
        joint_torques: [T::ZERO; N],
    }
}

/// A machine that is flown, and what is recorded of it.
pub(super) struct Flown<M, W> {
    /// What commands.
    pub(super) machine: M,
    /// The name of its calls.
    pub(super) subject: &'static str,
    /// What a tick is called: in a jump, or in a state that no jump visits.
    pub(super) name: fn(&Tick<W>, wild: bool) -> &'static str,
    /// Whether the command of every tick is recorded too.
    pub(super) commands: bool,
    /// Ticks so far.
    ticks: u32,
}

impl<M, W> Flown<M, W> {
    /// Before its first tick.
    pub(super) const fn new(
        machine: M,
        subject: &'static str,
        name: fn(&Tick<W>, wild: bool) -> &'static str,
        commands: bool,
    ) -> Self {
        Self {
            machine,
            subject,
            name,
            commands,
            ticks: 0,
        }
    }

    /// The next millisecond of the machine.
    pub(super) fn tick<T: Real, R: Recorder, const N: usize, const F: usize>(
        &mut self,
        recorder: &mut R,
        heard: &Observation<T, N, F>,
        wild: bool,
    ) where
        M: JumpMachine<T, N, F, Work = W>,
        Tick<W>: Numbers,
    {
        let now = T::of(f64::from(self.ticks)) * T::of(PERIOD);
        self.ticks = self.ticks.wrapping_add(1);
        let name = self.name;
        digested::<T, _, _, _>(
            recorder,
            self.subject,
            (&mut self.machine, now, heard),
            |(machine, now, heard)| machine.tick(now, Some(heard)),
            |tick| name(tick, wild),
        );
        if self.commands {
            recorder.value(digest(self.machine.command()));
        }
    }

    /// Flies until the simulation is over, and records where the robot and the machine are then. Of the joint ticks the first in every
    /// millisecond is a call of its own.
    pub(super) fn fly<T: Real, R: Recorder, const N: usize, const F: usize, const B: usize>(
        &mut self,
        recorder: &mut R,
        mut robot: Simulated<T, impl Tree<T, N>, N, F, B>,
    ) where
        M: JumpMachine<T, N, F, Work = W>,
        Tick<W>: Numbers,
    {
        while !robot.is_over() {
            self.tick(recorder, &robot.hear(), false);
            for i in 0..RATIO {
                let (q, v) = robot.joints();
                let torques = if i == 0 {
                    digested::<T, _, _, _>(
                        recorder,
                        self.subject,
                        (&mut self.machine, &q, &v),
                        |(machine, q, v)| machine.joint_tick(q, v, T::of(JOINT_PERIOD)),
                        |_| "joint PD tick",
                    )
                } else {
                    self.machine.joint_tick(&q, &v, T::of(JOINT_PERIOD))
                };
                robot.step(&torques);
            }
        }
        let end = (*robot.plant.configuration(), *robot.plant.velocity());
        end.visit(&mut |x| recorder.value(crate::canonical_bits(x)));
        recorder.value(self.machine.phase() as u64);
    }
}
