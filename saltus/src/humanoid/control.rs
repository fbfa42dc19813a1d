//! The controller of a humanoid jump: push-off by a program; flight and landing by another, or by servos. 1 kHz.

use super::sensors::Told;
use super::{GRAVITY, JOINTS, Landing, Level, State, Task, Velocity, known, landing_posture};
use super::{flight_time, middle_of_soles, on_the_floor, poses};
use icub_model::gazebo::joint;
use icub_model::{LIMITS, SOLES};
use jump_control::{ComProfile, Event, JointCommand, JointGains, MinimumJerk, Phase, next_phase};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{JointLimits, TableModel, Transform, Tree};
use wbc_qp::jump::{
    Absorption, ComReference, LandingReference, LandingSettings, Residuals, TorqueJump,
    TorqueJumpSettings, TorqueTick, VelocityJump, VelocityJumpSettings,
};
use wbc_qp::{Contact, Snapshot, Yielded, anchored};

/// Length of a tick, s.
pub(crate) const TICK: f64 = 1e-3;
/// Duration of the aerial motion over that of the planned flight: joints that leave the ground at 7 rad/s with their rotors need all of it,
/// less what ground that comes early takes away.
const AERIAL: f64 = 0.9;
/// Factors on the servos' gains of legs and torso once the ground is there: the hold of paper B, but compliant, since the
/// stiff one throws the robot back into the air.
const LANDING_STIFFNESS: f64 = 0.1;
const LANDING_DAMPING: f64 = 1.4;
/// Force on both soles that counts as touchdown, N.
const TOUCH: f64 = 20.0;
/// Force on a sole that counts as contact of this sole, N.
const SOLE_TOUCH: f64 = 5.0;
/// Time in which a contact is added to the program or removed from it, s.
const LOADING: f64 = 0.01;
/// Way of the centre of mass in which the fall ends, m, and the longest time for it, s.
const ABSORB: f64 = 0.08;
const ABSORB_TIME: f64 = 0.4;
/// Time in which the robot then rises to the landing posture, s.
const RISE_TIME: f64 = 0.8;
/// Ground friction that the controller counts on.
const FRICTION: f64 = 0.5;
/// Residuals up to which an equality of the paper counts as held: m/s and kg m²/s.
const HELD_VELOCITY: Residuals<f64> = Residuals {
    com: 0.02,
    momentum: 0.05,
};
/// The same at the level of torques: m/s² and N m.
const HELD_TORQUE: Residuals<f64> = Residuals {
    com: 0.1,
    momentum: 0.5,
};

/// What the programs did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct QpLog {
    pub(crate) solves: u64,
    pub(crate) failures: u64,
    pub(crate) max_iterations: u32,
    pub(crate) relaxed_ticks: u64,
    /// Largest residuals in the push-off.
    pub(crate) residuals: Residuals<f64>,
}

/// The controller with its memory.
pub(crate) struct Controller {
    task: Task,
    /// The robot as far as it is known.
    robot: TableModel<f64, JOINTS>,
    profile: ComProfile<f64>,
    pub(crate) phase: Phase,
    pub(crate) qp: QpLog,
    pub(crate) reference: ComReference<f64>,
    snapshot: Snapshot<f64, JOINTS>,
    contacts: [Contact<f64>; 2],
    velocity: Box<VelocityJump<f64, JOINTS, 29, 12>>,
    torque: Box<TorqueJump<f64, JOINTS, 12, 35, 55>>,
    landing: Box<wbc_qp::jump::Landing<f64, JOINTS, 12, 35, 55>>,
    /// How the fall ends: since when, from which height over the soles.
    absorption: Option<(f64, f64, Absorption<f64>)>,
    /// Orientation of the base in the landing posture, and its height of the centre of mass over the soles.
    upright: Rotation3<f64>,
    standing: f64,
    start_com: Vector3<f64>,
    /// Where the left sole stands.
    anchor: Transform<f64>,
    /// Positions that the servos track.
    servo: [f64; JOINTS],
    /// Torques of the last program that was solved.
    last_torques: [f64; JOINTS],
    aerial: MinimumJerk<f64, JOINTS>,
    /// Velocities of the joints at the take-off.
    pushed: [f64; JOINTS],
    took_off: f64,
    calm: f64,
}

/// Gains of the joints' servos, by joint: hips and knees, ankles, torso, arms.
fn servo_gains() -> [JointGains<f64>; JOINTS] {
    core::array::from_fn(|i| {
        let (stiffness, damping) = match i {
            0..12 if i % 6 == 4 || i % 6 == 5 => (4000.0, 20.0),
            0..12 => (6000.0, 60.0),
            12..15 => (4000.0, 50.0),
            _ => (600.0, 8.0),
        };
        JointGains { stiffness, damping }
    })
}

/// The joints' limits with a margin on speed: servos overshoot their commands a little, the light arms more.
fn guarded_limits() -> [JointLimits<f64>; JOINTS] {
    core::array::from_fn(|i| JointLimits {
        speed: LIMITS[i].speed
            * if i < joint::L_SHOULDER_PITCH {
                0.95
            } else {
                0.9
            },
        ..LIMITS[i]
    })
}

impl Controller {
    /// At rest in this state.
    pub(crate) fn new(task: Task, start: &State) -> Result<Self, String> {
        let mut settings = VelocityJumpSettings::icub();
        settings.posture_weight = core::array::from_fn(|i| match i {
            joint::L_KNEE | joint::R_KNEE => 3.0,
            joint::L_HIP_PITCH | joint::R_HIP_PITCH => 0.7,
            joint::L_SHOULDER_PITCH.. => 0.3,
            _ => 1.0,
        });
        let mut torque = TorqueJumpSettings::icub();
        torque.posture_weight = settings.posture_weight;
        if !task.momentum {
            settings.momentum_weight = 0.0;
            torque.momentum_weight = 0.0;
        }
        let start_com = super::com(start);
        let standing = on_the_floor(landing_posture());
        let profile = task.profile()?;
        let flight = flight_time(&profile, start_com.z);
        Ok(Self {
            task,
            robot: known(&task)?,
            profile,
            phase: Phase::Hold,
            qp: QpLog::default(),
            reference: ComReference {
                position_w: start_com,
                velocity_w: Vector3::zeros(),
                acceleration_w: Vector3::zeros(),
            },
            snapshot: Snapshot::ZERO,
            contacts: SOLES.map(|sole| Contact::new(&sole, FRICTION, 1000.0)),
            velocity: Box::new(VelocityJump::new(settings, start.joints)),
            torque: Box::new(TorqueJump::new(torque, start.joints)),
            landing: Box::new(wbc_qp::jump::Landing::new(LandingSettings::icub())),
            absorption: None,
            upright: standing.base.rotation,
            standing: super::com(&standing).z,
            start_com,
            anchor: poses(start).frame(&SOLES[0].frame),
            servo: start.joints,
            last_torques: [0.0; JOINTS],
            aerial: MinimumJerk {
                from: start.joints,
                velocity: [0.0; JOINTS],
                to: landing_posture(),
                duration: AERIAL * flight,
            },
            pushed: [0.0; JOINTS],
            took_off: f64::INFINITY,
            calm: 0.0,
        })
    }

    /// Mass of the robot as it is known, kg.
    pub(crate) fn mass(&self) -> f64 {
        let base = Tree::<f64, JOINTS>::base(&self.robot).mass;
        let bodies = Tree::<f64, JOINTS>::bodies(&self.robot);
        base + bodies.iter().map(|body| body.mass).sum::<f64>()
    }

    /// Planned time of take-off, s.
    pub(crate) const fn takeoff(&self) -> f64 {
        self.profile.duration
    }

    fn event(&mut self, t: f64, v: &Velocity, sole_force: f64) -> Option<Event> {
        let moving = v.base.linear.norm() > 0.05 || v.base.angular.norm() > 0.2;
        self.calm = if moving { 0.0 } else { self.calm + TICK };
        match self.phase {
            Phase::Hold => (t >= 0.0).then_some(Event::Start),
            Phase::Stance => (t >= self.profile.duration).then_some(Event::Takeoff),
            // The ground cannot come before the robot falls.
            Phase::Flight => {
                (t >= self.took_off + self.profile.speed / GRAVITY).then_some(Event::Posing)
            }
            Phase::PreLanding if sole_force > TOUCH => Some(Event::Touchdown),
            Phase::PreLanding => (t > self.took_off + 1.0).then_some(Event::Overdue),
            Phase::Landing => (self.calm > 0.2).then_some(Event::Settled),
            Phase::Stand => (self.calm == 0.0).then_some(Event::Disturbed),
            Phase::Abort => None,
        }
    }

    /// One tick at time `t` since the start of the push-off.
    pub(crate) fn tick(&mut self, t: f64, told: &Told) -> JointCommand<f64, JOINTS> {
        if let Some(event) = self.event(t, &told.v, told.forces.iter().sum()) {
            let before = self.phase;
            self.phase = next_phase(self.phase, event);
            if before == Phase::Stance {
                self.took_off = t;
                self.pushed = told.v.joints;
                self.aerial.from = match self.task.landing {
                    Landing::Qp => told.q.joints,
                    Landing::Hold | Landing::Stiff => self.servo,
                };
            }
        }
        match self.phase {
            Phase::Hold | Phase::Stance => self.push(t, &told.q, &told.v),
            Phase::Flight | Phase::PreLanding | Phase::Landing | Phase::Stand => {
                let [position, mut velocity, acceleration] = self.in_the_air(t - self.took_off);
                if self.task.landing == Landing::Qp {
                    // The program's posture is damped towards a velocity: this much more of it asks for the acceleration as well.
                    for (v, a) in velocity.iter_mut().zip(acceleration) {
                        *v += a / self.landing.settings.posture[0].damping;
                    }
                    return self.land(t, told, position, velocity);
                }
                self.servo = position;
                let mut command = self.track(velocity);
                if self.on_ground() && self.task.landing == Landing::Hold {
                    for gains in &mut command.gains[..joint::L_SHOULDER_PITCH] {
                        gains.stiffness *= LANDING_STIFFNESS;
                        gains.damping *= LANDING_DAMPING;
                    }
                }
                command
            }
            Phase::Abort => JointCommand::damp(5.0),
        }
    }

    /// Positions, velocities and accelerations of the joints a time after the take-off: a minimum jerk from rest to the landing posture, and
    /// what is left of the push-off's velocity v: v (1 − x)³ after a share x of the duration T, a way of v T/4.
    ///
    /// A minimum jerk that starts with v alone brakes from nothing: the soles would go on to push. This brakes with 3 v/T at once, harder
    /// than the body falls for all T < 3 v/g, and at no time harder than that.
    fn in_the_air(&self, time: f64) -> [[f64; JOINTS]; 3] {
        let all = self.aerial.duration;
        let x = (time / all).clamp(0.0, 1.0);
        let left = 1.0 - x;
        let mut rest = self.aerial;
        for (to, v) in rest.to.iter_mut().zip(&self.pushed) {
            *to -= 0.25 * v * all;
        }
        let (mut position, mut velocity) = rest.at(time);
        let acceleration = core::array::from_fn(|i| {
            let v = self.pushed[i];
            position[i] += 0.25 * v * all * (1.0 - left * left * left * left);
            velocity[i] += v * left * left * left;
            let way = rest.to[i] - rest.from[i];
            60.0 * way * x * left * (1.0 - 2.0 * x) / (all * all) - 3.0 * v * left * left / all
        });
        [position, velocity, acceleration]
    }

    /// Whether the robot has come down.
    fn on_ground(&self) -> bool {
        matches!(self.phase, Phase::Landing | Phase::Stand)
    }

    /// Flight and landing by one program: contacts come as the ground comes.
    fn land(
        &mut self,
        t: f64,
        told: &Told,
        posture: [f64; JOINTS],
        velocity: [f64; JOINTS],
    ) -> JointCommand<f64, JOINTS> {
        self.snapshot.update(&self.robot, &told.q, &told.v);
        let on_ground = self.on_ground();
        for (contact, force) in self.contacts.iter_mut().zip(told.forces) {
            let there = on_ground && force > SOLE_TOUCH;
            let step = if there { TICK } else { -TICK } / LOADING;
            contact.load = if self.phase == Phase::Flight {
                0.0
            } else {
                (contact.load + step).clamp(0.0, 1.0)
            };
        }
        let soles = middle_of_soles(&self.snapshot.kinematics);
        let [height, speed, acceleration] = self.height(t, soles.z);
        let position_w = Vector3::new(soles.x, soles.y, soles.z + height);
        let up = Vector3::z();
        let wanted = LandingReference {
            com: ComReference {
                position_w,
                velocity_w: up * speed,
                acceleration_w: up * acceleration,
            },
            trunk: self.upright,
            posture,
            velocity,
        };
        self.qp.solves += 1;
        let tick = self.landing.tick(
            &self.robot,
            &self.snapshot,
            &self.contacts,
            (&guarded_limits(), &self.task.motors()),
            &wanted,
        );
        self.command(tick, None)
    }

    /// Height of the centre of mass over soles that are `floor` high, its speed and acceleration as they should be: a free fall, its end,
    /// and a rise to the landing posture. Over the soles, since legs measure it; the estimated height over the world drifts with a blow.
    fn height(&mut self, t: f64, floor: f64) -> [f64; 3] {
        let (now, speed) = (
            self.snapshot.com_w().z - floor,
            self.snapshot.com_velocity_w().z,
        );
        if self.on_ground() && self.absorption.is_none() {
            let absorption = Absorption::new(speed.min(0.0), ABSORB, ABSORB_TIME);
            self.absorption = Some((t, now, absorption));
        }
        let Some((start, first, absorption)) = self.absorption else {
            return [now, speed, -GRAVITY];
        };
        let [way, speed, acceleration] = absorption.at(t - start);
        let left = t - start - absorption.duration;
        if left < 0.0 {
            return [first + way, speed, acceleration];
        }
        let x = (left / RISE_TIME).min(1.0);
        let rise = self.standing - first - way;
        [
            first + way + rise * x * x * x * (10.0 - x * (15.0 - 6.0 * x)),
            rise * 30.0 * x * x * (1.0 - x) * (1.0 - x) / RISE_TIME,
            rise * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (RISE_TIME * RISE_TIME),
        ]
    }

    fn track(&self, velocity: [f64; JOINTS]) -> JointCommand<f64, JOINTS> {
        JointCommand {
            position: self.servo,
            velocity,
            feed_forward: [0.0; JOINTS],
            gains: servo_gains(),
        }
    }

    fn push(&mut self, t: f64, q: &State, v: &Velocity) -> JointCommand<f64, JOINTS> {
        let sole = &SOLES[0].frame;
        let (q, v) = match self.task.level {
            // Servos hide the soles' own small motion, and a centre of mass that ignores it is smooth.
            Level::Velocity => anchored(&self.robot, &q.joints, &v.joints, sole, &self.anchor),
            // Torques do not: a sole that rocks would look like the whole robot rocking.
            Level::Torque => (*q, *v),
        };
        self.snapshot.update(&self.robot, &q, &v);
        let point = self.profile.at(t);
        let up = Vector3::z();
        self.reference = ComReference {
            position_w: self.start_com + up * point.rise,
            velocity_w: up * point.speed,
            acceleration_w: up * point.acceleration,
        };
        self.qp.solves += 1;
        match self.task.level {
            Level::Velocity => self.push_by_velocity(),
            Level::Torque => self.push_by_torque(),
        }
    }

    fn push_by_velocity(&mut self) -> JointCommand<f64, JOINTS> {
        let tick = self.velocity.tick(
            &self.robot,
            &self.snapshot,
            &self.contacts,
            &guarded_limits(),
            &self.reference,
            TICK,
        );
        let velocities = match tick {
            Ok(tick) => {
                self.note(tick.iterations, &tick.residuals, false, Some(HELD_VELOCITY));
                tick.velocities
            }
            Err(_) => {
                self.qp.failures += 1;
                [0.0; JOINTS]
            }
        };
        let command = self.track(velocities);
        for (servo, qd) in self.servo.iter_mut().zip(velocities) {
            *servo += TICK * qd;
        }
        command
    }

    /// Torques are held for a tick; the servos only follow, to be ready for the flight.
    fn push_by_torque(&mut self) -> JointCommand<f64, JOINTS> {
        let tick = self.torque.tick(
            &self.robot,
            &self.snapshot,
            &self.contacts,
            (&guarded_limits(), &self.task.motors()),
            &self.reference,
        );
        self.servo = self.snapshot.configuration.joints;
        self.command(tick, Some(HELD_TORQUE))
    }

    /// The torques of a program, or the last ones if it failed; `held` as for [`Self::note`].
    fn command(
        &mut self,
        tick: Result<TorqueTick<f64, JOINTS, 12>, wbc_qp::Error>,
        held: Option<Residuals<f64>>,
    ) -> JointCommand<f64, JOINTS> {
        match tick {
            Ok(tick) => {
                let yielded = tick.answer.yielded != Yielded::Nothing;
                self.note(tick.answer.iterations, &tick.residuals, yielded, held);
                // A command, but not the program's optimum.
                self.qp.failures += u64::from(tick.answer.capped);
                self.last_torques = tick.answer.torques;
            }
            Err(_) => self.qp.failures += 1,
        }
        let mut command = JointCommand::damp(0.0);
        command.feed_forward = self.last_torques;
        command
    }

    /// Books a solve. `held` says up to which residuals the paper's equalities count as held; where nothing has to hold them,
    /// `None`.
    fn note(
        &mut self,
        iterations: u32,
        residuals: &Residuals<f64>,
        yielded: bool,
        held: Option<Residuals<f64>>,
    ) {
        let log = &mut self.qp;
        log.max_iterations = log.max_iterations.max(iterations);
        let mut relaxed = yielded;
        if let Some(held) = held {
            let momentum = if self.task.momentum {
                residuals.momentum
            } else {
                0.0
            };
            relaxed |= residuals.com > held.com || momentum > held.momentum;
            log.residuals.com = log.residuals.com.max(residuals.com);
            log.residuals.momentum = log.residuals.momentum.max(momentum);
        }
        log.relaxed_ticks += u64::from(relaxed);
    }

    /// Height that the push-off's reference asks for now, m.
    pub(crate) fn wanted_height(&self, t: f64) -> f64 {
        self.start_com.z + self.profile.at(t).rise
    }

    /// Speed that a jump of the task's height needs, m/s.
    pub(crate) fn wanted_speed(&self) -> f64 {
        jump_control::takeoff_speed(self.task.height, GRAVITY)
    }
}
