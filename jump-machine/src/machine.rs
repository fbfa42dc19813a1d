//! The machine: memory, and one method per rate.

use jump_control::{
    Fault, JointCommand, JointGains, Measurement, MinimumJerk, PayloadEstimate, Phase, Plan, sample,
};
use landing::{DetectorState, Landing, Outcome, PreLanding, Target, Turning};
use nalgebra::Vector3;
use rbd_core::{Configuration, Limbs, Tangent, Tree};
use so3::Scalar;

use crate::balance::Balance;
use crate::centring::Centred;
use crate::pre_landing::Waiting;
use crate::push_off::predicted;
use crate::supervisor::{Limits, Supervisor};
use crate::{Jump, JumpMachine, Observation, Refusal, Settings, Tick, Workspace};

/// What a tick computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Feet pulled along the plan.
    Cartesian,
    /// Forces for the feet on the ground.
    Landing(Outcome),
    /// Joints damped, nothing else.
    Damping,
}

/// A robot that stands, jumps when it is given a plan, lands and stands again.
///
/// It borrows model, plans and its workspace, so that they can be statics.
#[derive(Debug)]
pub struct Machine<'a, T: Scalar, M, const N: usize, const F: usize> {
    pub(crate) settings: Settings<T, N, F>,
    pub(crate) jump: Option<Jump<'a, T, N, F>>,
    pub(crate) supervisor: Supervisor<T, N, F>,
    pub(crate) contact: DetectorState<T, N, F>,
    /// Time at rest so far, s.
    pub(crate) calm: T,
    pub(crate) model: &'a M,
    pub(crate) landing: Landing<T, N, F>,
    pub(crate) workspace: &'a mut Workspace<T, N, F>,
    pub(crate) posture: PreLanding<T, N, F>,
    /// Feet of the level landing posture, base axes.
    pub(crate) level_feet: [Vector3<T>; F],
    /// The legs as they wait for the ground.
    pub(crate) waiting: Waiting<T, N, F>,
    /// The legs as measured, and as they should be: kept so that a tick copies nothing.
    pub(crate) limbs: Limbs<T, N, F>,
    pub(crate) wanted: Limbs<T, N, F>,
    pub(crate) payload: PayloadEstimate<T>,
    pub(crate) balance: Balance<T, N, F>,
    pub(crate) centred: Centred<T, N>,
    /// The way to where the plan begins, from a time of the plan on, s; none before the first tick of the hold.
    pub(crate) gathering: Option<(T, MinimumJerk<T, N>)>,
    /// When the plan begins, on the clock of `tick`.
    start: T,
    /// Node of the plan's last sample.
    node: usize,
    /// Share of their distance from the axis of turning by which the feet are drawn in.
    shaping: T,
}

impl<'a, T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'a, T, M, N, F> {
    /// A standing robot without a jump. Until the first tick its joints are damped.
    #[must_use]
    pub fn new(
        model: &'a M,
        settings: Settings<T, N, F>,
        workspace: &'a mut Workspace<T, N, F>,
    ) -> Self {
        let torques = settings.motors.map(|motor| motor.torque);
        Self {
            jump: None,
            supervisor: Supervisor::new(Limits {
                period: settings.period,
                max_age: settings.max_age,
                max_silence: settings.max_silence,
                safe_damping: settings.safe_damping,
                slew: settings.slew,
                most_tilt: settings.most_tilt,
            }),
            contact: DetectorState::new(),
            calm: T::ZERO,
            model,
            landing: Landing::new(settings.pd.feet, settings.landing, torques),
            workspace,
            level_feet: settings.posture.level_feet(model),
            waiting: Waiting::standing(&settings.posture.joints),
            limbs: Limbs::ZERO,
            wanted: Limbs::ZERO,
            posture: settings.posture,
            payload: PayloadEstimate::new(),
            balance: Balance::new(),
            centred: Centred::new(),
            gathering: None,
            start: T::ZERO,
            node: 0,
            shaping: T::ZERO,
            settings,
        }
    }

    /// Gives a standing robot a jump that begins at `start`, on the clock of [`Machine::tick`]; until then it holds the plan's
    /// first node. The push-off's gains are not computed here but in the ticks of the hold, some nodes of the plan in each
    /// ([`NODES_PER_TICK`](crate::regulator::NODES_PER_TICK)).
    ///
    /// # Errors
    /// A robot that does not stand and a start that is too near are refused: nothing changes then. Too near is one that leaves less time than
    /// [`Settings::least_hold`]. Where so many ticks are missed, or no tick has told the time yet, that shows only at
    /// the start: the jump is not begun then, the robot goes on standing and the tick says [`Refusal::TooLate`].
    pub fn arm(&mut self, jump: Jump<'a, T, N, F>, start: T) -> Result<(), Refusal> {
        let s = &self.settings;
        self.supervisor.may_arm(start, s.least_hold(&jump.plan))?;
        self.posture.joints = jump.landing_joints;
        self.level_feet = self.posture.level_feet(self.model);
        let ground = self.ground(&jump.plan);
        self.waiting = Waiting::new(&jump.landing_joints, ground);
        self.workspace.regulator.begin(&jump.plan, &s.regulator);
        self.jump = Some(jump);
        (self.start, self.node) = (start, 0);
        self.shaping = T::ZERO;
        self.payload = PayloadEstimate::new();
        self.balance = Balance::new();
        self.centred = Centred::new();
        self.gathering = None;
        self.supervisor.armed();
        Ok(())
    }

    /// One tick of 1 kHz at the time `now`, s, on a clock of the caller that only goes forward.
    ///
    /// `heard` is what has arrived since the last tick. `None` is a stale sensor: the last measurement is used until it is too old, and the
    /// joints are damped where there has been none yet. A missed tick is bridged likewise. They end in [`Phase::Abort`] after [`Settings::max_age`] and [`Settings::max_silence`].
    pub fn tick(&mut self, now: T, heard: Option<&Observation<T, N, F>>) -> Tick {
        let work = match self.supervisor.hear(now, heard, &mut None) {
            Ok(Some((inputs, dt))) => self.act(now - self.start, inputs, dt),
            Ok(None) => Work::Damping,
            Err(fault) => self.abort(fault),
        };
        self.supervisor.ticked(work)
    }

    /// One tick of 10 kHz, `dt` seconds after the last: torques for the motors, N m, from joint positions and velocities of
    /// now. Always finite and within the motors' torques; damping alone once [`Machine::tick`] has been missing for
    /// [`Settings::max_silence`].
    pub fn joint_tick(&mut self, q: &[T; N], qd: &[T; N], dt: T) -> [T; N] {
        self.supervisor.joint_tick(q, qd, dt, &self.settings.motors)
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

    /// The landing's memory: [`landing::Program::of`] writes out the quadratic program of the last landing tick.
    #[must_use]
    pub const fn workspace(&self) -> &landing::Workspace<T, N, F> {
        &self.workspace.landing
    }

    /// Which feet are on the ground, and which foot sensors are not believed.
    #[must_use]
    pub const fn contacts(&self) -> (&[bool; F], &[bool; F]) {
        (&self.contact.contacts, &self.contact.faulty)
    }

    fn abort(&mut self, fault: Fault) -> Work {
        self.supervisor.abort(fault);
        Work::Damping
    }

    /// Contacts, events and the command at time `t` of the plan.
    fn act(&mut self, t: T, inputs: &Observation<T, N, F>, dt: T) -> Work {
        let measured = &inputs.measured;
        let feet = &self.settings.pd.feet;
        let now = match self.supervisor.phase {
            Phase::Stance => predicted(measured),
            _ => measured.configuration(),
        };
        self.limbs.update(self.model, &now, feet);
        let v = measured.velocity();
        self.settings.detector.update_at(
            self.model,
            &mut self.contact,
            &self.limbs,
            &v,
            &inputs.joint_torques,
            &measured.foot_forces,
            dt,
        );
        if let Some(event) = self.event(t, measured) {
            self.supervisor.happened(event);
        }
        // Made in its place.
        let command;
        let work = match (self.supervisor.phase, self.jump) {
            (Phase::Hold | Phase::Stance | Phase::Flight | Phase::PreLanding, Some(jump)) => {
                command = self.follow(&jump, t, inputs, &v, dt);
                Work::Cartesian
            }
            (Phase::Landing | Phase::Stand, _) => {
                let work;
                (command, work) = self.stand(measured, &v, dt);
                work
            }
            _ => {
                command = self.supervisor.safe();
                Work::Damping
            }
        };
        match self.supervisor.give(&command) {
            Ok(()) => work,
            Err(fault) => self.abort(fault),
        }
    }

    /// Push-off and flight: feet along the plan.
    fn follow(
        &mut self,
        jump: &Jump<'a, T, N, F>,
        t: T,
        inputs: &Observation<T, N, F>,
        velocity: &Tangent<T, N>,
        dt: T,
    ) -> JointCommand<T, N> {
        let (s, measured) = (&self.settings, &inputs.measured);
        let mut reference = sample(&jump.plan, t, self.node);
        self.node = reference.node;
        reference.torques = sample(&jump.plan, t + s.lookahead, self.node).torques;
        let moment = (reference.node, t);
        let phase = self.supervisor.phase;
        let levelled = phase == Phase::PreLanding && t > jump.plan.touchdown - s.levelling;
        match phase {
            Phase::Hold => {
                self.gather(t, &measured.joints, &mut reference);
                self.hold(jump, t, inputs, &reference.torques);
            }
            Phase::Flight => {
                if let Some(turning) = turning(&jump.plan, moment, measured) {
                    self.shaping = s.inertia_shaping.share(self.shaping, &turning, dt);
                    let moved = s
                        .inertia_shaping
                        .joints(self.shaping, &turning, &self.wanted);
                    for (joint, moved) in reference.joints.iter_mut().zip(&moved) {
                        *joint += *moved;
                    }
                }
            }
            Phase::PreLanding if levelled => {
                // The first tick takes up the posture from which the next ones go on.
                if self.waiting.known {
                    self.level(measured, jump.plan.touchdown - t, dt);
                }
                reference.joints = self.waiting.joints;
                reference.joint_velocities = self.waiting.velocities;
            }
            _ => {}
        }
        let s = &self.settings;
        let q = Configuration {
            joints: reference.joints,
            ..Configuration::NEUTRAL
        };
        self.wanted.update(self.model, &q, &s.pd.feet);
        // Nothing moves levelled legs any more.
        self.waiting.known = levelled;
        let way_b = self.centre(t, levelled, &mut reference.joints);
        match phase {
            Phase::Stance => self.push_off(jump, t, (measured, velocity), &mut reference),
            Phase::Hold if way_b.is_some() => {
                let _ = self.as_it_stands(jump, t, &mut reference);
            }
            _ => {}
        }
        if let Some(way_b) = &way_b {
            for end in &mut self.wanted.ends {
                end.position += way_b;
            }
        }
        let s = &self.settings;
        let speeds = &measured.joint_velocities;
        let mut command =
            s.pd.command_at(&self.limbs, &self.wanted, speeds, &reference);
        let since = t + s.lookahead - jump.plan.takeoff;
        if since >= T::ZERO && matches!(phase, Phase::Stance | Phase::Flight) {
            let up_b = measured.base.rotation.inverse() * Vector3::z();
            let limbs = (&self.limbs, &up_b);
            let foot_forces = &measured.foot_forces;
            s.unloading.apply(since, limbs, foot_forces, &mut command);
        }
        command
    }

    /// On the ground: forces on the feet in contact that bring the body to rest over them.
    fn stand(
        &mut self,
        measured: &Measurement<T, N, F>,
        v: &Tangent<T, N>,
        dt: T,
    ) -> (JointCommand<T, N>, Work) {
        let velocity = self.meet(measured, dt);
        let mut target = Target {
            height: self.settings.stand_height,
            ..Target::LEVEL
        };
        if let Some(jump) = &self.jump {
            target.rot_wb = jump.rot_goal;
        }
        let c = self.landing.step_at(
            self.model,
            &self.limbs,
            v,
            &self.contact.contacts,
            &target,
            &self.waiting.joints,
            &mut self.workspace.landing,
        );
        let mut gains = [JointGains {
            stiffness: T::ZERO,
            damping: T::ZERO,
        }; N];
        for (gains, (stiffness, damping)) in
            gains.iter_mut().zip(c.stiffness.iter().zip(&c.damping))
        {
            (gains.stiffness, gains.damping) = (*stiffness, *damping);
        }
        let command = JointCommand {
            position: c.position,
            velocity,
            feed_forward: c.feed_forward,
            gains,
        };
        (command, Work::Landing(c.outcome))
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> JumpMachine<T, N, F>
    for Machine<'_, T, M, N, F>
{
    type Work = Work;

    #[inline(always)]
    fn tick(&mut self, now: T, observed: Option<&Observation<T, N, F>>) -> Tick {
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

/// How the body turns beside how the plan turns at `moment`.
fn turning<T: Scalar, const N: usize, const F: usize>(
    plan: &Plan<'_, T, N, F>,
    moment: (usize, T),
    measured: &Measurement<T, N, F>,
) -> Option<Turning<T>> {
    let planned = plan.base(moment)?;
    let missing = measured.base.rotation.inverse() * planned.rot_wb;
    Some(Turning {
        missing_b: so3::log(&missing),
        planned_b: planned.omega_b,
        omega_b: measured.base_velocity.angular,
        since: moment.1 - plan.takeoff,
        left: plan.posing - moment.1,
    })
}
