//! The machine: memory, and one method per rate.

use jump_control::{
    Fault, JointCommand, JointGains, Measurement, PayloadEstimate, Phase, Plan, Reference, sample,
};
use landing::{
    AttitudeCompensation, DetectorState, Landing, Outcome, PreLanding, Target, Turning, Workspace,
};
use nalgebra::Vector3;
use rbd_core::{Configuration, GRAVITY, Limbs, Tangent, Tree};
use so3::{Scalar, math};

use crate::supervisor::{Limits, Supervisor};
use crate::{Jump, JumpMachine, Observation, Refusal, Settings, Tick};

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
/// It borrows model, plans and the landing's memory, so that they can be statics.
#[derive(Debug)]
pub struct Machine<'a, T: Scalar, M, const N: usize, const F: usize> {
    pub(crate) settings: Settings<T, N, F>,
    pub(crate) jump: Option<Jump<'a, T, N, F>>,
    pub(crate) supervisor: Supervisor<T, N, F>,
    pub(crate) contact: DetectorState<T, N, F>,
    /// Time at rest so far, s.
    pub(crate) calm: T,
    model: &'a M,
    landing: Landing<T, N, F>,
    workspace: &'a mut Workspace<T, N, F>,
    posture: PreLanding<T, N, F>,
    /// Feet of the level landing posture, base axes.
    level_feet: [Vector3<T>; F],
    /// The landing posture as it follows the body.
    legs: [T; N],
    /// The legs as measured, and as they should be: kept so that a tick copies nothing.
    limbs: Limbs<T, N, F>,
    wanted: Limbs<T, N, F>,
    payload: PayloadEstimate<T>,
    /// When the plan begins, on the clock of `tick`.
    start: T,
    /// Node of the plan's last sample.
    node: usize,
    /// By how much the plan's clock is behind the caller's in this flight, s.
    late: T,
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
            }),
            contact: DetectorState::new(),
            calm: T::ZERO,
            model,
            landing: Landing::new(settings.pd.feet, settings.landing, torques),
            workspace,
            level_feet: settings.posture.level_feet(model),
            legs: settings.posture.joints,
            limbs: Limbs::ZERO,
            wanted: Limbs::ZERO,
            posture: settings.posture,
            payload: PayloadEstimate::new(),
            start: T::ZERO,
            node: 0,
            late: T::ZERO,
            shaping: T::ZERO,
            settings,
        }
    }

    /// Gives a standing robot a jump that begins at `start`, on the clock of [`Machine::tick`]; until then it holds the plan's
    /// first node.
    ///
    /// # Errors
    /// A robot that does not stand and a start that is too near are refused: nothing changes then.
    pub fn arm(&mut self, jump: Jump<'a, T, N, F>, start: T) -> Result<(), Refusal> {
        self.supervisor.may_arm(start, self.settings.weighing)?;
        self.posture.joints = jump.landing_joints;
        self.level_feet = self.posture.level_feet(self.model);
        self.legs = jump.landing_joints;
        self.jump = Some(jump);
        (self.start, self.node) = (start, 0);
        (self.late, self.shaping) = (T::ZERO, T::ZERO);
        self.payload = PayloadEstimate::new();
        self.supervisor.armed();
        Ok(())
    }

    /// One tick of 1 kHz at the time `now`, s, on a clock of the caller that only goes forward.
    ///
    /// `heard` is what has arrived since the last tick. `None` is a stale sensor: the last measurement is used until it is too old. A
    /// missed tick is bridged likewise. They end in [`Phase::Abort`] after [`Settings::max_age`] and [`Settings::max_silence`].
    pub fn tick(&mut self, now: T, heard: Option<&Observation<T, N, F>>) -> Tick {
        let work = match self.supervisor.hear(now, heard) {
            Ok((inputs, dt)) => self.act(now - self.start, &inputs, dt),
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
    pub const fn workspace(&self) -> &Workspace<T, N, F> {
        self.workspace
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
        self.limbs
            .update(self.model, &measured.configuration(), feet);
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
        let t = self.plan_time(t, measured);
        if let Some(event) = self.event(t, measured) {
            self.supervisor.happened(event);
        }
        let (command, work) = match (self.supervisor.phase, self.jump) {
            (Phase::Hold | Phase::Stance | Phase::Flight | Phase::PreLanding, Some(jump)) => {
                (self.follow(&jump, t, measured, dt), Work::Cartesian)
            }
            (Phase::Landing | Phase::Stand, _) => self.stand(&v),
            _ => (self.supervisor.safe(), Work::Damping),
        };
        match self.supervisor.give(&command) {
            Ok(()) => work,
            Err(fault) => self.abort(fault),
        }
    }

    /// What the plan's clock shows: in flight it is shifted, little by little, so that it shows the planned touchdown when the
    /// ground comes.
    fn plan_time(&mut self, t: T, measured: &Measurement<T, N, F>) -> T {
        let (Some(jump), Phase::Flight | Phase::PreLanding) = (&self.jump, self.supervisor.phase)
        else {
            return t;
        };
        let plan = &jump.plan;
        let base = &measured.base;
        let vel_w = base.rotation * measured.base_velocity.linear;
        let moment = (self.node, t - self.late - measured.age);
        if let Some(late) = plan.lateness(moment, base, &vel_w) {
            // Whole from the middle of the way to the landing posture on.
            let share = T::TWO * (t - plan.takeoff) / (plan.posing - plan.takeoff);
            let late = (self.late + late) * math::clamp(share, T::ZERO, T::ONE);
            let most = self.settings.max_late;
            self.late = math::clamp(late, -most, most);
        }
        t - self.late
    }

    /// Push-off and flight: feet along the plan.
    fn follow(
        &mut self,
        jump: &Jump<'a, T, N, F>,
        t: T,
        measured: &Measurement<T, N, F>,
        dt: T,
    ) -> JointCommand<T, N> {
        let s = &self.settings;
        let mut then = sample(&jump.plan, t - measured.age, self.node);
        let mut reference = sample(&jump.plan, t, then.node);
        reference.torques = sample(&jump.plan, t + s.lookahead, then.node).torques;
        self.node = then.node;
        let moment = (then.node, t - measured.age);
        match self.supervisor.phase {
            // Its weight has settled on the feet by then.
            Phase::Hold if t > -s.weighing => self.payload.add(&measured.foot_forces),
            Phase::Stance => self.push_off(jump, moment, measured, &mut then, &mut reference),
            Phase::Flight => {
                if let Some(turning) = turning(&jump.plan, moment, measured) {
                    self.shaping = s.inertia_shaping.share(self.shaping, &turning, dt);
                    let moved = s
                        .inertia_shaping
                        .joints(self.shaping, &turning, &self.wanted);
                    add(&mut then.joints, &moved);
                    add(&mut reference.joints, &moved);
                }
            }
            Phase::PreLanding if t > jump.plan.touchdown - s.levelling => {
                self.level(jump.plan.touchdown - t, measured);
                (then.joints, reference.joints) = (self.legs, self.legs);
            }
            _ => {}
        }
        let s = &self.settings;
        let q = Configuration {
            joints: then.joints,
            ..Configuration::NEUTRAL
        };
        self.wanted.update(self.model, &q, &s.pd.feet);
        s.pd.command_at(
            &self.limbs,
            &self.wanted,
            &measured.joint_velocities,
            &reference,
            &then,
        )
    }

    /// Feedback of the push-off at a `moment` of the plan: torques as the weight on the feet was, forces that keep the base on its
    /// plan, and feet that keep their places in the world while the body leans. `then` is the plan as the legs were measured,
    /// `reference` as it is now.
    #[inline(always)]
    fn push_off(
        &self,
        jump: &Jump<'a, T, N, F>,
        moment: (usize, T),
        measured: &Measurement<T, N, F>,
        then: &mut Reference<T, N>,
        reference: &mut Reference<T, N>,
    ) {
        let s = &self.settings;
        let factor = self.payload.factor(jump.weight, s.max_payload);
        reference.torques = reference.torques.map(|torque| torque * factor);
        let feet_b = self.limbs.ends.map(|end| end.position);
        let mass = jump.weight / T::of(-GRAVITY[2]);
        let forces = s
            .base_feedback
            .forces(&jump.plan, moment, mass, measured, &feet_b);
        for (end, force) in self.limbs.ends.iter().zip(&forces) {
            end.add_tr_mul(&-force, &mut reference.torques);
        }
        let share = s.base_feedback.compensation(&jump.plan, moment.0);
        let Some(planned) = jump.plan.base(moment).filter(|_| share > T::ZERO) else {
            return;
        };
        let compensation = AttitudeCompensation {
            turn: measured.base.rotation.inverse() * planned.rot_wb,
            rate_b: planned.omega_b - measured.base_velocity.angular,
            // The same legs are moved likewise in flight.
            damping: s.inertia_shaping.damping,
        };
        let (moved, speeds) = compensation.joints(share, &self.wanted, &then.joint_velocities);
        add(&mut then.joints, &moved);
        add(&mut reference.joints, &moved);
        add(&mut then.joint_velocities, &speeds);
        add(&mut reference.joint_velocities, &speeds);
    }

    /// The landing posture as the body will be turned at touchdown, `left` seconds from now.
    #[inline(always)]
    fn level(&mut self, left: T, measured: &Measurement<T, N, F>) {
        let foresight = math::clamp(left, T::ZERO, self.settings.foresight);
        let turn = so3::exp(&(measured.base_velocity.angular * foresight)).inverse();
        let up_b = turn * (measured.base.rotation.inverse() * Vector3::z());
        let velocity_b = turn * measured.base_velocity.linear;
        self.legs = self.posture.follow(
            self.model,
            &self.level_feet,
            (&up_b, &velocity_b),
            &self.legs,
            &mut self.wanted,
        );
    }

    /// On the ground: forces on the feet in contact that bring the body to rest over them.
    fn stand(&mut self, v: &Tangent<T, N>) -> (JointCommand<T, N>, Work) {
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
            &self.posture.joints,
            self.workspace,
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
            velocity: [T::ZERO; N],
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

    fn tick(&mut self, now: T, observed: Option<&Observation<T, N, F>>) -> Tick {
        Machine::tick(self, now, observed)
    }

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

fn add<T: Scalar, const N: usize>(to: &mut [T; N], more: &[T; N]) {
    for (to, more) in to.iter_mut().zip(more) {
        *to += *more;
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
