//! The machine: memory, and one method per rate.

use jump_control::{Event, Fault, JointCommand, JointGains, Phase};
use nalgebra::Vector3;
use rbd_core::{Configuration, GRAVITY, Tangent, Tree};
use so3::{Scalar, math};
use wbc_qp::Contact;
use wbc_qp::jump::{Absorption, ComReference, LandingReference, TorqueTick};

use super::aerial::{Aerial, JointMotion};
use super::jump::Armed;
use super::recovery::{Height, Recovery};
use super::stance::{Stance, middle_of_feet};
use super::{Jump, Landing, Settings, Solved, Work, Workspace};
use crate::supervisor::{Limits, Supervisor};
use crate::{JumpMachine, Observation, Refusal, Tick};

/// A humanoid that stands, jumps when it is told how, lands and stands again.
///
/// It borrows the model and the programs' memory, so that they can be statics. The const generics are those of [`Workspace`], with F
/// feet.
#[derive(Debug)]
pub struct Machine<
    'a,
    T: Scalar,
    M,
    const N: usize,
    const F: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> {
    pub(super) settings: Settings<T, N, F>,
    pub(super) supervisor: Supervisor<T, N, F>,
    pub(super) armed: Option<Armed<T, N>>,
    /// Time at rest so far, s.
    pub(super) calm: T,
    /// When the robot left the ground as planned, on the clock of the jump, s.
    pub(super) took_off: T,
    pub(super) model: &'a M,
    pub(super) workspace: &'a mut Workspace<T, N, K, V, W, R>,
    /// When the jump begins, on the clock of `tick`.
    start: T,
    /// Feet with their loads.
    pub(super) feet: [Contact<T>; F],
    /// Where the robot is to stand.
    stance: Stance<T, N>,
    aerial: Aerial<T, N>,
    /// None until the ground is there.
    recovery: Option<Recovery<T>>,
    /// Positions that the servos track.
    pub(super) servo: [T; N],
    /// Torques of the last program that was solved.
    torques: [T; N],
    /// Time for which no program has had an answer, s.
    unsolved: T,
}

/// Configuration and velocity as observed, in one tick of the programs.
pub(super) struct Now<'a, T: Scalar, const N: usize, const F: usize> {
    /// Time of the jump, s.
    pub(super) t: T,
    pub(super) dt: T,
    pub(super) q: Configuration<T, N>,
    pub(super) v: Tangent<T, N>,
    foot_forces: &'a [T; F],
}

impl<
    'a,
    T: Scalar,
    M: Tree<T, N>,
    const N: usize,
    const F: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> Machine<'a, T, M, N, F, K, V, W, R>
{
    /// A standing robot without a jump. Until the first tick its joints are damped.
    #[must_use]
    pub fn new(
        model: &'a M,
        settings: Settings<T, N, F>,
        workspace: &'a mut Workspace<T, N, K, V, W, R>,
    ) -> Self {
        workspace.adopt(&settings);
        Self {
            supervisor: Supervisor::new(Limits {
                period: settings.period,
                max_age: settings.max_age,
                max_silence: settings.max_silence,
                safe_damping: settings.safe_damping,
                slew: settings.slew,
                most_tilt: settings.most_tilt,
            }),
            armed: None,
            calm: T::ZERO,
            took_off: T::ZERO,
            model,
            workspace,
            start: T::ZERO,
            feet: settings.feet,
            stance: Stance::new(model, &settings.feet, &settings.standing),
            aerial: Aerial::resting(&settings.standing),
            recovery: None,
            servo: settings.standing,
            torques: [T::ZERO; N],
            unsolved: T::ZERO,
            settings,
        }
    }

    /// Gives a standing robot a jump that begins at `start`, on the clock of [`Machine::tick`]; until then it holds the jump's first
    /// posture.
    ///
    /// # Errors
    /// A robot that does not stand, a start that is past, and a jump with a number that is not finite are refused: nothing changes
    /// then.
    pub fn arm(&mut self, jump: &Jump<T, N>, start: T) -> Result<(), Refusal> {
        self.supervisor.may_arm(start, T::ZERO)?;
        let armed = Armed::new(self.model, &self.settings.feet, jump);
        self.armed = Some(armed.ok_or(Refusal::NotFinite)?);
        self.workspace.restart(&jump.start.joints);
        self.start = start;
        (self.servo, self.recovery) = (jump.start.joints, None);
        self.supervisor.armed();
        Ok(())
    }

    /// One tick of 1 kHz at the time `now`, s, on a clock of the caller that only goes forward.
    ///
    /// `observed` is what has arrived since the last tick. `None` is a stale sensor: the last observation is used until it is too old, and the
    /// joints are damped where there has been none yet. A missed tick is bridged likewise. They end in [`Phase::Abort`] after [`Settings::max_age`] and [`Settings::max_silence`]. So does a
    /// program without an answer; until then its last command stays.
    pub fn tick(&mut self, now: T, observed: Option<&Observation<T, N, F>>) -> Tick<Work<T>> {
        let work = match self.supervisor.hear(now, observed, &mut None) {
            Ok(Some((observed, dt))) => self.act(now - self.start, observed, dt),
            Ok(None) => Work::Damping,
            Err(fault) => self.abort(fault),
        };
        self.supervisor.ticked(work)
    }

    /// One tick of 10 kHz, `dt` seconds after the last: torques for the motors, N m, from joint positions and velocities of
    /// now. Always finite and within the motors' torques; damping alone once [`Machine::tick`] has been missing for
    /// [`Settings::max_silence`]. Between two ticks servos go on at the velocities asked for.
    pub fn joint_tick(&mut self, q: &[T; N], qd: &[T; N], dt: T) -> [T; N] {
        self.supervisor
            .joint_tick_ahead(q, qd, dt, &self.settings.motors)
    }

    /// What [`Machine::joint_tick`] does, for a joint loop of the caller's own, such as an interrupt that must not wait for
    /// [`Machine::tick`].
    #[must_use]
    pub const fn command(&self) -> &JointCommand<T, N> {
        &self.supervisor.command
    }

    /// Where the jump is.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.supervisor.phase
    }

    /// The first fault, if the machine has aborted.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.supervisor.fault
    }

    /// The programs' memory.
    #[must_use]
    pub const fn workspace(&self) -> &Workspace<T, N, K, V, W, R> {
        self.workspace
    }

    fn abort(&mut self, fault: Fault) -> Work<T> {
        self.supervisor.abort(fault);
        Work::Damping
    }

    /// Events and the command at time `t` of the jump.
    fn act(&mut self, t: T, observed: &Observation<T, N, F>, dt: T) -> Work<T> {
        let measured = &observed.measured;
        if let Some(event) = self.event(t, measured, dt) {
            self.supervisor.happened(event);
            if event == Event::Takeoff {
                self.take_off(t, &measured.joints, &measured.joint_velocities);
            }
        }
        let now = Now {
            t,
            dt,
            q: measured.configuration(),
            v: measured.velocity(),
            foot_forces: &measured.foot_forces,
        };
        let (command, work) = match (self.supervisor.phase, self.armed) {
            (Phase::Hold | Phase::Stance, Some(armed)) => self.push(&armed, &now),
            (Phase::Flight | Phase::PreLanding | Phase::Landing | Phase::Stand, _) => {
                let motion = self.aerial.at(t - self.took_off);
                match self.settings.landing {
                    Landing::Program(_) => self.land(&now, &motion),
                    Landing::Servos(gains) => self.hold(&motion, &gains),
                }
            }
            _ => (self.supervisor.safe(), Work::Damping),
        };
        let failed = matches!(work, Work::PushOff(Err(_)) | Work::Landing(Err(_)));
        self.unsolved = if failed { self.unsolved + dt } else { T::ZERO };
        if self.unsolved > self.settings.max_silence {
            return self.abort(Fault::Unsolved);
        }
        match self.supervisor.give(&command) {
            Ok(()) => work,
            Err(fault) => self.abort(fault),
        }
    }

    /// What flight and landing begin with.
    fn take_off(&mut self, t: T, q: &[T; N], qd: &[T; N]) {
        let Some(armed) = &self.armed else { return };
        self.took_off = t;
        self.stance = armed.stance;
        self.aerial.pushed = *qd;
        self.aerial.rest.from = match self.settings.landing {
            Landing::Program(_) => *q,
            Landing::Servos(_) => self.servo,
        };
        self.aerial.rest.to = armed.stance.joints;
        self.aerial.rest.duration = self.settings.aerial_share * armed.flight;
        self.recovery = None;
        if let Some(program) = &mut self.workspace.landing {
            program.restart();
        }
    }

    /// Whether the robot is on the ground and not about to jump.
    const fn on_ground(&self) -> bool {
        matches!(self.supervisor.phase, Phase::Landing | Phase::Stand)
    }

    /// Flight and landing by servos.
    fn hold(
        &mut self,
        motion: &JointMotion<T, N>,
        on_ground: &[JointGains<T>; N],
    ) -> (JointCommand<T, N>, Work<T>) {
        self.servo = motion.position;
        let mut command = self.track(&motion.velocity);
        if self.on_ground() {
            command.gains = *on_ground;
        }
        (command, Work::Servos)
    }

    /// Flight and landing by one program: contacts come as the ground comes.
    #[inline(never)]
    fn land(
        &mut self,
        now: &Now<'_, T, N, F>,
        motion: &JointMotion<T, N>,
    ) -> (JointCommand<T, N>, Work<T>) {
        self.workspace.snapshot.update(self.model, &now.q, &now.v);
        self.load(now);
        let feet_w = middle_of_feet(&self.workspace.snapshot.kinematics, &self.feet);
        let wanted = self.height(now.t, feet_w.z);
        let up = Vector3::z();
        let Workspace {
            landing, snapshot, ..
        } = &mut *self.workspace;
        let Some(program) = landing else {
            return (self.supervisor.safe(), Work::Damping);
        };
        let mut velocity = motion.velocity;
        // The program's posture is damped towards a velocity: this much more of it asks for the acceleration as well.
        let [air, _] = program.settings.posture;
        for (v, a) in velocity.iter_mut().zip(&motion.acceleration) {
            *v += *a / air.damping;
        }
        let reference = LandingReference {
            com: ComReference {
                position_w: Vector3::new(feet_w.x, feet_w.y, feet_w.z + wanted.height),
                velocity_w: up * wanted.speed,
                acceleration_w: up * wanted.acceleration,
            },
            trunk: self.stance.upright,
            posture: motion.position,
            velocity,
        };
        let joints = (&self.settings.limits, &self.settings.motors);
        let tick = program.tick(self.model, snapshot, &self.feet, joints, &reference);
        let solved = self.take(tick);
        (self.torque_command(), Work::Landing(solved))
    }

    /// Adds and removes contacts as the feet feel the ground.
    fn load(&mut self, now: &Now<'_, T, N, F>) {
        let (on_ground, flight) = (self.on_ground(), self.supervisor.phase == Phase::Flight);
        for (foot, force) in self.feet.iter_mut().zip(now.foot_forces) {
            let there = on_ground && *force > self.settings.contact_force;
            let step = if there { now.dt } else { -now.dt } / self.settings.loading_time;
            foot.load = if flight {
                T::ZERO
            } else {
                math::clamp(foot.load + step, T::ZERO, T::ONE)
            };
        }
    }

    /// The centre of mass over feet that are `floor` high as it should be: a free fall, its end, and a rise to the landing posture. Over
    /// the feet, since legs measure it; the estimated height over the world drifts with a blow.
    fn height(&mut self, t: T, floor: T) -> Height<T> {
        let snapshot = &self.workspace.snapshot;
        let (height, speed) = (snapshot.com_w().z - floor, snapshot.com_velocity_w().z);
        if self.on_ground() && self.recovery.is_none() {
            let s = &self.settings;
            let falling = math::min(speed, T::ZERO);
            self.recovery = Some(Recovery {
                start: t,
                first: height,
                absorption: Absorption::new(falling, s.absorption, s.absorption_time),
                last: self.stance.height,
                rise_time: s.rise_time,
            });
        }
        self.recovery.map_or(
            Height {
                height,
                speed,
                acceleration: T::of(GRAVITY[2]),
            },
            |recovery| recovery.at(t),
        )
    }

    /// Keeps the torques of an answer.
    pub(super) fn take(
        &mut self,
        tick: Result<TorqueTick<T, N, K>, wbc_qp::Error>,
    ) -> Result<Solved<T>, wbc_qp::Error> {
        let tick = tick?;
        self.torques = tick.answer.torques;
        Ok(Solved {
            iterations: tick.answer.iterations,
            residuals: tick.residuals,
            yielded: tick.answer.yielded,
            capped: tick.answer.capped,
        })
    }

    /// The torques of the last program that was solved.
    pub(super) const fn torque_command(&self) -> JointCommand<T, N> {
        let mut command = JointCommand::damp(T::ZERO);
        command.feed_forward = self.torques;
        command
    }

    /// Positions of now with these velocities, for the servos.
    pub(super) const fn track(&self, velocity: &[T; N]) -> JointCommand<T, N> {
        JointCommand {
            position: self.servo,
            velocity: *velocity,
            feed_forward: [T::ZERO; N],
            gains: self.settings.servos,
        }
    }
}

impl<
    T: Scalar,
    M: Tree<T, N>,
    const N: usize,
    const F: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> JumpMachine<T, N, F> for Machine<'_, T, M, N, F, K, V, W, R>
{
    type Work = Work<T>;

    #[inline(always)]
    fn tick(&mut self, now: T, observed: Option<&Observation<T, N, F>>) -> Tick<Work<T>> {
        Machine::tick(self, now, observed)
    }

    #[inline(always)]
    fn joint_tick(&mut self, q: &[T; N], qd: &[T; N], dt: T) -> [T; N] {
        Machine::joint_tick(self, q, qd, dt)
    }

    fn command(&self) -> &JointCommand<T, N> {
        Machine::command(self)
    }

    fn phase(&self) -> Phase {
        Machine::phase(self)
    }

    fn fault(&self) -> Option<Fault> {
        Machine::fault(self)
    }
}
