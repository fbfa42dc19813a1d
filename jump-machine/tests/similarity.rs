//! Dynamic similarity: a robot of four times the length and 64 times the mass does what the small one does, in twice the time.
//!
//! Its times and speeds are doubled, its torques 256 times as large, all powers of two: what scales as it should is equal to the bit, and
//! a length, force or time that somebody forgets to scale shows.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{JointCommand, Measurement, Node, Phase, Plan, Torques};
use jump_machine::Workspace;
use jump_machine::{Jump, Machine, Observation, Settings, Tick};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    BaseBody, BaseKind, Body, Build, Frame, Motion, Motor, TableModel, Transform, Tree,
};

const TAKEOFF: f64 = 0.2;
const POSING: f64 = 0.5;
const TOUCHDOWN: f64 = 0.6;
const GRAVITY: f64 = 9.81;

/// How many times as large as A1 a robot is.
#[derive(Clone, Copy)]
struct Size {
    length: f64,
    mass: f64,
    time: f64,
}

const SMALL: Size = Size {
    length: 1.0,
    mass: 1.0,
    time: 1.0,
};
const LARGE: Size = Size {
    length: 4.0,
    mass: 64.0,
    time: 2.0,
};

impl Size {
    const fn speed(self) -> f64 {
        self.length / self.time
    }

    const fn torque(self) -> f64 {
        self.mass * self.length
    }

    const fn inertia(self) -> f64 {
        self.mass * self.length * self.length
    }

    fn build(self) -> Build<f64> {
        Build {
            mass: BUILD.mass * self.mass,
            leg_length: BUILD.leg_length * self.length,
            inertia_b: BUILD.inertia_b.map(|x| x * self.inertia()),
        }
    }

    fn model(self) -> TableModel<f64, 12> {
        let moment = |first: [f64; 3]| first.map(|x| x * self.mass * self.length);
        let base: &BaseBody<f64> = A1Geared.base();
        let base = BaseBody {
            mass: base.mass * self.mass,
            first: moment(base.first),
            second: base.second.map(|x| x * self.inertia()),
        };
        let bodies: &[Body<f64>; 12] = &a1_model::geared::BODIES;
        let bodies = bodies.map(|body| Body {
            offset: body.offset.map(|x| x * self.length),
            mass: body.mass * self.mass,
            first: moment(body.first),
            second: body.second.map(|x| x * self.inertia()),
            rotor_inertia: body.rotor_inertia * self.inertia(),
            ..body
        });
        TableModel::with_any_inertia(BaseKind::Floating, base, &bodies).unwrap()
    }

    /// Gains from the build alone. Computers, links and drives are as slow as the robot here, so that nothing is left that is not
    /// similar.
    fn settings(self) -> Settings<f64, 12, 4> {
        let feet = FEET.map(|foot| Frame {
            offset: foot.frame.offset.map(|x| x * self.length),
            ..foot.frame
        });
        let motors = MOTORS.map(|motor| Motor {
            torque: motor.torque * self.torque(),
            corner_speed: motor.corner_speed / self.time,
            no_load_speed: motor.no_load_speed / self.time,
            rotor_inertia: motor.rotor_inertia * self.inertia(),
            ..motor
        });
        let mut s = Settings::new(&self.build(), feet, motors, crouch());
        for time in [
            &mut s.period,
            &mut s.max_age,
            &mut s.max_silence,
            &mut s.lookahead,
            &mut s.unloading.letting_go,
            &mut s.detector.confirm,
            &mut s.detector.patience,
            &mut s.detector.observer.time_constant,
        ] {
            *time *= self.time;
        }
        s.slew /= self.time;
        s
    }

    fn motion(self, small: &Motion<f64>) -> Motion<f64> {
        Motion::new(small.linear * self.speed(), small.angular / self.time)
    }

    fn pose(self, small: &Transform<f64>) -> Transform<f64> {
        Transform::new(small.rotation, small.translation * self.length)
    }

    fn node(self, small: &Node<f64, 12, 4>) -> Node<f64, 12, 4> {
        Node {
            time: small.time * self.time,
            base: self.pose(&small.base),
            base_velocity: self.motion(&small.base_velocity),
            joints: small.joints,
            joint_velocities: small.joint_velocities.map(|x| x / self.time),
            torques: small.torques.map(|x| x * self.torque()),
            forces_w: small.forces_w.map(|f| f * self.mass),
        }
    }

    fn inputs(self, small: &Observation<f64, 12, 4>) -> Observation<f64, 12, 4> {
        let measured = &small.measured;
        Observation {
            measured: Measurement {
                base: self.pose(&measured.base),
                base_velocity: self.motion(&measured.base_velocity),
                joints: measured.joints,
                joint_velocities: measured.joint_velocities.map(|x| x / self.time),
                foot_forces: measured.foot_forces.map(|x| x * self.mass),
                age: measured.age * self.time,
            },
            joint_torques: small.joint_torques.map(|x| x * self.torque()),
        }
    }

    /// A command as the small robot would have it.
    fn command(self, large: &JointCommand<f64, 12>) -> JointCommand<f64, 12> {
        let mut small = *large;
        small.velocity = small.velocity.map(|x| x * self.time);
        small.feed_forward = small.feed_forward.map(|x| x / self.torque());
        for gains in &mut small.gains {
            gains.stiffness /= self.torque();
            gains.damping /= self.torque() * self.time;
        }
        small
    }
}

fn crouch() -> [f64; 12] {
    core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3])
}

/// The base of a jump that leans and turns: pose, velocity, and whether it is in the air.
fn base(t: f64) -> (Transform<f64>, Motion<f64>, bool) {
    let pushed = t.clamp(0.0, TAKEOFF);
    let flown = (t - TAKEOFF).clamp(0.0, TOUCHDOWN - TAKEOFF);
    let landed = (t - TOUCHDOWN).max(0.0);
    // 10 m/s² up, a flight of 0.4 s, and 0.1 s in which the legs take up what is left.
    let rising = 10.0 * pushed - GRAVITY * flown;
    let left = (1.0 - landed / 0.1).max(0.0);
    let height = 0.25 + 5.0 * pushed * pushed + (2.0 - 0.5 * GRAVITY * flown) * flown;
    let fallen = rising * 0.05 * (1.0 - left * left);
    let turned = 4.0 * flown + 0.3 * pushed;
    let rate = match (flown > 0.0, landed > 0.0) {
        (true, false) => 4.0,
        _ => 0.3 * left,
    };
    let rotation = so3::exp(&Vector3::new(0.05 * pushed, 0.02, turned));
    let vel_w = Vector3::new(0.3 * left, 0.05 * left, rising * left);
    let pose = Transform::new(rotation, Vector3::new(0.3 * t * left, 0.0, height + fallen));
    let velocity = Motion::new(rotation.inverse() * vel_w, Vector3::z() * rate);
    (pose, velocity, flown > 0.0 && landed == 0.0)
}

/// What A1 measures at millisecond `k`: it flies higher and farther than planned and leans, falls faster before the ground, which is nearer than it
/// seemed and tears its joints along for 5 ms, one foot sensor is dead after the landing and another chatters.
fn heard(k: i32) -> Observation<f64, 12, 4> {
    let t = f64::from(k) * 1e-3;
    let (mut base, mut base_velocity, flies) = base(t * 1.02);
    if flies {
        let before = TOUCHDOWN - t;
        let gust = 40.0 * (0.06 - before).clamp(0.0, 0.024);
        let higher = if before > 0.036 { 0.1 } else { -0.05 };
        base.translation.z += higher;
        base_velocity.linear += base.rotation.inverse() * Vector3::new(1.2, 0.0, 0.3 - gust);
    }
    if t < TOUCHDOWN {
        base_velocity.angular += Vector3::new(0.1, -0.2, 0.05);
    }
    let landed = !flies && t > TAKEOFF;
    let leaves = flies && t < TAKEOFF + 0.08;
    let load = |foot: usize| match (flies, landed, foot) {
        // Two feet are late to leave the ground.
        (true, _, 0 | 1) if leaves => 9.0 - 4.0 * foot as f64,
        (true, ..) | (_, true, 2) => 0.0,
        (_, true, 3) if k < 630 || k % 40 < 10 => 0.0,
        // It settles until the start.
        _ => 30.0 + 2.0 * foot as f64 + 4.0 * t.min(0.0),
    };
    let share = if flies {
        0.0
    } else if t < 0.0 {
        // It holds a tenth harder than planned, and settles.
        1.1 + 0.4 * t
    } else {
        0.5 + 0.4 * so3::math::sin(15.0 * t)
    };
    let wave = |i: usize| 0.01 * so3::math::sin(20.0 * t + i as f64);
    let q = crouch();
    let torn = if landed && t < TOUCHDOWN + 0.005 {
        95.0
    } else {
        1.0
    };
    Observation {
        measured: Measurement {
            base,
            base_velocity,
            joints: core::array::from_fn(|i| q[i] + wave(i)),
            joint_velocities: core::array::from_fn(|i| torn * 20.0 * wave(i + 3)),
            foot_forces: core::array::from_fn(load),
            age: 0.002,
        },
        joint_torques: core::array::from_fn(|i| share * [0.5, 1.0, 6.0][i % 3]),
    }
}

/// The plan of the small robot: four feet push, then two.
fn nodes() -> Vec<Node<f64, 12, 4>> {
    let node = |k: i32| {
        let time = 0.01 * f64::from(k);
        let (base, base_velocity, flies) = base(time);
        let push = |foot: usize| match (flies, time > 0.15 && foot < 2) {
            (false, false) => Vector3::new(5.0, 0.0, 60.0 + 3.0 * foot as f64),
            _ => Vector3::zeros(),
        };
        Node {
            time,
            base,
            base_velocity,
            joints: crouch(),
            joint_velocities: core::array::from_fn(|i| 0.1 * i as f64),
            torques: core::array::from_fn(|i| [0.5, 2.0, 6.0][i % 3]),
            forces_w: core::array::from_fn(push),
        }
    };
    (-1..=60).map(node).collect()
}

/// What every millisecond of the small robot's jump came to, in its units.
fn fly(
    size: Size,
    settings: Settings<f64, 12, 4>,
) -> Vec<(Tick, JointCommand<f64, 12>, [f64; 12])> {
    let nodes: Vec<_> = nodes().iter().map(|node| size.node(node)).collect();
    let [takeoff, posing, touchdown] = [TAKEOFF, POSING, TOUCHDOWN].map(|t| t * size.time);
    let jump = Jump {
        plan: Plan::new(&nodes, takeoff, posing, touchdown, Torques::Hold).unwrap(),
        rot_goal: Rotation3::identity(),
        landing_joints: crouch(),
    };
    let model = size.model();
    let mut workspace = Workspace::new();
    let mut machine = Machine::new(&model, settings, &mut workspace);
    machine.arm(jump, 0.0).unwrap();
    let mut ticks = Vec::new();
    for k in -500..1200 {
        let inputs = size.inputs(&heard(k));
        let tick = machine.tick(f64::from(k) * 1e-3 * size.time, Some(&inputs));
        let (q, qd) = (&inputs.measured.joints, &inputs.measured.joint_velocities);
        let torques = machine.joint_tick(q, qd, 1e-4 * size.time);
        let torques = torques.map(|tau| tau / size.torque());
        ticks.push((tick, size.command(machine.command()), torques));
    }
    ticks
}

#[test]
fn a_large_robot_jumps_as_a_small_one_does() {
    let (small, large) = (fly(SMALL, SMALL.settings()), fly(LARGE, LARGE.settings()));
    let mut phases = Vec::new();
    for (k, (small, large)) in small.iter().zip(&large).enumerate() {
        assert_eq!(small, large, "tick {k}");
        if phases.last() != Some(&small.0.phase) {
            phases.push(small.0.phase);
        }
    }
    let whole = [
        Phase::Hold,
        Phase::Stance,
        Phase::Flight,
        Phase::PreLanding,
        Phase::Landing,
        Phase::Stand,
    ];
    assert_eq!(phases, whole);
}

type Take = fn(&mut Settings<f64, 12, 4>, &Settings<f64, 12, 4>);

/// Every number of the settings that has a size.
const TAKES: [(&str, Take); 49] = [
    ("weighing", |to, of| to.weighing = of.weighing),
    ("moving", |to, of| to.centring.moving = of.centring.moving),
    ("rest of the trunk", |to, of| {
        to.centring.rest = of.centring.rest
    }),
    ("most", |to, of| to.centring.most = of.centring.most),
    ("agreement", |to, of| {
        to.centring.agreement = of.centring.agreement
    }),
    ("centring.damping", |to, of| {
        to.centring.damping = of.centring.damping
    }),
    ("levelling", |to, of| to.levelling = of.levelling),
    ("rest", |to, of| to.rest = of.rest),
    ("settling", |to, of| to.settling = of.settling),
    ("stand_height", |to, of| to.stand_height = of.stand_height),
    ("slew", |to, of| to.slew = of.slew),
    ("pd.gains", |to, of| to.pd.gains = of.pd.gains),
    ("joint_gains", |to, of| {
        to.pd.joint_gains = of.pd.joint_gains
    }),
    ("takeoff", |to, of| {
        to.regulator.takeoff = of.regulator.takeoff
    }),
    ("touchdown", |to, of| {
        to.regulator.touchdown = of.regulator.touchdown
    }),
    ("running", |to, of| {
        to.regulator.running = of.regulator.running
    }),
    ("time", |to, of| to.regulator.time = of.regulator.time),
    ("easing", |to, of| to.unloading.easing = of.unloading.easing),
    ("lasting", |to, of| {
        to.unloading.lasting = of.unloading.lasting
    }),
    ("pull", |to, of| to.unloading.pull = of.unloading.pull),
    ("unloaded", |to, of| {
        to.unloading.loaded = of.unloading.loaded
    }),
    ("inertia_shaping.gain", |to, of| {
        to.inertia_shaping.gain = of.inertia_shaping.gain
    }),
    ("inertia_shaping.slowest", |to, of| {
        to.inertia_shaping.slowest = of.inertia_shaping.slowest
    }),
    ("inertia_shaping.ramp", |to, of| {
        to.inertia_shaping.ramp = of.inertia_shaping.ramp
    }),
    ("inertia_shaping.damping", |to, of| {
        to.inertia_shaping.damping = of.inertia_shaping.damping
    }),
    ("loaded", |to, of| to.detector.loaded = of.detector.loaded),
    ("observer", |to, of| {
        to.detector.observer.damping = of.detector.observer.damping
    }),
    ("filter", |to, of| to.detector.filter = of.detector.filter),
    ("capture", |to, of| to.posture.capture = of.posture.capture),
    ("posture", |to, of| to.posture.damping = of.posture.damping),
    ("height", |to, of| to.landing.height = of.landing.height),
    ("rotation", |to, of| {
        to.landing.rotation = of.landing.rotation
    }),
    ("inertia", |to, of| {
        to.landing.inertia_b = of.landing.inertia_b
    }),
    ("moment", |to, of| {
        to.landing.moment_weight = of.landing.moment_weight
    }),
    ("horizontal", |to, of| {
        to.landing.horizontal = of.landing.horizontal
    }),
    ("stance_damping", |to, of| {
        to.landing.stance_damping = of.landing.stance_damping
    }),
    ("stance_speeds", |to, of| {
        to.landing.stance_speeds = of.landing.stance_speeds
    }),
    ("hard", |to, of| to.landing.hard = of.landing.hard),
    ("retraction.fastest", |to, of| {
        to.retraction.fastest = of.retraction.fastest
    }),
    ("gentle", |to, of| {
        to.retraction.gentle = of.retraction.gentle
    }),
    ("near", |to, of| to.retraction.near = of.retraction.near),
    ("retraction.most", |to, of| {
        to.retraction.most = of.retraction.most
    }),
    ("fading", |to, of| {
        to.retraction.fading = of.retraction.fading
    }),
    ("retraction.lasting", |to, of| {
        to.retraction.lasting = of.retraction.lasting
    }),
    ("joint_speed", |to, of| {
        to.shortening.joint_speed = of.shortening.joint_speed
    }),
    ("gain", |to, of| to.shortening.gain = of.shortening.gain),
    ("shortening.most", |to, of| {
        to.shortening.most = of.shortening.most
    }),
    ("rate", |to, of| to.shortening.rate = of.shortening.rate),
    ("travel", |to, of| {
        to.shortening.travel = of.shortening.travel
    }),
];

/// The test above would see them: each number of a small robot makes a large one jump otherwise.
#[test]
fn a_large_robot_with_a_number_of_a_small_one_jumps_otherwise() {
    let (own, foreign) = (LARGE.settings(), SMALL.settings());
    let similar = fly(LARGE, own);
    let idle = TAKES.iter().filter(|(_, take)| {
        let mut settings = own;
        take(&mut settings, &foreign);
        fly(LARGE, settings) == similar
    });
    let idle: Vec<_> = idle.map(|(name, _)| name).collect();
    assert!(idle.is_empty(), "{idle:?}");
}
