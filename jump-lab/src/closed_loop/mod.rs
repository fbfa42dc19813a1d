//! The closed loop of every simulated jump: plant, motors and joint loop at 10 kHz, sensors and jump machine at 1 kHz.

mod actuators;
mod drive;
mod imu;
mod sensors;

pub(crate) use actuators::Actuators;
pub use drive::{Drive, Step};
pub(crate) use imu::Imu;
pub use sensors::{Feet, Sensors, Setting};

use crate::lab::Ground;
use crate::verdict::Stage;
use jump_control::Phase;
use jump_machine::{JumpMachine, Observation, Tick};
use rbd_core::Tree;

/// Period of the machine, s.
pub const PERIOD: f64 = 1e-3;
/// Ticks of the plant per tick of the machine.
pub const RATIO: u32 = 10;

/// What is kept of a run of a machine `M` in a world of `C` contacts.
pub trait Recorder<M: JumpMachine<f64, N, F>, const N: usize, const F: usize, const C: usize> {
    /// May change what the machine is told in the `k`-th millisecond.
    fn tell(&mut self, _k: u64, _told: &mut Observation<f64, N, F>) {}

    /// After a tick of the machine at time `t` of the jump, s.
    fn ticked(&mut self, t: f64, tick: &Tick<M::Work>, machine: &M, world: &Ground<N, C>);

    /// After a tick of the plant.
    fn stepped(&mut self, step: &Step<N>, machine: &M, world: &Ground<N, C>);
}

/// A robot of model `R` with `N` joints and `F` feet, its machine `M`, and a world of `C` contacts; `E` is F + 2.
pub struct ClosedLoop<R, M, const N: usize, const F: usize, const C: usize, const E: usize> {
    /// What commands.
    pub machine: M,
    /// The robot in its simulator, on its ground.
    pub world: Ground<N, C>,
    /// What the machine is told with.
    pub sensors: Sensors<R, N, F, C, E>,
    /// What its commands reach.
    pub drive: Drive<N>,
    /// Time of the next tick on the machine's clock, s.
    pub now: f64,
}

impl<
    R: Tree<f64, N>,
    M: JumpMachine<f64, N, F>,
    const N: usize,
    const F: usize,
    const C: usize,
    const E: usize,
> ClosedLoop<R, M, N, F, C, E>
{
    /// Runs from time `-hold` to `end` of the jump, s. `progress` hears time and phase once per simulated 10 ms.
    ///
    /// # Errors
    /// What the simulator says.
    pub fn run(
        &mut self,
        (hold, end): (f64, f64),
        recorder: &mut impl Recorder<M, N, F, C>,
        progress: impl FnMut(f64, Phase),
    ) -> Result<(), String> {
        self.begin(-hold);
        self.go_on((0.0, end), recorder, progress)
    }

    /// Before the first tick, at time `now` on the machine's clock, s: the sensors have seen the robot rest.
    pub fn begin(&mut self, now: f64) {
        self.now = now;
        self.sensors.begin(now, &self.world);
    }

    /// Runs on from [`ClosedLoop::now`], through a jump that begins at `start` on the machine's clock, to `end` of it, s. `recorder` and `progress` hear
    /// times of the jump.
    ///
    /// # Errors
    /// What the simulator says.
    pub fn go_on(
        &mut self,
        (start, end): (f64, f64),
        recorder: &mut impl Recorder<M, N, F, C>,
        mut progress: impl FnMut(f64, Phase),
    ) -> Result<(), String> {
        let first = self.now;
        for k in 0_u64.. {
            self.now = k as f64 * PERIOD + first;
            let (now, t) = (self.now, self.now - start);
            if t > end {
                break;
            }
            let felt = self.drive.take_felt();
            let mut told = self.sensors.measure(now, &self.world, &felt);
            if let Some(told) = &mut told {
                recorder.tell(k, told);
            }
            let tick = self.machine.tick(now, told.as_ref());
            self.drive.send(k, now, self.machine.command());
            recorder.ticked(t, &tick, &self.machine, &self.world);
            for i in 0..RATIO {
                let parts = (&mut self.machine, &mut self.world, &mut self.sensors);
                let mut step = self.drive.step(parts, now, i)?;
                step.time -= start;
                recorder.stepped(&step, &self.machine, &self.world);
            }
            if k.is_multiple_of(10) {
                progress(t, self.machine.phase());
            }
        }
        Ok(())
    }
}

/// The part of the budgets that a phase counts for.
#[must_use]
pub const fn stage(phase: Phase) -> Stage {
    match phase {
        Phase::Hold | Phase::Stance => Stage::PushOff,
        Phase::Flight | Phase::PreLanding => Stage::Flight,
        Phase::Landing | Phase::Stand | Phase::Abort => Stage::Landing,
    }
}
