//! MuJoCo and rbd-core mean the same robot: `cargo xtask mujoco test -p contact-sim --features mujoco`.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use a1_model::{A1, A1Geared, FEET, MOTORS, a1};
use contact_sim::{
    Block, Error, Geom, MujocoSimulator, NativeSimulator, Settings, Shape, Simulator, Terrain,
    linked,
};
use icub_model::{Icub23, Icub23Cad, Icub23Geared, SOLES};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::{ProptestConfig, prop_assert, proptest};
use rbd_core::{
    AbaWorkspace, Configuration, Effort, Frame, JointLimits, Model, Motion, Posture, Tangent, Tree,
    aba, centroidal_state,
};

const FLOOR_FAR_BELOW: Terrain<f64> = Terrain {
    floor: -1e3,
    block: None,
};

/// Ten kilohertz, one step per tick.
fn settings<M: Model<f64, N>, const N: usize>(model: &M) -> Settings<f64, N> {
    let mut s = Settings::new(model.limits(), model.motors().unwrap());
    s.substeps = 1;
    s
}

/// No stops, no Coulomb friction: what rbd-core's forward dynamics know.
fn smooth<M: Tree<f64, N>, const N: usize>(
    model: &M,
    limits: &[JointLimits<f64>; N],
) -> MujocoSimulator<N, 1> {
    let free = limits.map(|l| JointLimits {
        damping: l.damping,
        ..JointLimits::NONE
    });
    let mut s = Settings::new(&free, &[MOTORS[0]; N]);
    s.substeps = 1;
    MujocoSimulator::new(linked, model, (&[], &[]), &FLOOR_FAR_BELOW, s).unwrap()
}

/// Some state and torques from a list of numbers.
fn state<const N: usize>(x: &[f64]) -> (Configuration<f64, N>, Tangent<f64, N>, [f64; N]) {
    let mut it = x.iter().copied().cycle();
    let mut next = |scale: f64| scale * it.next().unwrap();
    let mut q = Configuration::NEUTRAL;
    q.base.translation = Vector3::from_fn(|_, _| next(2.0));
    q.base.rotation = Rotation3::from_euler_angles(next(3.0), next(3.0), next(3.0));
    q.joints = core::array::from_fn(|_| next(1.5));
    let v = Tangent {
        base: Motion::from_array(core::array::from_fn(|_| next(5.0))),
        joints: core::array::from_fn(|_| next(10.0)),
    };
    (q, v, core::array::from_fn(|_| next(30.0)))
}

/// Largest difference of the accelerations relative to the largest acceleration.
fn disagreement<M: Tree<f64, N>, const N: usize>(
    model: &M,
    limits: &[JointLimits<f64>; N],
    sim: &mut MujocoSimulator<N, 1>,
    x: &[f64],
) -> f64 {
    let (q, v, torques) = state::<N>(x);
    sim.reset(&q, &v);
    let theirs = sim.acceleration(&torques).unwrap();
    let posture = Posture::new(model, &q);
    let effort = Effort {
        joints: core::array::from_fn(|i| torques[i] - limits[i].damping * v.joints[i]),
        ..Effort::ZERO
    };
    let ours = aba(model, &posture, &v, &effort, &mut AbaWorkspace::new());
    let all = |a: &Tangent<f64, N>| -> Vec<f64> {
        let base = a.base.to_array();
        base.into_iter().chain(a.joints).collect()
    };
    let (ours, theirs) = (all(&ours), all(&theirs));
    let scale = ours.iter().fold(1.0, |m: f64, a| m.max(a.abs()));
    let pairs = ours.iter().zip(&theirs);
    pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
}

macro_rules! agrees {
    ($($name:ident: $robot:expr;)*) => { $(
        #[test]
        fn $name() {
            let limits = *$robot.limits();
            let sim = core::cell::RefCell::new(smooth(&$robot, &limits));
            proptest!(ProptestConfig::with_cases(64), |(x in proptest::array::uniform32(-1.0..1.0))| {
                let error = disagreement(&$robot, &limits, &mut sim.borrow_mut(), &x);
                prop_assert!(error < 1e-9, "{error:.1e}");
            });
        }
    )* };
}

agrees! {
    a1_accelerates_as_in_rbd_core: A1;
    a1_with_rotors_accelerates_as_in_rbd_core: A1Geared;
    icub_accelerates_as_in_rbd_core: Icub23;
    icub_with_cad_inertias_accelerates_as_in_rbd_core: Icub23Cad;
    icub_with_rotors_accelerates_as_in_rbd_core: Icub23Geared;
}

fn a1_geoms() -> Vec<Geom> {
    let feet = FEET.iter().enumerate().map(|(i, foot)| Geom::of(foot, i));
    let trunk = Geom::Box {
        frame: Frame::IDENTITY,
        half: [0.1335, 0.097, 0.057],
        owner: 4,
    };
    feet.chain([trunk]).collect()
}

type A1Sim = MujocoSimulator<12, 5>;

fn a1_sim(terrain: &Terrain<f64>) -> A1Sim {
    MujocoSimulator::new(
        linked,
        &A1Geared,
        (&a1_geoms(), &[]),
        terrain,
        settings(&A1Geared),
    )
    .unwrap()
}

fn standing(height: f64) -> Configuration<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.base.translation.z = height;
    q.joints = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    q
}

/// Holds a posture for so many ticks.
fn hold<S: Simulator<f64, N, C, Error = Error>, const N: usize, const C: usize>(
    sim: &mut S,
    posture: &[f64; N],
    (kp, kd): (f64, f64),
    ticks: usize,
) {
    for _ in 0..ticks {
        let (q, v) = (sim.configuration().joints, sim.velocity().joints);
        let torque = core::array::from_fn(|i| kp * (posture[i] - q[i]) - kd * v[i]);
        sim.step(&torque).unwrap();
    }
}

fn weight<M: Tree<f64, N>, const N: usize>(model: &M) -> f64 {
    let mass = model.base().mass + model.bodies().iter().map(|b| b.mass).sum::<f64>();
    mass * 9.81
}

#[test]
fn flight_is_ballistic_and_keeps_momentum() {
    let limits = [JointLimits::NONE; 12];
    let mut sim = smooth(&A1Geared, &limits);
    let (q, mut v, _) = state::<12>(&[0.3, -0.5, 0.7, 0.2, -0.9, 0.4, 0.1]);
    v.joints = v.joints.map(|x| 0.3 * x);
    sim.reset(&q, &v);
    let look = |sim: &MujocoSimulator<12, 1>| {
        let posture = Posture::new(&A1Geared, sim.configuration());
        centroidal_state(&A1Geared, &posture, sim.velocity())
    };
    let before = look(&sim);
    for _ in 0..3000 {
        sim.step(&[0.0; 12]).unwrap();
    }
    let (after, t) = (look(&sim), sim.time());
    assert!((t - 0.3).abs() < 1e-12);
    let fallen = before.com_w + before.com_velocity_w * t - Vector3::z() * (0.5 * 9.81 * t * t);
    let missed = (after.com_w - fallen).norm();
    assert!(missed < 2e-3, "{missed}");
    let (l0, l1) = (before.momentum_w.angular, after.momentum_w.angular);
    assert!(
        (l1 - l0).norm() < 2e-3 * l0.norm(),
        "{}",
        (l1 - l0).norm() / l0.norm()
    );
}

#[test]
fn contact_forces_carry_the_weight_on_the_floor_and_on_a_block() {
    let block = Block {
        lower: [-1.0, -1.0, 0.0],
        upper: [1.0, 1.0, 0.5],
    };
    let on_block = Terrain {
        floor: 0.0,
        block: Some(block),
    };
    for (terrain, ground) in [(Terrain::FLAT, 0.0), (on_block, 0.5)] {
        let mut sim = a1_sim(&terrain);
        let start = standing(ground + 0.33);
        sim.reset(&start, &Tangent::ZERO);
        hold(&mut sim, &start.joints, (80.0, 2.0), 15_000);
        let forces = sim.contact_forces_w();
        let load: Vector3<f64> = forces.iter().sum();
        assert!((load.z / weight(&A1Geared) - 1.0).abs() < 5e-3, "{load}");
        assert!(load.xy().norm() < 0.5, "{load}");
        assert!(forces[..4].iter().all(|f| f.z > 10.0) && forces[4] == Vector3::zeros());
        // Feet sink less than 2 mm.
        let mut poses = rbd_core::Kinematics::IDENTITY;
        let posture = Posture::new(&A1Geared, sim.configuration());
        rbd_core::forward_kinematics(&A1Geared, &posture, &mut poses);
        for foot in &FEET {
            let z = poses.frame(&foot.frame).translation.z - ground;
            assert!((z - a1_model::FOOT_RADIUS).abs() < 2e-3, "{z}");
        }
    }
}

#[test]
fn a_limp_robot_falls_on_its_trunk() {
    let mut sim = a1_sim(&Terrain::FLAT);
    sim.reset(&standing(0.4), &Tangent::ZERO);
    for _ in 0..20_000 {
        sim.step(&[0.0; 12]).unwrap();
    }
    assert!(sim.contact_forces_w()[4].z > 10.0);
    assert!(sim.velocity().base.linear.norm() < 0.02);
}

/// One foot as a plate that slides: friction is μ times the load, in the direction against the motion.
#[test]
fn sliding_friction_is_mu_times_the_load() {
    let mut s = settings(&A1Geared);
    s.contact.friction = 0.4;
    let mut sim: A1Sim =
        MujocoSimulator::new(linked, &A1Geared, (&a1_geoms(), &[]), &Terrain::FLAT, s).unwrap();
    let start = standing(0.33);
    sim.reset(&start, &Tangent::ZERO);
    hold(&mut sim, &start.joints, (200.0, 5.0), 8_000);
    let settled = *sim.configuration();
    let mut v = Tangent::ZERO;
    v.base.linear.y = 1.0;
    sim.reset(&settled, &v);
    hold(&mut sim, &start.joints, (200.0, 5.0), 300);
    let load: Vector3<f64> = sim.contact_forces_w().iter().sum();
    assert!((load.y / load.z + 0.4).abs() < 0.02, "{load}");
}

/// Icub stands on its soles under joint control, and its soles carry it.
#[test]
fn icub_stands_on_its_soles() {
    let geoms: Vec<Geom> = SOLES
        .iter()
        .enumerate()
        .map(|(i, s)| Geom::of(s, i))
        .collect();
    let mut sim: MujocoSimulator<23, 2> = MujocoSimulator::new(
        linked,
        &Icub23,
        (&geoms, &[]),
        &Terrain::FLAT,
        settings(&Icub23),
    )
    .unwrap();
    let mut start = Configuration::NEUTRAL;
    let mut poses = rbd_core::Kinematics::IDENTITY;
    rbd_core::forward_kinematics(&Icub23, &Posture::new(&Icub23, &start), &mut poses);
    start.base.translation.z = -poses.frame(&SOLES[0].frame).translation.z;
    // The feet's axes point as the root's do, backwards: nothing but height matters here.
    sim.reset(&start, &Tangent::ZERO);
    hold(&mut sim, &start.joints, (300.0, 10.0), 5_000);
    let forces = sim.contact_forces_w();
    let load: f64 = forces.iter().map(|f| f.z).sum();
    assert!((load / weight(&Icub23) - 1.0).abs() < 0.02, "{load}");
    assert!(
        forces.iter().all(|f| f.z > 0.3 * weight(&Icub23)),
        "{forces:?}"
    );
    let up = sim.configuration().base.rotation * Vector3::z();
    assert!(up.z > 0.999, "{up}");
}

/// The same drop in both simulators: first contact at the same time, rest at the same height.
#[test]
fn both_simulators_tell_the_same_drop() {
    let start = standing(0.55);
    let mut judge = a1_sim(&Terrain::FLAT);
    let spheres: [Shape<f64>; 4] = core::array::from_fn(|i| Shape::of(&FEET[i], i).unwrap());
    let mut native = NativeSimulator::<f64, _, 12, 4, 4>::new(
        A1Geared,
        spheres,
        Terrain::FLAT,
        Settings::new(&a1::LIMITS, &MOTORS),
    );
    fn drop<S: Simulator<f64, 12, C, Error = Error>, const C: usize>(
        sim: &mut S,
        start: &Configuration<f64, 12>,
    ) -> (f64, f64) {
        sim.reset(start, &Tangent::ZERO);
        let mut first = f64::NAN;
        for _ in 0..20_000 {
            hold(sim, &start.joints, (120.0, 3.0), 1);
            if first.is_nan() && sim.contact_forces_w().iter().any(|f| f.norm() > 15.0) {
                first = sim.time();
            }
        }
        (first, sim.configuration().base.translation.z)
    }
    let ((t_native, z_native), (t_judge, z_judge)) =
        (drop(&mut native, &start), drop(&mut judge, &start));
    assert!((t_native - t_judge).abs() < 3e-3, "{t_native} {t_judge}");
    assert!((z_native - z_judge).abs() < 0.01, "{z_native} {z_judge}");
}

#[test]
fn the_same_run_twice_is_the_same_to_the_bit_and_a_reset_forgets_everything() {
    let mut sim = a1_sim(&Terrain::FLAT);
    let mut run = || {
        sim.reset(&standing(0.4), &Tangent::ZERO);
        for i in 0..3000 {
            let torque =
                core::array::from_fn(|j| 5.0 * so3::math::sin(f64::from(i) * 0.01 + j as f64));
            sim.step(&torque).unwrap();
        }
        (
            *sim.configuration(),
            *sim.velocity(),
            *sim.contact_forces_w(),
        )
    };
    let first = run();
    assert_eq!(run(), first);
}

#[test]
fn motors_limit_and_bad_torques_are_refused() {
    let mut sim = a1_sim(&Terrain::FLAT);
    sim.reset(&standing(0.4), &Tangent::ZERO);
    sim.step(&[1e3; 12]).unwrap();
    assert!(sim.delivered().iter().all(|tau| *tau <= MOTORS[0].torque));
    let before = *sim.configuration();
    let mut torque = [0.0; 12];
    torque[7] = f64::NAN;
    assert_eq!(sim.step(&torque), Err(Error::TorqueNotFinite(7)));
    assert_eq!(*sim.configuration(), before);
}

#[test]
fn tables_that_are_no_robot_are_refused_with_mujocos_words() {
    let row = rbd_core::Body {
        mass: 1.0,
        second: [1.0, -1.0, 0.1, 0.0, 0.0, 0.0],
        ..rbd_core::Body::EMPTY
    };
    let base = rbd_core::BaseBody {
        mass: 1.0,
        second: [0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
        ..rbd_core::BaseBody::EMPTY
    };
    let model = rbd_core::TableModel::<f64, 1>::with_any_inertia(
        rbd_core::BaseKind::Floating,
        base,
        &[row],
    )
    .unwrap();
    let s = Settings::new(&[JointLimits::NONE], &[MOTORS[0]]);
    let refused = MujocoSimulator::<1, 0>::new(linked, &model, (&[], &[]), &Terrain::FLAT, s);
    assert!(refused.unwrap_err().to_string().contains("inertia"));
}
