//! The robot's end, simulated: a plant whose motor boards close their loop at their own rate and whose sensors are sampled, behind a link that may
//! be bad.

use super::super::execute::{HOLD, Run, Trial, feet, record};
use super::super::plant::{height_error, plant};
use super::super::{FOOT_COUNT, JOINTS, OWNERS, Planned, World};
use super::{AFTER, Glance, Linked, TICK};
use crate::closed_loop::{Actuators, Feet, Imu, RATIO};
use crate::lab::{Encoders, FootSensors, Link, board_torques};
use crate::noise::Noise;
use jump_control::{Phase, Plan, sample};
use jump_machine::Jump;
use jump_planner::stored::Stored;
use nalgebra::Vector3;
use rbd_core::{Model, Motor};
use robot_link::packet::Packet;
use robot_link::{Board, Command, State, Tally};

/// Damping of the boards before the first command and after the last, N m s/rad.
const DAMPING: f32 = 2.0;
/// Longest datagram, a command, and one byte more, by which a longer one shows.
const LONGEST: usize = Command::<JOINTS>::LENGTH + 1;

/// A datagram on its way.
#[derive(Clone, Copy)]
struct Datagram {
    length: usize,
    bytes: [u8; LONGEST],
}

impl Datagram {
    fn new(from: &[u8]) -> Self {
        let mut bytes = [0; LONGEST];
        let length = from.len().min(LONGEST);
        bytes[..length].copy_from_slice(&from[..length]);
        Self { length, bytes }
    }
}

/// A simulated quadruped at the end of a link. Somebody holds it until the first command.
pub struct RobotEnd<'p> {
    planned: &'p Planned,
    plan: Plan<'p, f64, JOINTS, FOOT_COUNT>,
    world: World,
    board: Board<JOINTS>,
    actuators: Actuators<JOINTS>,
    drives: [Motor<f64>; JOINTS],
    encoders: Encoders<JOINTS>,
    soles: FootSensors<FOOT_COUNT>,
    imu: Imu,
    feet: Feet<JOINTS, FOOT_COUNT, OWNERS>,
    noise: Noise,
    /// What the link does to commands and to states.
    air: [Link<Datagram>; 2],
    linked: Linked,
    /// When the first command came, ns, and ticks of the plant since.
    begun: Option<u64>,
    ticks: u64,
    /// When the next state is due, ns.
    due: u64,
    run: Run,
}

impl<'p> RobotEnd<'p> {
    /// At the start of a planned jump, in the lab and with the noise of a trial.
    ///
    /// # Errors
    /// A sentence: what stands against the plan, the disturbed robot or the simulator.
    pub fn new(planned: &'p Planned, trial: Trial<'_>, linked: Linked) -> Result<Self, String> {
        let (task, disturbance) = (&planned.task, &trial.disturbance);
        let robot = &task.robot;
        let stored = Stored::read(&planned.reference.bytes).map_err(|error| error.to_string())?;
        let jump = Jump::stored(&stored).map_err(|error| error.to_string())?;
        let world = plant(trial.sim, task, disturbance)?;
        let mut noise = Noise::new(trial.seed.wrapping_add(0x5eed), 1.0);
        let air = |seed| Link::new(disturbance, 0.5, 0.0, trial.seed.wrapping_add(seed));
        let limits = (Model::limits(robot), robot.drives());
        let mut run = Run::new(task, stored.checksum(), world.plant().tick());
        run.ground_height = height_error(disturbance);
        // No flight in real time waits for memory.
        run.samples.reserve((1e3 * Self::end(planned)) as usize + 1);
        Ok(Self {
            planned,
            plan: jump.plan,
            board: Board::new(DAMPING),
            actuators: Actuators::new(disturbance, limits, &robot.budgets),
            drives: robot.drives(),
            imu: Imu::new(disturbance, Vector3::zeros(), &mut noise),
            encoders: Encoders::new(disturbance, &mut noise),
            soles: FootSensors::new(disturbance, &mut noise),
            feet: feet(robot),
            noise,
            air: [air(0xb0a2d), air(0x11e7)],
            linked,
            begun: None,
            ticks: 0,
            due: 0,
            run,
            world,
        })
    }

    /// How long it takes until the jump can be judged, ns.
    #[must_use]
    pub fn duration(&self) -> u64 {
        (1e9 * Self::end(self.planned)) as u64
    }

    /// The same in s, from the beginning of the hold.
    fn end(planned: &Planned) -> f64 {
        HOLD + planned.reference.touchdown + AFTER
    }

    /// A datagram comes at the time `now`, ns, at this end's side of the bad link.
    pub fn hear(&mut self, bytes: &[u8], now: u64, glance: &Glance) {
        if !self.is_cut(now, glance) {
            self.air[0].send(seconds(now), Datagram::new(bytes));
        }
    }

    fn is_cut(&self, now: u64, glance: &Glance) -> bool {
        let since = plan_time(now, glance);
        self.linked.cut.is_some_and(|cut| since >= cut)
    }

    /// Lives until the time `now`, ns: ticks of the plant under the newest command, and a state in every period of the link.
    ///
    /// # Errors
    /// What the simulator says.
    pub fn advance(
        &mut self,
        now: u64,
        glance: &Glance,
        mut send: impl FnMut(&[u8]),
    ) -> Result<(), String> {
        while let Some((datagram, _)) = self.air[0].receive(seconds(now)) {
            // What is wrong with it is counted there.
            let _ = self.board.hear(&datagram.bytes[..datagram.length], now);
        }
        if self.begun.is_none() && self.board.is_commanded() {
            (self.begun, self.due) = (Some(now), now);
        }
        let mut time = now;
        loop {
            if let Some(begun) = self.begun {
                time = begun + self.ticks * TICK;
            }
            if time > now {
                break;
            }
            if time >= self.due {
                self.say(time, glance);
            }
            if self.begun.is_none() {
                break;
            }
            self.tick(time, glance)?;
        }
        while let Some((datagram, _)) = self.air[1].receive(seconds(now)) {
            send(&datagram.bytes[..datagram.length]);
        }
        Ok(())
    }

    /// Says what the sensors do at the time of a tick, ns.
    fn say(&mut self, time: u64, glance: &Glance) {
        let period_ms = self.linked.period_ms;
        self.due = time + u64::from(period_ms) * u64::from(RATIO) * TICK;
        let (q, v) = (self.world.configuration(), *self.world.velocity());
        let noise = &mut self.noise;
        let (joints, joint_velocities) = self.encoders.read(&q.joints, &v.joints, noise);
        let period = 1e-3 * f64::from(period_ms);
        let [specific_force, angular_velocity] = self.imu.sample(&q, &v, period, noise);
        let forces = (self.feet.forces)(&self.world);
        let state = State {
            tripped: false,
            joints: joints.map(single),
            joint_velocities: joint_velocities.map(single),
            joint_torques: (self.actuators.take_felt()).map(|x| single(x / f64::from(period_ms))),
            specific_force_i: specific_force.map(single).into(),
            angular_velocity_i: angular_velocity.map(single).into(),
            foot_forces: self.soles.read(forces, noise).map(single),
        };
        let mut out = [0; LONGEST];
        let length = self.board.say(&state, time, &mut out);
        if !self.is_cut(time, glance) {
            let said = &out[..length.unwrap_or_default()];
            self.air[1].send(seconds(time), Datagram::new(said));
        }
    }

    /// A tick of the plant from the time `time` on, ns, watched by the judge from the arming until the jump can be judged.
    fn tick(&mut self, time: u64, glance: &Glance) -> Result<(), String> {
        let t = plan_time(time, glance);
        let is_seen = glance.start.is_some() && t + HOLD < Self::end(self.planned);
        if is_seen {
            (self.run.final_phase, self.run.fault) = (glance.phase, glance.fault);
        }
        if is_seen && self.ticks.is_multiple_of(u64::from(RATIO)) {
            let planned = sample(&self.plan, t, 0);
            let robot = &self.planned.task.robot;
            let seen = record(robot, &self.world, glance.phase, &self.plan, &planned, t);
            self.run.samples.push(seen);
        }
        let (q, v) = (
            self.world.configuration().joints,
            self.world.velocity().joints,
        );
        let (q, v) = self.encoders.read(&q, &v, &mut self.noise);
        let command = Command(self.board.command(time)).as_scalar();
        let computed = board_torques(&command, (&q, &v), &self.drives);
        let flies = matches!(glance.phase, Phase::Flight | Phase::PreLanding);
        let world = (&mut self.world, flies);
        let step = self.actuators.step(world, (t, 0.0), (q, v), computed)?;
        if is_seen {
            self.run.observe(&self.world, &step, glance.phase);
        }
        self.ticks += 1;
        Ok(())
    }

    /// What was said and heard so far.
    #[must_use]
    pub const fn tally(&self) -> &Tally {
        self.board.tally()
    }

    /// Whether its watchdog has tripped.
    #[must_use]
    pub const fn has_tripped(&self) -> bool {
        self.board.has_tripped()
    }

    /// The run up to when it can be judged, for the judge.
    #[must_use]
    pub fn finish(self) -> Run {
        self.run
    }
}

/// Time of the plan at the time `now`, ns; that of the hold's beginning before the jump is armed, s.
fn plan_time(now: u64, glance: &Glance) -> f64 {
    glance.start.map_or(-HOLD, |start| {
        1e-9 * now.wrapping_sub(start).cast_signed() as f64
    })
}

fn seconds(now: u64) -> f64 {
    1e-9 * now as f64
}

fn single(x: f64) -> f32 {
    x as f32
}
