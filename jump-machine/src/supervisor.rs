//! What keeps every machine safe: the clock, the age of what is observed, the command in force, the first fault, and when a jump may
//! begin.

use jump_control::{Event, Fault, JointCommand, Phase, Slew, Watch, next_phase};
use rbd_core::Motor;
use so3::{Scalar, math};

use crate::{Observation, Refusal, Tick};

/// Limits on time and on the safe command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits<T> {
    /// Period of the 1 kHz loop, s.
    pub(crate) period: T,
    /// Oldest observation to act on, s.
    pub(crate) max_age: T,
    /// Longest silence of either loop, s.
    pub(crate) max_silence: T,
    /// Damping of the safe command, N m s/rad.
    pub(crate) safe_damping: T,
    /// Largest rate of a joint's torque, N m/s.
    pub(crate) slew: T,
    /// Largest tilt of the base of a robot that stands, rad.
    pub(crate) most_tilt: T,
}

/// Phase, command in force, and what has been heard and when.
#[derive(Clone, Debug)]
pub(crate) struct Supervisor<T: Scalar, const N: usize, const F: usize> {
    pub(crate) phase: Phase,
    pub(crate) command: JointCommand<T, N>,
    pub(crate) fault: Option<Fault>,
    /// Why the last jump was not begun.
    refusal: Option<Refusal>,
    /// When the last tick was, on the caller's clock, s.
    last_tick: Option<T>,
    /// Whether the base is tilted no further than that of a robot that stands.
    pub(crate) upright: bool,
    /// The vertical's part along the base's z axis at the largest tilt.
    least_up: T,
    limits: Limits<T>,
    heard: Option<Observation<T, N, F>>,
    /// Time of ticks before the first observation, s.
    unheard: T,
    /// Time since the command was made, s.
    silence: T,
    slew: Slew<T, N>,
}

impl<T: Scalar, const N: usize, const F: usize> Supervisor<T, N, F> {
    /// A standing robot whose joints are damped.
    pub(crate) fn new(limits: Limits<T>) -> Self {
        Self {
            phase: Phase::Stand,
            command: JointCommand::damp(limits.safe_damping),
            fault: None,
            refusal: None,
            last_tick: None,
            upright: true,
            least_up: math::cos(limits.most_tilt),
            heard: None,
            unheard: T::ZERO,
            silence: T::ZERO,
            slew: Slew::new(limits.slew),
            limits,
        }
    }

    /// Whether a jump may be armed that begins at `start` on the caller's clock, `ahead` seconds from now at the earliest.
    pub(crate) fn may_arm(&self, start: T, ahead: T) -> Result<(), Refusal> {
        if !self.upright && matches!(self.phase, Phase::Landing | Phase::Stand) {
            return Err(Refusal::Tilted);
        }
        if self.phase != Phase::Stand {
            return Err(Refusal::NotStanding);
        }
        let soon = self.last_tick.is_some_and(|now| start - now < ahead);
        if soon || !start.is_finite_number() {
            return Err(Refusal::TooLate);
        }
        Ok(())
    }

    /// A jump has been armed.
    pub(crate) fn armed(&mut self) {
        self.refusal = None;
        self.happened(Event::Armed);
    }

    /// Whether the robot is where its jump begins; a base that is tilted, or the first joint that is elsewhere, is the reason why the jump is
    /// not begun.
    pub(crate) fn begin(&mut self, joints: &[T; N], first: &[T; N], tolerance: T) -> Event {
        if !self.upright {
            return self.refuse(Refusal::Tilted);
        }
        let mut pairs = joints.iter().zip(first);
        match pairs.position(|(q, first)| math::abs(*q - *first) > tolerance) {
            None => Event::Start,
            Some(joint) => self.refuse(Refusal::Posture(joint)),
        }
    }

    /// The jump is not begun, for this reason.
    pub(crate) const fn refuse(&mut self, why: Refusal) -> Event {
        self.refusal = Some(why);
        Event::Misplaced
    }

    /// The latest observation with its age now, and the time since the last tick; `None` before the first, which may be as late as others may be
    /// old. `old` is memory for an observation of an earlier tick, so that one of this tick is not copied.
    pub(crate) fn hear<'h>(
        &mut self,
        now: T,
        heard: Option<&'h Observation<T, N, F>>,
        old: &'h mut Option<Observation<T, N, F>>,
    ) -> Result<Option<(&'h Observation<T, N, F>, T)>, Fault> {
        let s = &self.limits;
        let passed = self.last_tick.map_or(s.period, |last| now - last);
        // Also false for NaN.
        if !(now.is_finite_number() && passed > T::ZERO) {
            return Err(Fault::Clock);
        }
        if passed > s.max_silence {
            return Err(Fault::Silent);
        }
        self.last_tick = Some(now);
        // Jitter of the scheduler is not passed on.
        let dt = if math::abs(passed - s.period) < s.period * T::HALF {
            s.period
        } else {
            passed
        };
        let observed = match (heard, self.heard) {
            (Some(observed), _) => observed,
            (None, Some(mut last)) => {
                last.measured.age += dt;
                old.insert(last)
            }
            (None, None) => {
                self.unheard += dt;
                return if self.unheard <= s.max_age {
                    Ok(None)
                } else {
                    Err(Fault::Stale)
                };
            }
        };
        self.heard = Some(*observed);
        // Also false for NaN.
        self.upright = observed.measured.base.rotation.matrix().m33 >= self.least_up;
        let watch = Watch { max_age: s.max_age };
        watch
            .fault(&observed.measured)
            .map_or(Ok(Some((observed, dt))), Err)
    }

    /// The phase after an event.
    pub(crate) fn happened(&mut self, event: Event) {
        self.phase = next_phase(self.phase, event);
    }

    /// The safe command.
    pub(crate) const fn safe(&self) -> JointCommand<T, N> {
        JointCommand::damp(self.limits.safe_damping)
    }

    /// A command in force from now on; one that is not finite is a fault.
    pub(crate) fn give(&mut self, command: &JointCommand<T, N>) -> Result<(), Fault> {
        if !command.is_finite() {
            return Err(Fault::Command);
        }
        self.command = *command;
        Ok(())
    }

    /// Damps the joints from now on; the first fault stays named.
    pub(crate) fn abort(&mut self, fault: Fault) {
        self.fault = self.fault.or(Some(fault));
        self.happened(Event::Fault);
        self.command = self.safe();
    }

    /// What came of a tick of the 1 kHz loop that has now run.
    pub(crate) fn ticked<W>(&mut self, work: W) -> Tick<W> {
        self.silence = T::ZERO;
        Tick {
            phase: self.phase,
            work,
            fault: self.fault,
            refusal: self.refusal,
        }
    }

    /// Before the torques of a joint tick `dt` after the last: looks at clock, silence and encoders. Returns the time by which torques may
    /// change.
    fn watch_joints(&mut self, q: &[T; N], qd: &[T; N], dt: T) -> T {
        // Also false for NaN.
        let dt = if dt > T::ZERO && dt <= self.limits.max_silence {
            dt
        } else {
            self.abort(Fault::Clock);
            T::ZERO
        };
        self.silence += dt;
        if self.silence > self.limits.max_silence {
            self.abort(Fault::Silent);
        } else if let Some(fault) = Watch::joints(q, qd) {
            self.abort(fault);
        }
        dt
    }

    /// Torques of the command in force, inside the motors' and the slew rate's limits; damping alone once the 1 kHz loop has been missing
    /// for too long.
    pub(crate) fn joint_tick(
        &mut self,
        q: &[T; N],
        qd: &[T; N],
        dt: T,
        motors: &[Motor<T>; N],
    ) -> [T; N] {
        let dt = self.watch_joints(q, qd, dt);
        let wanted = self.command.torques(q, qd, motors);
        match self.phase {
            // Up to the touch torques are those of a plan, whose direction counts. From then on what counts is that each is there soon.
            Phase::Landing | Phase::Stand | Phase::Abort => self.slew.limit(&wanted, dt),
            _ => self.slew.limit_together(&wanted, dt),
        }
    }

    /// As [`Supervisor::joint_tick`], with positions that go on at the velocities asked for: held for a millisecond at 7 rad/s a
    /// position is a sawtooth of 42 N m in a servo of 6000 N m/rad.
    pub(crate) fn joint_tick_ahead(
        &mut self,
        q: &[T; N],
        qd: &[T; N],
        dt: T,
        motors: &[Motor<T>; N],
    ) -> [T; N] {
        let since = self.silence;
        let dt = self.watch_joints(q, qd, dt);
        // Positions that go on are joints that stay behind: fewer numbers to copy.
        let mut behind = *q;
        for (q, velocity) in behind.iter_mut().zip(&self.command.velocity) {
            *q -= since * *velocity;
        }
        let wanted = self.command.torques(&behind, qd, motors);
        self.slew.limit(&wanted, dt)
    }
}
