//! The plant obeys the laws it is made of.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use a1_model::{A1Geared, FEET, MOTORS, a1};
use contact_sim::{
    Block, ContactLaw, ContactMass, ContactState, Error, NativeSimulator, Settings, Shape,
    Simulator, Terrain, Touch,
};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{
    Configuration, Contact, ContactShape, Frame, JointLimits, Link, Motion, Posture, Tangent, Tree,
    centroidal_state,
};

type Plant = NativeSimulator<f64, A1Geared, 12, 12, 12>;

/// Four feet and the eight corners of the trunk.
fn spheres() -> [Shape<f64>; 12] {
    core::array::from_fn(|i| match FEET.get(i) {
        Some(foot) => Shape::of(foot, i).unwrap(),
        None => {
            let sign = |bit: usize| if (i - 4) >> bit & 1 == 0 { 1.0 } else { -1.0 };
            let corner = [0.18 * sign(0), 0.097 * sign(1), 0.057 * sign(2)];
            Shape::ball(Link::Base, corner, 0.01, i)
        }
    })
}

fn settings() -> Settings<f64, 12> {
    Settings::new(&a1::LIMITS, &MOTORS)
}

/// No losses, no stops, no motors' limits.
fn ideal() -> Settings<f64, 12> {
    let free = JointLimits {
        lower: -1e9,
        upper: 1e9,
        ..JointLimits::NONE
    };
    let mut s = settings();
    s.limits = [free; 12];
    s
}

fn plant(settings: Settings<f64, 12>) -> Plant {
    Plant::new(A1Geared, spheres(), Terrain::FLAT, settings)
}

fn standing(height: f64) -> Configuration<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.base.translation.z = height;
    q.joints = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    q
}

#[test]
fn flight_keeps_energy_and_momentum() {
    let mut sim = plant(ideal());
    let mut q = standing(5.0);
    q.base.rotation = Rotation3::from_euler_angles(0.3, -0.5, 1.0);
    let v = Tangent {
        base: Motion::from_array([1.0, -0.5, 2.0, 4.0, -6.0, 3.0]),
        joints: core::array::from_fn(|i| if i % 2 == 0 { 3.0 } else { -2.0 }),
    };
    sim.reset(&q, &v);
    let look = |sim: &Plant| {
        centroidal_state(
            &A1Geared,
            &Posture::new(&A1Geared, sim.configuration()),
            sim.velocity(),
        )
    };
    let before = look(&sim);
    for _ in 0..4000 {
        sim.step(&[0.0; 12]).unwrap();
    }
    let after = look(&sim);
    let t = sim.time();
    let energy = |s: &rbd_core::CentroidalState<f64>| s.kinetic_energy + s.potential_energy;
    assert!((energy(&after) / energy(&before) - 1.0).abs() < 1e-6);
    let (l0, l1) = (before.momentum_w.angular, after.momentum_w.angular);
    assert!(
        (l1 - l0).norm() < 1e-5 * l0.norm(),
        "{}",
        (l1 - l0).norm() / l0.norm()
    );
    let fallen = before.com_w + before.com_velocity_w * t - Vector3::z() * (0.5 * 9.81 * t * t);
    assert!(
        (after.com_w - fallen).norm() < 1e-5,
        "{}",
        (after.com_w - fallen).norm()
    );
}

/// One ball as a robot: a base without joints that matter.
struct Ball;
static BALL_BASE: rbd_core::BaseBody<f64> = rbd_core::BaseBody {
    mass: 2.0,
    first: [0.0; 3],
    second: [0.0004, 0.0004, 0.0004, 0.0, 0.0, 0.0],
};
static BALL_BODIES: [rbd_core::Body<f64>; 1] = [rbd_core::Body {
    subtree_end: 1,
    mass: 1e-3,
    second: [1e-6, 1e-6, 1e-6, 0.0, 0.0, 0.0],
    ..rbd_core::Body::<f64>::EMPTY
}];
rbd_core::tree! {
    impl Tree<f64, 1> for Ball { floating, BALL_BASE, BALL_BODIES, 1 * [RevoluteX] }
}

fn ball(points: usize, friction: f64) -> NativeSimulator<f64, Ball, 1, 3, 3> {
    // Three points on a wide plate, so that it slides or sticks but cannot roll; or one ball.
    let spheres = core::array::from_fn(|i| {
        let center = if points == 1 {
            [0.0; 3]
        } else {
            [[0.2, 0.0, 0.0], [-0.1, 0.17, 0.0], [-0.1, -0.17, 0.0]][i]
        };
        Shape::ball(Link::Base, center, if i < points { 0.02 } else { -10.0 }, i)
    });
    let limits = JointLimits {
        lower: -1e9,
        upper: 1e9,
        ..JointLimits::NONE
    };
    let mut s = Settings::new(&[limits], &[MOTORS[0]]);
    s.contact = ContactLaw::new(friction);
    NativeSimulator::new(Ball, spheres, Terrain::FLAT, s)
}

/// A plate on three points slides for 0.1 s: its speed in the end, and the load.
fn slide(friction: f64, speed: f64) -> (f64, f64) {
    let mut sim = ball(3, friction);
    let mut q = Configuration::NEUTRAL;
    q.base.translation.z = 0.02;
    sim.reset(&q, &Tangent::ZERO);
    for _ in 0..3000 {
        sim.step(&[0.0]).unwrap();
    }
    let settled = *sim.configuration();
    sim.reset(
        &settled,
        &Tangent {
            base: Motion::from_array([speed, 0.0, 0.0, 0.0, 0.0, 0.0]),
            joints: [0.0],
        },
    );
    let mut load = 0.0;
    for _ in 0..1000 {
        sim.step(&[0.0]).unwrap();
        load += sim.contact_forces_w().iter().map(|f| f.z).sum::<f64>() / 1000.0;
    }
    let v = sim.velocity().base.linear.x;
    (v, load)
}

#[test]
fn sliding_friction_is_mu_times_the_load() {
    let (v, load) = slide(0.4, 1.0);
    assert!((load / (2.001 * 9.81) - 1.0).abs() < 0.02, "load {load}");
    assert!((v - (1.0 - 0.4 * 9.81 * 0.1)).abs() < 0.02, "speed {v}");
}

/// A ball of 2 kg.
const MASS: ContactMass<f64> = ContactMass {
    link: 2.0,
    point: 2.0,
};

/// Penetration at which a contact of 2 kg at rest carries a load, by bisection, once its force has settled.
fn depth_under(law: &ContactLaw<f64>, load: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..50 {
        let depth = 0.5 * (low + high);
        let touch = Touch {
            depth,
            normal_w: Vector3::z(),
        };
        let mut state = ContactState::NONE;
        let still = Vector3::zeros();
        for _ in 0..3000 {
            law.advance(&mut state, &touch, (&still, &still), MASS, 5e-5);
        }
        if state.force_w.z < load {
            low = depth;
        } else {
            high = depth;
        }
    }
    high
}

/// One contact under a load of 20 N carries 2 kg that are pulled sideways with `pull` of the load for one
/// second, as on a slope of that gradient: distance, final speed, and acceleration over the second half.
fn pulled(friction: f64, pull: f64) -> (f64, f64, f64) {
    let (law, load) = (ContactLaw::new(friction), 20.0);
    let touch = Touch {
        depth: depth_under(&law, load),
        normal_w: Vector3::z(),
    };
    let (mut state, mut x, mut v, mut half) = (ContactState::NONE, 0.0, 0.0, 0.0);
    for i in 0..20_000 {
        let velocity = Vector3::new(v, 0.0, 0.0);
        law.advance(
            &mut state,
            &touch,
            (&Vector3::zeros(), &velocity),
            MASS,
            5e-5,
        );
        v += 5e-5 * (pull * load + state.force_w.x) / 2.0;
        x += 5e-5 * v;
        if i < 10_000 {
            half = v;
        }
    }
    (x, v, (v - half) / 0.5)
}

#[test]
fn inside_the_cone_a_foot_sticks_and_hardly_creeps() {
    let slope = 0.364; // 20 degrees
    let (x, v, _) = pulled(0.40, slope);
    // Friction of MuJoCo's kind creeps like a damper, on hard ground by a tenth of a millimetre a second under a third of its load.
    assert!(x < 1e-3 && v.abs() < 2e-4, "moved {x} m, still at {v} m/s");
    let (_, _, a) = pulled(0.33, slope);
    let expected = (slope - 0.33) * 10.0;
    assert!(
        (a / expected - 1.0).abs() < 0.02,
        "{a} m/s², not {expected}"
    );
}

#[test]
fn a_ball_rolls_on() {
    let mut sim = ball(1, 0.6);
    let mut q = Configuration::NEUTRAL;
    q.base.translation.z = 0.0198;
    let rolling = Tangent {
        base: Motion::from_array([0.5, 0.0, 0.0, 0.0, 25.0, 0.0]),
        joints: [0.0],
    };
    sim.reset(&q, &rolling);
    for _ in 0..2000 {
        sim.step(&[0.0]).unwrap();
    }
    let v = sim.configuration().base.rotation * sim.velocity().base.linear;
    assert!((v.x - 0.5).abs() < 0.03, "{v}");
}

#[test]
fn a_dropped_robot_comes_to_rest_and_hardly_sinks() {
    let mut sim = plant(settings());
    let start = standing(0.45);
    sim.reset(&start, &Tangent::ZERO);
    for _ in 0..30_000 {
        let (q, v) = (sim.configuration().joints, sim.velocity().joints);
        let hold = core::array::from_fn(|i| 80.0 * (start.joints[i] - q[i]) - 2.0 * v[i]);
        sim.step(&hold).unwrap();
    }
    assert!(
        sim.velocity().base.linear.norm() < 1e-3,
        "{}",
        sim.velocity().base.linear.norm()
    );
    assert!(sim.velocity().joints.iter().all(|v| v.abs() < 1e-2));
    let mass: f64 = Tree::<f64, 12>::base(&A1Geared).mass
        + Tree::<f64, 12>::bodies(&A1Geared)
            .iter()
            .map(|b| b.mass)
            .sum::<f64>();
    let load: f64 = sim.contact_forces_w().iter().map(|f| f.z).sum();
    assert!((load / (mass * 9.81) - 1.0).abs() < 1e-3, "{load}");
    assert!(sim.contacts().iter().all(|c| c[0].depth < 1e-3));
    assert!(
        sim.contacts().iter().skip(4).all(|c| c[0].depth <= 0.0),
        "trunk touches"
    );
    // No energy from nowhere: where it stands it stays.
    let z = sim.configuration().base.translation;
    for _ in 0..5_000 {
        let (q, v) = (sim.configuration().joints, sim.velocity().joints);
        let hold = core::array::from_fn(|i| 80.0 * (start.joints[i] - q[i]) - 2.0 * v[i]);
        sim.step(&hold).unwrap();
    }
    assert!((sim.configuration().base.translation - z).norm() < 1e-4);
}

#[test]
fn a_limp_robot_falls_on_its_trunk_and_loses_all_energy() {
    let mut sim = plant(settings());
    sim.reset(&standing(0.35), &Tangent::ZERO);
    for _ in 0..40_000 {
        sim.step(&[0.0; 12]).unwrap();
    }
    assert!(
        sim.velocity().base.linear.norm() < 0.02,
        "{}",
        sim.velocity().base.linear
    );
    assert!(
        sim.contacts().iter().skip(4).any(|c| c[0].force_w.z > 1.0),
        "the trunk lies on the floor"
    );
}

#[test]
fn a_box_carries_the_robot_beside_the_floor() {
    let mut sim = plant(settings());
    sim.terrain.block = Some(Block {
        lower: [-1.0, -1.0, 0.0],
        upper: [1.0, 1.0, 0.4],
    });
    let start = standing(0.75);
    sim.reset(&start, &Tangent::ZERO);
    for _ in 0..15_000 {
        let (q, v) = (sim.configuration().joints, sim.velocity().joints);
        let hold = core::array::from_fn(|i| 80.0 * (start.joints[i] - q[i]) - 2.0 * v[i]);
        sim.step(&hold).unwrap();
    }
    assert!(
        sim.contacts()
            .iter()
            .take(4)
            .all(|c| (c[0].point_w.z - 0.4).abs() < 2e-3)
    );
}

#[test]
fn halving_the_step_changes_a_landing_little() {
    let land = |substeps: u32| {
        let mut s = settings();
        s.substeps = substeps;
        let mut sim = plant(s);
        let start = standing(0.45);
        sim.reset(&start, &Tangent::ZERO);
        for _ in 0..4_000 {
            let (q, v) = (sim.configuration().joints, sim.velocity().joints);
            let hold = core::array::from_fn(|i| 80.0 * (start.joints[i] - q[i]) - 2.0 * v[i]);
            sim.step(&hold).unwrap();
        }
        sim.configuration().base.translation
    };
    let (coarse, fine) = (land(2), land(8));
    assert!((coarse - fine).norm() < 3e-3, "{coarse} {fine}");
}

#[test]
fn the_same_run_twice_is_the_same_to_the_bit() {
    let run = || {
        let mut sim = plant(settings());
        sim.reset(&standing(0.4), &Tangent::ZERO);
        for i in 0..3000 {
            sim.step(&core::array::from_fn(|j| {
                5.0 * so3::math::sin(f64::from(i) * 0.01 + j as f64)
            }))
            .unwrap();
        }
        (*sim.configuration(), *sim.velocity())
    };
    assert_eq!(run(), run());
}

#[test]
fn a_torque_that_is_not_finite_is_refused() {
    let mut sim = plant(settings());
    sim.reset(&standing(0.4), &Tangent::ZERO);
    let before = *sim.configuration();
    let mut torque = [0.0; 12];
    torque[7] = f64::NAN;
    assert_eq!(sim.step(&torque), Err(Error::TorqueNotFinite(7)));
    assert_eq!(*sim.configuration(), before);
}

/// The corners of a sole touch its plane, inside its edges, on its side of the plane.
#[test]
fn the_corners_of_a_sole_lie_in_its_plane() {
    let shape = ContactShape::Rectangle {
        x: [-0.05, 0.1],
        y: [-0.03, 0.04],
    };
    let sole = Contact {
        name: "sole",
        frame: Frame {
            offset: [0.1, 0.2, 0.3],
            rotation: [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
            ..Frame::IDENTITY
        },
        shape,
    };
    let corners = Shape::corners(&sole, 0.005, 0).unwrap();
    let heels = [[0.145, 0.225, 0.305], [0.145, 0.165, 0.305]];
    let toes = [[0.005, 0.225, 0.305], [0.005, 0.165, 0.305]];
    for (corner, wanted) in corners.iter().zip(heels.iter().chain(&toes)) {
        let apart = Vector3::from(corner.from) - Vector3::from(*wanted);
        assert!(apart.norm() < 1e-12, "{corner:?}");
    }
    assert_eq!(Shape::corners(&FEET[0], 0.005, 0), None);
}

/// The rod of a shank over the edge of a box is carried by the edge, at rest, and no end touches anything.
#[test]
fn a_rod_lies_on_an_edge() {
    let mut sim = plant(settings());
    let rod = Shape {
        from: [-0.4, 0.0, 0.0],
        to: [0.4, 0.0, 0.0],
        ..Shape::ball(Link::Base, [0.0; 3], 0.02, 5)
    };
    sim.shapes = [Shape::ball(Link::Base, [0.0; 3], -10.0, 0); 12];
    sim.shapes[5] = rod;
    sim.terrain.block = Some(Block {
        lower: [-0.01, -1.0, 0.0],
        upper: [0.01, 1.0, 0.5],
    });
    let mut start = standing(0.52);
    start.base.translation.z = 0.52;
    sim.reset(&start, &Tangent::ZERO);
    for _ in 0..300 {
        sim.step(&[0.0; 12]).unwrap();
    }
    let [first, last, between] = sim.contacts()[5];
    assert!(between.force_w.z > 50.0, "{between:?}");
    assert!(first.depth <= 0.0 && last.depth <= 0.0);
    assert!(sim.contact_forces_w()[5].z > 50.0);
}

/// Two legs that are pressed together hold each other off; without pairs they pass through each other.
#[test]
fn links_that_collide_do_not_pass() {
    let shapes: [Shape<f64>; 26] = a1_model::SHAPES;
    let start = standing(2.0);
    let pairs = contact_sim::self_contacts(&A1Geared, &shapes, &start);
    let closest = |pairs: [u64; 26]| {
        let sim =
            NativeSimulator::<f64, _, 12, 26, 17>::new(A1Geared, shapes, Terrain::FLAT, settings());
        let mut sim = sim.colliding(pairs);
        sim.reset(&start, &Tangent::ZERO);
        let mut felt = 0.0;
        for _ in 0..3000 {
            // The left legs turn inwards, and the right ones too.
            let torque = core::array::from_fn(|i| match i {
                0 | 6 => -8.0,
                3 | 9 => 8.0,
                _ => {
                    40.0 * (start.joints[i] - sim.configuration().joints[i])
                        - sim.velocity().joints[i]
                }
            });
            sim.step(&torque).unwrap();
            felt = f64::max(felt, sim.link_forces().iter().sum());
        }
        let q = sim.configuration().joints;
        (q[3] - q[0], felt)
    };
    let (with, felt) = closest(pairs);
    let (without, nothing) = closest([0; 26]);
    assert!(felt > 10.0 && nothing == 0.0, "{felt} {nothing}");
    assert!(with < without - 0.2, "{with} {without}");
}

/// A softer ground gives way more under the same weight: in proportion to the square of its time constant.
#[test]
fn the_ground_gives_way_by_its_time_constant() {
    let depth = |time_constant: f64| {
        let law = ContactLaw {
            time_constant,
            friction: 0.6,
        };
        depth_under(&law, 20.0)
    };
    let (firm, soft) = (depth(0.01), depth(0.02));
    assert!((soft / firm - 4.0).abs() < 0.8, "{firm} {soft}");
    assert!(depth(0.002) < 0.1 * firm);
}
