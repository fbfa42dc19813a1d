//! Whole-body control of robots that nobody here has tuned for, from their URDF alone: squats, pushes, slopes and reaches past the own body
//! by `wbc-qp`. Every tenth tick is written for `tests/peers/foreign.py`, which looks at it with Pinocchio.
//!
//! `foreign FOLDER`: reads `NAME URDF` lines from `FOLDER/robots.txt`, writes `FOLDER/NAME.jsonl`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a measuring program")]

mod robots;

use std::io::Write;
use std::path::Path;

use robots::{Spec, spec};

use model_import::{InertiaPolicy, Options, Robot};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    BaseKind, Configuration, Frame, JointLimits, Link, Shape, TableModel, Tangent, Transform,
};
use serde_json::{Value, json};
use wbc_qp::task::{orientation_error, position_error};
use wbc_qp::{
    Contact, Extent, Gains, Horizon, Limit, Patch, Rank, Snapshot, TorqueAnswer, TorqueQp, Yielded,
    anchored,
};

const TICK: f64 = 2e-3;
const FRICTION: f64 = 0.6;
/// Distance that the hand keeps from the body, m.
const MARGIN: f64 = 0.02;
const HORIZON: Horizon<f64> = Horizon {
    position: 0.1,
    velocity: 0.02,
    acceleration: 300.0,
};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Demand {
    /// Down and up again by 6 cm in a second.
    Squat,
    /// From a speed of 0.25 m/s to the side and 0.1 m/s forwards.
    Push,
    /// Standing with the toes 10 degrees uphill.
    Slope,
    /// A hand into the middle of the own body.
    Reach,
    /// A centre of mass that is to be held at 40 m/s² upwards, or for an arm at a motion that its torques do not give.
    Impossible,
}

struct Machine<const N: usize> {
    spec: Spec,
    robot: Robot,
    model: Box<TableModel<f64, N>>,
    limits: [JointLimits<f64>; N],
}

fn import<const N: usize>(name: &str, urdf: &Path) -> Machine<N> {
    let spec = spec(name);
    let text = std::fs::read_to_string(urdf).unwrap();
    let mut options = Options {
        base: if spec.feet.is_empty() {
            BaseKind::Fixed
        } else {
            BaseKind::Floating
        },
        inertia: InertiaPolicy::AsWritten,
        ..Options::default()
    };
    let all = Robot::from_urdf(&text, &options).unwrap();
    let names = all.joints.iter().map(|j| j.name.clone());
    options.locks = names
        .filter(|name| name.contains(spec.locked))
        .map(|name| (name, 0.0))
        .collect();
    let robot = Robot::from_urdf(&text, &options).unwrap();
    assert_eq!(robot.joints.len(), N, "{name}");
    let model = Box::new(robot.model::<f64, N>().unwrap());
    let limits = core::array::from_fn(|i| robot.joints[i].limits);
    Machine {
        spec,
        robot,
        model,
        limits,
    }
}

impl<const N: usize> Machine<N> {
    fn frame(&self, link: &str, offset: [f64; 3]) -> Frame<f64> {
        let mut frame = self.robot.frame(link).unwrap();
        let rotation = frame.rotation;
        for (o, row) in frame.offset.iter_mut().zip(rotation) {
            *o += row.iter().zip(offset).map(|(a, b)| a * b).sum::<f64>();
        }
        frame
    }

    /// At the start's joints, on ground with this rotation.
    fn start(&self, ground: Rotation3<f64>) -> Configuration<f64, N> {
        let joints = core::array::from_fn(|i| {
            let (name, limits) = (&self.robot.joints[i].name, &self.limits[i]);
            let given = self.spec.start.iter().find(|(end, _)| name.ends_with(end));
            let room = 0.02 * (limits.upper - limits.lower).min(1.0);
            let q = given.map_or(0.0, |(_, q)| *q);
            q.clamp(limits.lower + room, limits.upper - room)
        });
        match self.spec.feet.first() {
            Some(foot) if self.spec.sole.1.is_some() => {
                let sole = self.frame(foot, self.spec.sole.0);
                let place = Transform::new(ground, Vector3::zeros());
                anchored(&*self.model, &joints, &[0.0; N], &sole, &place).0
            }
            foot => Configuration {
                base: foot.map_or(Transform::IDENTITY, |_| {
                    Transform::new(ground, Vector3::zeros())
                }),
                joints,
            },
        }
    }

    fn contacts(&self, normal_w: Vector3<f64>) -> Vec<Contact<f64>> {
        let (place, half) = self.spec.sole;
        let feet = self.spec.feet.iter();
        feet.map(|foot| {
            let contact = match half {
                Some([x, y]) => {
                    let frame = self.frame(foot, place);
                    let mut c = Contact::ball(&frame, 0.0, normal_w, FRICTION, 3000.0);
                    c.shape = Patch::Rectangle {
                        x: [-x, x],
                        y: [-y, y],
                    };
                    c.yaw = FRICTION * 0.5 * (x + y);
                    c
                }
                None => {
                    let frame = self.frame(foot, [0.0; 3]);
                    Contact::ball(&frame, place[2], normal_w, FRICTION, 3000.0)
                }
            };
            contact.inscribed()
        })
        .collect()
    }

    /// The hand as a ball, and what it must not meet.
    fn shapes(&self) -> Option<[Shape<f64>; 2]> {
        let (hand, radius) = self.spec.hand;
        let (body, from, to, thick) = self.spec.body;
        let at = |link: &str, place| {
            let frame = self.frame(link, place);
            (frame.link, frame.offset)
        };
        if hand.is_empty() {
            return None;
        }
        let ((link, centre), (trunk, low), (_, high)) =
            (at(hand, [0.0; 3]), at(body, from), at(body, to));
        let shape = |link: Link, from, to, radius| Shape {
            link,
            from,
            to,
            radius,
            owner: 0,
        };
        Some([
            shape(link, centre, centre, radius),
            shape(trunk, low, high, thick),
        ])
    }
}

const STIFF: Gains<f64> = Gains {
    stiffness: 60.0,
    damping: 15.0,
};

/// Contacts and their wrenches as lines of JSON.
fn contact_lines<const N: usize>(
    machine: &Machine<N>,
    contacts: &[Contact<f64>],
    s: &Snapshot<f64, N>,
    forces_c: &[f64],
    normal: Vector3<f64>,
) -> Vec<Value> {
    let mut first = 0;
    contacts
        .iter()
        .zip(machine.spec.feet)
        .map(|(c, link)| {
            let mut f = [0.0; 6];
            let size = c.size();
            f[..size].copy_from_slice(&forces_c[first..first + size]);
            first += size;
            let (place, wrench) = c.wrench_w(s, f);
            json!({"link": link, "offset": if size == 6 { machine.spec.sole.0 } else { [0.0; 3] },
                        "radius": if size == 6 { 0.0 } else { machine.spec.sole.0[2] },
                        "half": machine.spec.sole.1, "normal": normal.as_slice(),
                        "place": place.as_slice(), "force": wrench.linear.as_slice(),
                        "moment": wrench.angular.as_slice()})
        })
        .collect()
}

/// Tasks of a robot on its feet: its centre of mass above their middle, its trunk as it was.
fn stand<const N: usize, const K: usize, const V: usize, const M: usize>(
    qp: &mut TorqueQp<f64, N, K, V, M>,
    s: &Snapshot<f64, N>,
    machine: &Machine<N>,
    demand: Demand,
    (t, home): (f64, [f64; 3]),
    (upright, rotation): (&Rotation3<f64>, &Rotation3<f64>),
) {
    let depth = if demand == Demand::Squat { 0.03 } else { 0.0 };
    let mut wanted = Vector3::from(home);
    wanted.z -= depth * (1.0 - so3::math::cos(core::f64::consts::TAU * t));
    let error = position_error(&wanted, &s.com_w());
    let com = s.com();
    let target = com.acceleration([0.0; 3], [0.0; 3], error, STIFF);
    if demand == Demand::Impossible {
        qp.hold(&com, &[0.0, 0.0, 40.0]).unwrap();
    }
    qp.minimise(&com, &target, &[1e3; 3]);
    let trunk = s.frame_orientation(&*machine.model, &Frame::IDENTITY);
    let error = orientation_error(upright, rotation);
    let target = trunk.acceleration([0.0; 3], [0.0; 3], error, STIFF);
    qp.minimise(&trunk, &target, &[1e2; 3]);
}

/// The hand's task, and the row that keeps it off the body; returns their distance.
fn reach<const N: usize, const K: usize, const V: usize, const M: usize>(
    qp: &mut TorqueQp<f64, N, K, V, M>,
    s: &Snapshot<f64, N>,
    machine: &Machine<N>,
    demand: Demand,
    [ball, body]: [Shape<f64>; 2],
    goal: Vector3<f64>,
) -> f64 {
    let model = &*machine.model;
    let frame = Frame {
        link: ball.link,
        offset: ball.from,
        ..Frame::IDENTITY
    };
    let mut distance = f64::INFINITY;
    if demand == Demand::Reach {
        let task = s.frame_position(model, &frame);
        let error = position_error(&goal, &s.pose(&frame).translation);
        let target = task.acceleration([0.0; 3], [0.0; 3], error, STIFF);
        qp.minimise(&task, &target, &[1e2; 3]);
    }
    if demand == Demand::Impossible && machine.spec.feet.is_empty() {
        let task = s.frame_position(model, &frame);
        qp.hold(&task, &[0.0, 0.0, 2000.0]).unwrap();
    } else {
        distance = s.clearance(&ball, &body).distance;
        let row = s.distance(model, &ball, &body);
        let floor = HORIZON.least_acceleration(distance - MARGIN, row.rate[0]);
        qp.constrain(&row, &[floor], &[f64::INFINITY], Rank::Limit)
            .unwrap();
    }
    distance
}

impl Demand {
    /// Attitude of the ground.
    fn ground(self) -> Rotation3<f64> {
        let angle = if self == Self::Slope { -10.0_f64 } else { 0.0 };
        Rotation3::from_axis_angle(&Vector3::y_axis(), angle.to_radians())
    }
}

/// Middle of a capsule, in the world.
fn middle_of<const N: usize>(s: &Snapshot<f64, N>, body: &Shape<f64>) -> Vector3<f64> {
    let ends = [body.from, body.to].map(|offset| Frame {
        link: body.link,
        offset,
        ..Frame::IDENTITY
    });
    let [low, high] = ends.map(|end| s.pose(&end).translation);
    (low + high) * 0.5
}

/// State and answer as a line of JSON.
fn tick_line<const N: usize, const K: usize>(
    (q, v): (&Configuration<f64, N>, &Tangent<f64, N>),
    answer: &TorqueAnswer<f64, N, K>,
) -> Value {
    json!({
        "base": q.base.translation.as_slice(),
        "quaternion": so3::quat::to_xyzw(&so3::quat::from_rotation(&q.base.rotation)),
        "joints": &q.joints[..],
        "base_velocity": v.base.to_array(),
        "joint_velocities": &v.joints[..],
        "base_acceleration": answer.acceleration.base.to_array(),
        "joint_accelerations": &answer.acceleration.joints[..],
        "torques": &answer.torques[..],
        "yielded": format!("{:?}", answer.yielded),
    })
}

/// Runs one demand for a second; returns lines of JSON.
fn run<const N: usize, const K: usize, const V: usize, const M: usize>(
    machine: &Machine<N>,
    demand: Demand,
    out: &mut impl Write,
) {
    let ground = demand.ground();
    let model = &*machine.model;
    let contacts = machine.contacts(ground * Vector3::z());
    let mut q = machine.start(ground);
    let mut v = Tangent::<f64, N>::ZERO;
    if demand == Demand::Push {
        v.base.linear = Vector3::new(0.1, 0.25, 0.0);
    }
    let shapes = machine.shapes();
    let mut s = Box::new(Snapshot::<f64, N>::ZERO);
    s.update(model, &q, &Tangent::ZERO);
    let (home, upright, joints) = (s.com_w(), q.base.rotation, q.joints);
    let feet = contacts.iter().map(|c| s.pose(&c.frame).translation);
    let middle = feet.sum::<Vector3<f64>>() / contacts.len().max(1) as f64;
    let goal = shapes.map(|[_, body]| middle_of(&s, &body));
    let mut qp = Box::new(TorqueQp::<f64, N, K, V, M>::new());
    let ranges = core::array::from_fn(|i| [-machine.limits[i].effort, machine.limits[i].effort]);
    let (mut yielded, mut near, mut named) = (0, false, false);
    for k in 0..500 {
        let t = f64::from(k) * TICK;
        s.update(model, &q, &v);
        qp.begin(model, &s, &contacts, &[0.0; N]).unwrap();
        if !contacts.is_empty() {
            stand(
                &mut qp,
                &s,
                machine,
                demand,
                (t, [middle.x, middle.y, home.z]),
                (&upright, &q.base.rotation),
            );
        }
        let posture: [f64; N] =
            core::array::from_fn(|i| 20.0 * (joints[i] - q.joints[i]) - 9.0 * v.joints[i]);
        qp.minimise_joints(&posture, &[1.0; N]);
        qp.minimise_forces(&[0.0; K], &[1e-4; K]);
        qp.limit_joints(&s, &machine.limits, &HORIZON);
        qp.limit_torques(&ranges).unwrap();
        let distance = match (shapes, goal) {
            (Some(shapes), Some(goal)) => reach(&mut qp, &s, machine, demand, shapes, goal),
            _ => f64::INFINITY,
        };
        let answer = qp.solve().unwrap();
        yielded += u32::from(answer.yielded != Yielded::Nothing);
        let report: Vec<_> = qp.report(&answer, 1e-6).collect();
        named |= report
            .iter()
            .any(|line| matches!(line.extent, Extent::Missed(_)));
        near |= report
            .iter()
            .any(|l| l.limit == Limit::Row(0) && matches!(l.extent, Extent::Held(_)));
        if k % 10 == 0 {
            let forces = contact_lines(
                machine,
                &contacts,
                &s,
                &answer.forces,
                ground * Vector3::z(),
            );
            let mut line = tick_line((&q, &v), &answer);
            line["demand"] = json!(format!("{demand:?}"));
            line["tick"] = json!(k);
            line["contacts"] = json!(forces);
            line["distance"] = json!(distance.is_finite().then_some(distance));
            line["com_error"] = json!((s.com_w() - middle).as_slice());
            line["damping"] = json!(qp.contact_damping);
            writeln!(out, "{line}").unwrap();
        }
        // Half a tick's acceleration is not forgotten: positions follow the answer to second order.
        let mut step = v * TICK;
        step = step + answer.acceleration * (0.5 * TICK * TICK);
        q = rbd_core::integrate(&q, &step);
        v = v + answer.acceleration * TICK;
    }
    println!("  {demand:?}: {yielded} of 500 ticks yielded, named {named}, at the body {near}");
    assert_eq!(
        yielded > 0 && named,
        demand == Demand::Impossible,
        "{demand:?}"
    );
    assert!(near || demand != Demand::Reach, "nothing was in the way");
}

fn robot<const N: usize, const K: usize, const V: usize, const M: usize>(
    name: &str,
    urdf: &Path,
    folder: &Path,
) {
    let machine = import::<N>(name, urdf);
    println!("{name}: {N} joints, {:.3} kg", machine.robot.mass());
    let file = std::fs::File::create(folder.join(format!("{name}.jsonl"))).unwrap();
    let mut out = std::io::BufWriter::new(file);
    let limits: Vec<[f64; 4]> = machine
        .limits
        .iter()
        .map(|l| [l.lower, l.upper, l.speed, l.effort])
        .collect();
    let names: Vec<&str> = machine
        .robot
        .joints
        .iter()
        .map(|j| j.name.as_str())
        .collect();
    let (hand, radius) = machine.spec.hand;
    let (body, from, to, thick) = machine.spec.body;
    let head = json!({"name": name, "joints": names, "locked": machine.robot.locked, "limits": limits, "friction": FRICTION,
        "margin": MARGIN, "tick": TICK, "hand": hand, "hand_radius": radius, "body": body, "from": from, "to": to, "thick": thick});
    writeln!(out, "{head}").unwrap();
    let standing = [Demand::Squat, Demand::Push, Demand::Slope];
    for demand in standing.into_iter().filter(|_| K > 0) {
        run::<N, K, V, M>(&machine, demand, &mut out);
    }
    for demand in [Demand::Reach]
        .into_iter()
        .filter(|_| machine.shapes().is_some())
    {
        run::<N, K, V, M>(&machine, demand, &mut out);
    }
    run::<N, K, V, M>(&machine, Demand::Impossible, &mut out);
}

fn main() {
    let folder = std::env::args().nth(1).unwrap();
    let work = move || {
        let folder = Path::new(&folder);
        let list = std::fs::read_to_string(folder.join("robots.txt")).unwrap();
        for line in list.lines() {
            let (name, urdf) = line.split_once(' ').unwrap();
            let urdf = Path::new(urdf);
            match name {
                "talos" => robot::<32, 12, 44, 70>(name, urdf, folder),
                "g1" => robot::<29, 12, 41, 66>(name, urdf, folder),
                "go2" => robot::<12, 12, 24, 45>(name, urdf, folder),
                "panda" => robot::<7, 0, 7, 11>(name, urdf, folder),
                "tiago" => robot::<10, 0, 10, 14>(name, urdf, folder),
                _ => robot::<6, 0, 6, 10>(name, urdf, folder),
            }
        }
    };
    let thread = std::thread::Builder::new().stack_size(1 << 27);
    thread.spawn(work).unwrap().join().unwrap();
}
