//! Times one controller tick (dynamics, tasks, program) on the ticks of a push-off of iCub and of A1 in the contact simulator, and
//! writes states and programs for other libraries (`tests/peers/wbc.py`), iCub's also of the velocity controller on the same states.
//!
//! usage: ticks OUT_DIR
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "a measuring program"
)]

use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
use core::fmt::Write as _;
use dense_qp::Problem;
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Frame, JointLimits, Motor, Posture, Tangent, Transform};
use rbd_core::{Kinematics, Tree, forward_kinematics, joint_friction};
use std::path::Path;
use std::time::Instant;
use wbc_qp::jump::{ComReference, TorqueJump, TorqueJumpSettings, VelocityJump};
use wbc_qp::task::{orientation_error, position_error};
use wbc_qp::{Contact, Gains, Snapshot, TorqueAnswer, TorqueQp, Yielded};

const REPEAT: usize = 7;
/// Standing before the push, s.
const HOLD: f64 = 0.2;

/// A controller under measurement.
trait Controller<const N: usize, const K: usize, const V: usize, const M: usize>: Clone {
    fn tick(
        &mut self,
        q: &Configuration<f64, N>,
        v: &Tangent<f64, N>,
        wanted: &ComReference<f64>,
    ) -> TorqueAnswer<f64, N, K>;
    fn program(&self) -> &TorqueQp<f64, N, K, V, M>;
}

/// Paper B's torque controller.
#[derive(Clone)]
struct Humanoid(Box<(Snapshot<f64, 23>, TorqueJump<f64, 23, 12, 35, 55>)>);

impl Controller<23, 12, 35, 55> for Humanoid {
    fn tick(
        &mut self,
        q: &Configuration<f64, 23>,
        v: &Tangent<f64, 23>,
        wanted: &ComReference<f64>,
    ) -> TorqueAnswer<f64, 23, 12> {
        let (s, jump) = &mut *self.0;
        s.update(&icub_model::Icub23, q, v);
        let contacts = icub_model::SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0));
        let joints = (&icub_model::LIMITS, &icub_model::MOTORS);
        let tick = jump.tick(&icub_model::Icub23, s, &contacts, joints, wanted, 1e-3);
        tick.unwrap().answer
    }
    fn program(&self) -> &TorqueQp<f64, 23, 12, 35, 55> {
        self.0.1.program()
    }
}

/// The same tasks on four feet, with the trunk's orientation in the angular momentum's place.
#[derive(Clone)]
struct Quadruped(Box<(Snapshot<f64, 12>, TorqueQp<f64, 12, 12, 24, 40>)>);

impl Controller<12, 12, 24, 40> for Quadruped {
    fn tick(
        &mut self,
        q: &Configuration<f64, 12>,
        v: &Tangent<f64, 12>,
        wanted: &ComReference<f64>,
    ) -> TorqueAnswer<f64, 12, 12> {
        let (s, qp) = &mut *self.0;
        let model = &a1_model::A1;
        s.update(model, q, v);
        let contacts = a1_model::FEET.map(|foot| Contact::new(&foot, 0.5, 300.0));
        let friction = joint_friction(&a1_model::a1::LIMITS, &v.joints, 0.1);
        qp.begin(model, s, &contacts, &friction).unwrap();
        let gains = Gains {
            stiffness: 100.0,
            damping: 20.0,
        };
        let com = s.com();
        let target = com.acceleration(
            wanted.acceleration_w.into(),
            wanted.velocity_w.into(),
            position_error(&wanted.position_w, &s.com_w()),
            gains,
        );
        qp.minimise(&com, &target, &[1e3; 3]);
        let trunk = s.frame_orientation(model, &Frame::IDENTITY);
        let error = orientation_error(&Rotation3::identity(), &q.base.rotation);
        let target = trunk.acceleration([0.0; 3], [0.0; 3], error, gains);
        qp.minimise(&trunk, &target, &[1e3; 3]);
        qp.minimise_joints(&[0.0; 12], &[1e-2; 12]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        qp.limit_torques(&a1_model::MOTORS.map(|m| [-m.torque, m.torque]))
            .unwrap();
        qp.solve().unwrap()
    }
    fn program(&self) -> &TorqueQp<f64, 12, 12, 24, 40> {
        &self.0.1
    }
}

/// A robot in the simulator.
struct Robot<'a, P, const N: usize> {
    name: &'a str,
    plant: P,
    start: Configuration<f64, N>,
    /// Centre of mass at the start.
    home: Vector3<f64>,
    /// Speed at take-off, m/s, and duration of the push, s.
    push: [f64; 2],
    limits: &'a [JointLimits<f64>; N],
    motors: &'a [Motor<f64>; N],
}

/// Runs hold and push-off; times every tick; writes `NAME.ticks` (states) and `NAME.qps` (programs). `other` sees every state as well.
fn measure<P, C, const N: usize, const K: usize, const V: usize, const M: usize, const S: usize>(
    mut robot: Robot<'_, P, N>,
    mut controller: C,
    mut other: impl FnMut(&Configuration<f64, N>, &Tangent<f64, N>, &ComReference<f64>),
    out: &Path,
) where
    P: Simulator<f64, N, S>,
    P::Error: core::fmt::Debug,
    C: Controller<N, K, V, M>,
{
    robot.plant.reset(&robot.start, &Tangent::ZERO);
    let [speed, push] = robot.push;
    let mut states = String::new();
    let mut times = Vec::new();
    let (mut most, mut yielded) = (0, 0);
    let count = ((HOLD + push) * 1e3) as usize;
    let mut programs = Programs::new(V, M, count);
    for k in 0..count {
        let x = ((k as f64 * 1e-3 - HOLD) / push).max(0.0);
        let up = Vector3::z();
        let wanted = ComReference {
            position_w: robot.home + up * (speed * push * x * x * x / 3.0),
            velocity_w: up * (speed * x * x),
            acceleration_w: up * (2.0 * speed / push * x),
        };
        let (q, v) = (*robot.plant.configuration(), *robot.plant.velocity());
        let before = controller.clone();
        let mut best = f64::INFINITY;
        let mut answer = None;
        for _ in 0..REPEAT {
            controller = before.clone();
            let begin = Instant::now();
            answer = Some(controller.tick(&q, &v, &wanted));
            best = best.min(begin.elapsed().as_secs_f64());
        }
        let answer = answer.unwrap();
        times.push(best);
        most = most.max(answer.iterations);
        yielded += usize::from(answer.yielded != Yielded::Nothing);
        programs.push(&controller.program().problem());
        other(&q, &v, &wanted);
        for x in numbers(&q, &v, &wanted) {
            write!(states, "{x:.17} ").unwrap();
        }
        states.push('\n');
        for _ in 0..10 {
            robot.plant.step(&answer.torques).unwrap();
        }
    }
    write_states(&robot, count, &states, out);
    programs.write(out, robot.name);
    times.sort_by(f64::total_cmp);
    let [tick, worst] = [count / 2, count - 1].map(|k| times[k] * 1e6);
    println!(
        "{} {tick:.3} {worst:.3} {most} {yielded} {count}",
        robot.name
    );
}

/// Writes `NAME.ticks`: sizes, limits, posture at the start, and the states.
fn write_states<P, const N: usize>(
    robot: &Robot<'_, P, N>,
    count: usize,
    states: &str,
    out: &Path,
) {
    let mut head = format!("{count} {N}\n");
    let limits = robot.limits;
    let columns: [[f64; N]; 5] = [
        limits.map(|l| l.lower),
        limits.map(|l| l.upper),
        limits.map(|l| l.speed),
        robot.motors.map(|m| m.torque),
        robot.start.joints,
    ];
    for x in columns.iter().flatten() {
        write!(head, "{x:.17} ").unwrap();
    }
    let path = out.join(format!("{}.ticks", robot.name));
    std::fs::write(path, format!("{head}\n{states}")).unwrap();
}

/// x y z, quaternion x y z w, joints; velocity; centre of mass wanted.
fn numbers<const N: usize>(
    q: &Configuration<f64, N>,
    v: &Tangent<f64, N>,
    wanted: &ComReference<f64>,
) -> Vec<f64> {
    let turn = so3::quat::from_rotation(&q.base.rotation);
    let mut out: Vec<f64> = q.base.translation.iter().copied().collect();
    out.extend(turn.coords.iter());
    out.extend(q.joints);
    out.extend(v.base.to_array());
    out.extend(v.joints);
    for x in [wanted.position_w, wanted.velocity_w, wanted.acceleration_w] {
        out.extend(x.iter());
    }
    out
}

/// Programs one after the other, as the example `recorded` of `dense-qp` reads them.
struct Programs(Vec<u8>);

impl Programs {
    fn new(variables: usize, rows: usize, count: usize) -> Self {
        let mut programs = Self(Vec::new());
        programs.put([variables, rows, count].map(|x| x as f64).iter());
        programs
    }

    fn put<'a>(&mut self, numbers: impl Iterator<Item = &'a f64>) {
        self.0.extend(numbers.flat_map(|x| x.to_le_bytes()));
    }

    /// H, g, A, l, u and the bounds.
    fn push<const V: usize, const M: usize>(&mut self, p: &Problem<'_, f64, V, M>) {
        self.put(p.hessian.iter().flatten().chain(p.gradient));
        self.put(p.rows.iter().flatten());
        self.put(p.row_lower.iter().chain(p.row_upper));
        let bounds = [p.lower.unwrap(), p.upper.unwrap()];
        self.put(bounds.into_iter().flatten());
    }

    fn write(&self, out: &Path, name: &str) {
        std::fs::write(out.join(name).with_extension("qps"), &self.0).unwrap();
    }
}

/// The base such that the foot is `height` above the floor; a sole (height 0) lies flat.
fn on_the_floor<R: Tree<f64, N>, const N: usize>(
    model: &R,
    joints: [f64; N],
    foot: &Frame<f64>,
    height: f64,
) -> Configuration<f64, N> {
    let mut q = Configuration {
        base: Transform::IDENTITY,
        joints,
    };
    let pose = |q: &Configuration<f64, N>| {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(model, &Posture::new(model, q), &mut kinematics);
        kinematics.frame(foot)
    };
    if height == 0.0 {
        q.base.rotation = pose(&q).rotation.inverse();
    }
    q.base.translation = -pose(&q).translation + Vector3::z() * height;
    q
}

fn icub(out: &Path) {
    use icub_model::{Icub23, LIMITS, MOTORS, SOLES};
    let mut joints = [0.0; 23];
    for leg in [0, 6] {
        (joints[leg], joints[leg + 3], joints[leg + 4]) = (1.496, -2.013, -0.817);
    }
    joints[icub_model::gazebo::joint::TORSO_PITCH] = 0.2;
    for arm in [15, 19] {
        (joints[arm], joints[arm + 1], joints[arm + 3]) = (-0.5, 0.4, 0.8);
    }
    let start = on_the_floor(&Icub23, joints, &SOLES[0].frame, 0.0);
    let corners = [0, 1].map(|i| Shape::corners(&SOLES[i], 0.005, 4 * i).unwrap());
    let spheres: [Shape<f64>; 8] = core::array::from_fn(|i| corners[i / 4][i % 4]);
    let settings = Settings::new(&LIMITS, &MOTORS);
    let mut s = Snapshot::ZERO;
    s.update(&Icub23, &start, &Tangent::ZERO);
    let robot = Robot {
        name: "icub23",
        plant: NativeSimulator::<f64, Icub23, 23, 8, 8>::new(
            Icub23,
            spheres,
            Terrain::FLAT,
            settings,
        ),
        start,
        home: s.com_w(),
        push: [0.89, 0.36],
        limits: &LIMITS,
        motors: &MOTORS,
    };
    let jump = TorqueJump::new(
        TorqueJumpSettings {
            posture_weight: [1.0; 23],
            ..icub_model::profile::TORQUE
        },
        joints,
    );
    let count = ((HOLD + robot.push[1]) * 1e3) as usize;
    let mut by_velocity = Programs::new(29, 12, count);
    let settings = icub_model::profile::VELOCITY;
    let mut velocity = Box::new(VelocityJump::<f64, 23, 29, 12>::new(settings, joints));
    let mut state = s;
    let other = |q: &_, v: &_, wanted: &_| {
        state.update(&Icub23, q, v);
        let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0));
        let tick = velocity.tick(&Icub23, &state, &contacts, &LIMITS, wanted, 1e-3);
        tick.unwrap();
        by_velocity.push(&velocity.program().problem());
    };
    measure(robot, Humanoid(Box::new((s, jump))), other, out);
    by_velocity.write(out, "icub23-velocity");
}

fn a1(out: &Path) {
    use a1_model::{A1, FEET, FOOT_RADIUS, MOTORS, a1::LIMITS};
    let joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
    let start = on_the_floor(&A1, joints, &FEET[0].frame, FOOT_RADIUS);
    let spheres = core::array::from_fn(|i| Shape::of(&FEET[i], i).unwrap());
    let settings = Settings::new(&LIMITS, &MOTORS);
    let mut s = Snapshot::ZERO;
    s.update(&A1, &start, &Tangent::ZERO);
    let robot = Robot {
        name: "a1",
        plant: NativeSimulator::<f64, A1, 12, 4, 4>::new(A1, spheres, Terrain::FLAT, settings),
        start,
        home: s.com_w(),
        push: [1.0, 0.2],
        limits: &LIMITS,
        motors: &MOTORS,
    };
    let controller = Quadruped(Box::new((s, TorqueQp::new())));
    measure(robot, controller, |_, _, _| {}, out);
}

fn main() {
    let Some(out) = std::env::args().nth(1) else {
        eprintln!("usage: ticks OUT_DIR");
        std::process::exit(2)
    };
    icub(Path::new(&out));
    a1(Path::new(&out));
}
