//! The reference by leg kinematics along the single-rigid-body plan.
//!
//! The plan gives the motion of the centre of mass; base and legs follow because the balls of the feet roll on the ground
//! without slip. The robot has the body's angular momentum, and torques are inverse dynamics with the plan's foot
//! forces, changed as little as the whole-body dynamics of the base require (they differ from those of a rigid body by the
//! moving legs and the rolling contact points). In flight the legs go to the pre-landing posture.

use super::planned::{Origin, follow};
use super::stored::Content;
use super::task::{PHASES, SrbPlan, SrbStage, Task};
use super::{FOOT_COUNT, JOINTS, Node, State, Velocity, state};
use crate::robot::Quadruped;
use nalgebra::{Matrix6, Vector3, Vector6};
use rbd_core::{
    Force, GRAVITY, Model, Motion, Posture, Transform, integrate, interpolate, joint_friction, rnea,
};

/// Longest integration step of the kinematics, s.
const STEP: f64 = 1e-3;
/// Time in which the base is pulled back to the planned centre of mass, s.
const PULL: f64 = 0.02;
/// Share of the flight after which the pre-landing posture stands.
const POSING_SHARE: f64 = 0.5;
/// Speed at which planned Coulomb friction fades, rad/s.
const FRICTION_SMOOTHING: f64 = 0.1;

/// The reference and its margins.
#[derive(Clone)]
pub struct Reference {
    /// The container: what the machine flies. All else is read from it, for judges and reports.
    pub bytes: Vec<u8>,
    /// From the posture in which the robot waits to the touchdown.
    pub nodes: Vec<Node>,
    /// When the last foot leaves the ground, s.
    pub takeoff: f64,
    /// From when on the legs are in their landing posture, s.
    pub posing: f64,
    /// When the plan expects the ground, s.
    pub touchdown: f64,
    /// Pre-landing joint positions.
    pub landing_joints: [f64; JOINTS],
    /// Durations of the phases, s.
    pub durations: Vec<f64>,
    /// Largest planned torque in the push-off, N m.
    pub peak_torque: f64,
    /// Largest tangential over normal force in the push-off.
    pub peak_friction: f64,
    /// Largest wrench on the base that the forces do not balance: N or N m; not a number for a stored plan.
    pub base_residual: f64,
    /// Where it comes from.
    pub origin: Origin,
}

impl Reference {
    /// Where the plan has the robot at a time, between two nodes along the geodesic; its ends before and after. `None` without nodes.
    #[must_use]
    pub fn pose(&self, time: f64) -> Option<State> {
        let after = self.nodes.partition_point(|node| node.time <= time);
        let next = self.nodes.get(after).or(self.nodes.last())?;
        let last = self.nodes.get(after.saturating_sub(1))?;
        let (from, to) = (state(last).0, state(next).0);
        let span = next.time - last.time;
        if span <= 0.0 {
            return Some(to);
        }
        Some(interpolate(&from, &to, (time - last.time) / span))
    }
}

/// Motion of the single rigid body over one interval.
struct Interval {
    start: f64,
    dt: f64,
    pos: Vector3<f64>,
    vel: Vector3<f64>,
    acc: Vector3<f64>,
    /// Angular momentum at both ends, world axes.
    momentum: (Vector3<f64>, Vector3<f64>),
    rotation: nalgebra::Rotation3<f64>,
    phase: usize,
    contacts: [bool; FOOT_COUNT],
    forces_w: [Vector3<f64>; FOOT_COUNT],
}

impl Interval {
    /// Position and velocity of the centre of mass and angular momentum, a time after the start.
    fn at(&self, s: f64) -> [Vector3<f64>; 3] {
        [
            self.pos + (self.vel + self.acc * (0.5 * s)) * s,
            self.vel + self.acc * s,
            self.momentum.0 + (self.momentum.1 - self.momentum.0) * (s / self.dt),
        ]
    }
}

fn intervals(task: &Task, stages: &[SrbStage]) -> Vec<Interval> {
    let problem = &task.problem;
    let momentum =
        |state: &srb_opt::State<f64, PHASES>| state.rot_wb * problem.inertia_b * state.omega_b;
    let mut start = 0.0;
    let mut out = Vec::new();
    for (k, pair) in stages.windows(2).enumerate() {
        let (state, next) = (&pair[0].state, &pair[1].state);
        let Some((phase, data)) = problem.phase_of(k) else {
            break;
        };
        let dt = state.durations[phase] / data.intervals as f64;
        let forces_w = problem.sample(k, state, &pair[0].control).forces_w;
        let total: Vector3<f64> = forces_w.iter().sum();
        out.push(Interval {
            start,
            dt,
            pos: state.pos_w,
            vel: state.vel_w,
            acc: total / problem.mass - Vector3::z() * problem.gravity,
            momentum: (momentum(state), momentum(next)),
            rotation: nalgebra::Rotation3::from_matrix(&state.rot_wb),
            phase,
            contacts: data.contacts,
            forces_w,
        });
        start += dt;
    }
    out
}

/// Torques and forces of one instant.
struct Load {
    torques: [f64; JOINTS],
    forces_w: [Vector3<f64>; FOOT_COUNT],
    residual: f64,
}

/// Inverse dynamics in contact, starting from the plan's forces.
fn load(
    robot: &Quadruped,
    q: &State,
    v: &Velocity,
    a: &Velocity,
    interval: &Interval,
) -> Result<Load, String> {
    let kinematics = robot.poses(q);
    let effort = rnea(robot, &Posture::new(robot, q), v, a);
    let (contacts, mut forces_w) = (&interval.contacts, interval.forces_w);
    let jacobians: Vec<_> = (0..FOOT_COUNT)
        .map(|leg| robot.jacobian(&kinematics, &robot.contact_frame(&kinematics, leg)))
        .collect();
    let push = |forces: &[Vector3<f64>; FOOT_COUNT]| {
        let mut total = rbd_core::Effort::ZERO;
        for (j, f) in jacobians.iter().zip(forces) {
            total = total + j.tr_mul(&Force::new(*f, Vector3::zeros()));
        }
        total
    };
    let missing = |forces: &[Vector3<f64>; FOOT_COUNT]| {
        Vector6::from((effort.base - push(forces).base).to_array())
    };
    // The least change of the forces in contact that balances the base: δ = Gᵀ(G Gᵀ)⁻¹ missing.
    let mut gram = Matrix6::identity() * 1e-9;
    let maps: Vec<nalgebra::Matrix6x3<f64>> = jacobians
        .iter()
        .map(|j| nalgebra::Matrix6x3::from_fn(|row, axis| j.base[row].linear[axis]))
        .collect();
    for (map, _) in maps.iter().zip(contacts).filter(|(_, on)| **on) {
        gram += map * map.transpose();
    }
    let solved = gram.try_inverse().ok_or("no foot in contact")? * missing(&forces_w);
    for ((f, map), _) in forces_w
        .iter_mut()
        .zip(&maps)
        .zip(contacts)
        .filter(|(_, on)| **on)
    {
        *f += map.transpose() * solved;
    }
    let residual = missing(&forces_w).amax();
    let total = push(&forces_w);
    let lost = joint_friction(Model::limits(robot), &v.joints, FRICTION_SMOOTHING);
    let torques = core::array::from_fn(|i| effort.joints[i] - total.joints[i] - lost[i]);
    Ok(Load {
        torques,
        forces_w,
        residual,
    })
}

/// Inverse dynamics of the legs in free fall.
fn swing_torques(
    robot: &Quadruped,
    q: &State,
    joints: &[f64; JOINTS],
    rates: &[f64; JOINTS],
) -> [f64; JOINTS] {
    let falling = q.base.rotation.inverse() * Vector3::from(GRAVITY);
    let a = Velocity {
        base: Motion::new(falling, Vector3::zeros()),
        joints: *rates,
    };
    let v = Velocity {
        base: Motion::ZERO,
        joints: *joints,
    };
    let effort = rnea(robot, &Posture::new(robot, q), &v, &a);
    let lost = joint_friction(Model::limits(robot), joints, FRICTION_SMOOTHING);
    core::array::from_fn(|i| effort.joints[i] - lost[i])
}

/// The node before the plan begins: at rest, with the torques that hold the robot.
///
/// # Errors
/// Feet that cannot carry the robot.
pub fn standing(task: &Task) -> Result<Node, String> {
    let q = task.start;
    let held = task.robot.holding(&q)?;
    Ok(Node {
        time: -1e-3,
        base: q.base,
        joints: q.joints,
        torques: held.torques,
        forces_w: held.forces_w,
        ..Node::ZERO
    })
}

/// Rolls the robot through an interval of the push-off by the midpoint rule: its velocity in the beginning, configuration and velocity in the
/// middle, and its velocity at the end. Legs in the air move with `swing`.
fn roll(
    robot: &Quadruped,
    interval: &Interval,
    q: &mut State,
    swing: &[f64; JOINTS],
) -> Result<(Velocity, (State, Velocity), Velocity), String> {
    let speed = |q: &State, s: f64| {
        let [pos, vel, momentum] = interval.at(s);
        let pulled = vel + (pos - robot.com(q)) / PULL;
        robot.rolling_velocity(q, &interval.contacts, &pulled, &momentum, swing)
    };
    let begin = speed(q, 0.0)?;
    let steps = 2 * (0.5 * interval.dt / STEP).ceil() as usize;
    let h = interval.dt / steps as f64;
    let mut middle = (*q, begin);
    for i in 0..steps {
        let s = i as f64 * h;
        let ahead = integrate(q, &(speed(q, s)? * (0.5 * h)));
        *q = integrate(q, &(speed(&ahead, s + 0.5 * h)? * h));
        if i + 1 == steps / 2 {
            middle = (*q, speed(q, s + h)?);
        }
    }
    Ok((begin, middle, speed(q, interval.dt)?))
}

/// The whole-body reference of a solved plan.
///
/// # Errors
/// Legs that cannot follow the plan, or a task without a flight.
pub fn build(task: &Task, plan: &SrbPlan) -> Result<Reference, String> {
    let robot = &task.robot;
    let intervals = intervals(task, &plan.stages);
    let landing_joints = task.landing_joints();
    let mut q = task.start;
    let mut swing = [0.0; JOINTS];
    let mut nodes = Vec::new();
    nodes.push(standing(task)?);
    let mut base_residual = 0.0;
    let stance = intervals
        .iter()
        .take_while(|i| i.contacts.contains(&true))
        .count();
    for interval in &intervals[..stance] {
        // Legs that have left the ground early fold towards the pre-landing posture.
        for leg in (0..FOOT_COUNT).filter(|leg| !interval.contacts[*leg]) {
            for i in 3 * leg..3 * leg + 3 {
                swing[i] = (landing_joints[i] - q.joints[i]) / 0.1;
            }
        }
        let first = q;
        let (begin, middle, end) = roll(robot, interval, &mut q, &swing)?;
        let rate = (end - begin) * (1.0 / interval.dt);
        let load = load(robot, &middle.0, &middle.1, &rate, interval)?;
        base_residual = f64::max(base_residual, load.residual);
        nodes.push(Node {
            time: interval.start,
            base: first.base,
            base_velocity: begin.base,
            joints: first.joints,
            joint_velocities: begin.joints,
            torques: load.torques,
            forces_w: load.forces_w,
        });
    }
    let flight = intervals
        .get(stance..)
        .filter(|f| !f.is_empty())
        .ok_or("the task has no flight")?;
    let takeoff = flight[0].start;
    let touchdown = end(&intervals);
    let posing = takeoff + POSING_SHARE * (touchdown - takeoff);
    fly(
        robot,
        &mut nodes,
        flight,
        &q,
        [takeoff, posing],
        landing_joints,
    );
    let bytes = container(task, &intervals, nodes, posing)?;
    Ok(Reference {
        base_residual,
        ..follow(task, robot, &bytes, Origin::Kinematics)?
    })
}

/// When the last interval ends, s.
fn end(intervals: &[Interval]) -> f64 {
    intervals.last().map_or(0.0, |last| last.start + last.dt)
}

/// The container of these nodes: the robot waiting, one per interval, and the end.
fn container(
    task: &Task,
    intervals: &[Interval],
    nodes: Vec<Node>,
    posing: f64,
) -> Result<Vec<u8>, String> {
    let mut phases: Vec<([bool; FOOT_COUNT], f64)> = Vec::new();
    let mut phase_of = vec![0];
    for interval in intervals {
        phases.resize(interval.phase + 1, (interval.contacts, 0.0));
        phases[interval.phase].1 += interval.dt;
        phase_of.push(interval.phase);
    }
    phase_of.push(phases.len().saturating_sub(1));
    let nodes: Vec<_> = phase_of.into_iter().zip(nodes).collect();
    let shares = task.limits.torque_shares.iter();
    let content = Content {
        nodes: &nodes,
        phases: &phases,
        posing,
        // Nothing is kept to here: what the motors have.
        torque_share: shares.fold(0.0, |most: f64, share| most.max(*share)),
    };
    content.write(task)
}

/// Flight nodes: the base as planned, the legs on cubics from rest at take-off to the pre-landing posture. The
/// planned take-off speed of the joints is dropped: it would drive the feet on into the ground.
fn fly(
    robot: &Quadruped,
    nodes: &mut Vec<Node>,
    flight: &[Interval],
    takeoff_q: &State,
    [takeoff, posing]: [f64; 2],
    landing_joints: &[f64; JOINTS],
) {
    let com_b =
        takeoff_q.base.rotation.inverse() * (robot.com(takeoff_q) - takeoff_q.base.translation);
    for interval in flight {
        let [pos, vel, momentum] = interval.at(0.0);
        let rotation = interval.rotation;
        let span = posing - takeoff;
        let u = ((interval.start - takeoff) / span).clamp(0.0, 1.0);
        let (shape, slope, bend) = (u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u), 6.0 - 12.0 * u);
        let bend = if u < 1.0 { bend } else { 0.0 };
        let way: [f64; JOINTS] = core::array::from_fn(|i| landing_joints[i] - takeoff_q.joints[i]);
        let joints = core::array::from_fn(|i| takeoff_q.joints[i] + shape * way[i]);
        let joint_velocities = way.map(|w| slope / span * w);
        let rates = way.map(|w| bend / (span * span) * w);
        let base = Transform::new(rotation, pos - rotation * com_b);
        let q = State { base, joints };
        nodes.push(Node {
            time: interval.start,
            base,
            base_velocity: Motion::new(rotation.inverse() * vel, robot.locked(&q, &momentum)),
            joints,
            joint_velocities,
            torques: swing_torques(robot, &q, &joint_velocities, &rates),
            forces_w: [Vector3::zeros(); FOOT_COUNT],
        });
    }
    let Some(last) = nodes.last().copied() else {
        return;
    };
    let end = flight.last().map_or(takeoff, |last| last.start + last.dt);
    let (rate, left) = (last.base_velocity, end - last.time);
    let turned = last.base.rotation * so3::exp(&(rate.angular * left));
    let fallen = last.base.rotation * rate.linear * left;
    nodes.push(Node {
        time: end,
        base: Transform::new(turned, last.base.translation + fallen),
        joints: *landing_joints,
        joint_velocities: [0.0; JOINTS],
        torques: [0.0; JOINTS],
        ..last
    });
}

/// The matrix of a heading.
#[must_use]
pub fn heading_matrix(heading: f64) -> nalgebra::Rotation3<f64> {
    so3::exp(&(Vector3::z() * heading))
}
