//! The closed loop of a jump without `std`: the counterpart of `jump_lab::closed_loop` for boards, where nothing is allocated, the sensors tell
//! the truth and every call is recorded.

use jump_machine::{JumpMachine, Observation, Tick};
use rbd_core::{Configuration, Tangent};

use super::{digest, digested};
use crate::{Numbers, Real, Recorder};

/// Joint ticks per tick of the machine.
pub(super) const RATIO: usize = 10;
/// Period of the machine, s.
const PERIOD: f64 = 1e-3;
/// Period of the joint loop, s.
const JOINT_PERIOD: f64 = 1e-4;

/// A robot that is simulated in the place of the hardware.
pub(super) trait Simulated<T: Real, const N: usize, const F: usize> {
    /// Where the robot is, and how it moves.
    fn state(&self) -> (&Configuration<T, N>, &Tangent<T, N>);

    /// What the machine is told, every millisecond.
    fn hear(&mut self) -> Observation<T, N, F>;

    /// 100 µs under these torques.
    fn step(&mut self, torques: &[T; N]);

    /// Whether enough time has passed to land and to come to rest.
    fn is_over(&self) -> bool;
}

/// A machine that is flown, and what is recorded of it.
pub(super) struct Flown<M, W> {
    /// What commands.
    pub(super) machine: M,
    /// The name of its calls.
    pub(super) subject: &'static str,
    /// What a tick is called that did this work: in a jump, or in a state that no jump visits.
    pub(super) name: fn(&W, wild: bool) -> &'static str,
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
        name: fn(&W, wild: bool) -> &'static str,
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
            |tick| name(&tick.work, wild),
        );
        if self.commands {
            recorder.value(digest(self.machine.command()));
        }
    }

    /// Flies until the simulation is over, and records where the robot and the machine are then. Of the joint ticks the first in every
    /// millisecond is a call of its own.
    pub(super) fn fly<T: Real, R: Recorder, const N: usize, const F: usize>(
        &mut self,
        recorder: &mut R,
        robot: &mut impl Simulated<T, N, F>,
    ) where
        M: JumpMachine<T, N, F, Work = W>,
        Tick<W>: Numbers,
    {
        while !robot.is_over() {
            self.tick(recorder, &robot.hear(), false);
            for i in 0..RATIO {
                let (q, v) = robot.state();
                let (q, v) = (q.joints, v.joints);
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
        let (q, v) = robot.state();
        (*q, *v).visit(&mut |x| recorder.value(crate::canonical_bits(x)));
        recorder.value(self.machine.phase() as u64);
    }
}
