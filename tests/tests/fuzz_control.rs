//! Any input to any control step: the command stays finite and inside limits, faults are named, nothing panics, and good
//! inputs afterwards give good results again.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{
    CartesianPd, Fault, JointCommand, JointGains, Measurement, Node, Plan, Slew, Torques, Watch,
    sample,
};
use landing::{Detector, DetectorState, Landing, Outcome, PreLanding, Settings, Target, Workspace};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::array::{uniform4, uniform12};
use proptest::collection::vec;
use proptest::prelude::{
    BoxedStrategy, Just, ProptestConfig, Strategy, any, prop_assert, prop_assert_eq, prop_oneof,
    proptest,
};
use rbd_core::{Configuration, Frame, Motion, Tangent, Transform};
use state_est::{Estimate, Estimator, Foot, Sample, State, Status};

/// Numbers as they come from sensors, and as they come from broken ones.
fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        24 => -3.0..3.0,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
        1 => Just(1e300),
        1 => Just(-1e300),
        1 => any::<f64>(),
    ]
    .boxed()
}

fn vector() -> BoxedStrategy<Vector3<f64>> {
    [number(), number(), number()]
        .prop_map(Vector3::from)
        .boxed()
}

/// Mostly rotations, sometimes nine numbers that are none.
fn rotation() -> BoxedStrategy<Rotation3<f64>> {
    prop_oneof![
        4 => vector().prop_map(|w| if w.norm() < 10.0 { so3::exp(&w) } else { Rotation3::identity() }),
        1 => [vector(), vector(), vector()]
            .prop_map(|c| Rotation3::from_matrix_unchecked(Matrix3::from_columns(&c))),
    ]
    .boxed()
}

fn transform() -> BoxedStrategy<Transform<f64>> {
    (rotation(), vector())
        .prop_map(|(rotation, p)| Transform::new(rotation, p))
        .boxed()
}

fn motion() -> BoxedStrategy<Motion<f64>> {
    (vector(), vector())
        .prop_map(|(linear, angular)| Motion::new(linear, angular))
        .boxed()
}

fn measurement() -> BoxedStrategy<Measurement<f64, 12, 4>> {
    (
        transform(),
        motion(),
        uniform12(number()),
        uniform12(number()),
        uniform4(number()),
        number(),
    )
        .prop_map(
            |(base, base_velocity, q, v, foot_forces, age)| Measurement {
                base,
                base_velocity,
                joints: q,
                joint_velocities: v,
                foot_forces,
                age,
            },
        )
        .boxed()
}

fn feet() -> [Frame<f64>; 4] {
    FEET.map(|foot| foot.frame)
}

const CROUCH: [f64; 12] = [
    0.1, 0.8, -1.6, -0.1, 0.8, -1.6, 0.1, 0.8, -1.6, -0.1, 0.8, -1.6,
];

/// Torques that the motors are asked for are numbers inside their limits.
fn inside(torques: &[f64; 12], qd: &[f64; 12]) -> bool {
    torques
        .iter()
        .zip(qd)
        .zip(&MOTORS)
        .all(|((tau, qd), motor)| {
            let [low, high] = motor.torque_range(*qd);
            tau.is_finite() && low <= *tau && *tau <= high
        })
}

fn standing() -> Measurement<f64, 12, 4> {
    Measurement {
        base: Transform::new(Rotation3::identity(), Vector3::new(0.0, 0.0, 0.3)),
        base_velocity: Motion::ZERO,
        joints: CROUCH,
        joint_velocities: [0.0; 12],
        foot_forces: [30.0; 4],
        age: 0.0,
    }
}

/// Whether a number may come from a robot at all.
fn sane(x: &f64) -> bool {
    x.abs() <= 1e6
}

fn all_sane(m: &Measurement<f64, 12, 4>) -> bool {
    let base = m.base.translation.iter().chain(m.base.rotation.matrix());
    base.chain(&m.base_velocity.to_array())
        .chain(&m.joints)
        .chain(&m.joint_velocities)
        .chain(&m.foot_forces)
        .all(sane)
}

fn finite(estimate: &Estimate<f64, 4>) -> bool {
    let base = estimate.base.translation.iter();
    base.chain(estimate.base.rotation.matrix())
        .chain(&estimate.velocity.to_array())
        .all(|x| x.is_finite())
        && estimate.confidence.iter().all(|c| (0.0..=1.0).contains(c))
        && so3::orthogonality_defect(estimate.base.rotation.matrix()) < 1e-6
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn the_watch_lets_no_bad_measurement_through(m in measurement()) {
        let fault = Watch { max_age: 0.005 }.fault(&m);
        let fresh = (0.0..=0.005).contains(&m.age);
        prop_assert_eq!(fault.is_none(), fresh && all_sane(&m));
        prop_assert_eq!(fault == Some(Fault::Stale), !fresh);
        if let Some(Fault::Joint(i)) = fault {
            prop_assert!(!sane(&m.joints[i]) || !sane(&m.joint_velocities[i]));
        }
    }

    #[test]
    fn pushing_off_with_any_numbers_stays_inside_the_motors(
        m in measurement(),
        time in number(),
        hint in any::<usize>(),
        (q, qd) in (uniform12(number()), uniform12(number())),
        dt in number(),
    ) {
        let node = |time: f64| Node { time, joints: CROUCH, torques: [5.0; 12], ..Node::ZERO };
        let nodes = [node(0.0), node(0.2), node(0.5)];
        let plan: Plan<'_, f64, 12, 4> = Plan::new(&nodes, 0.2, 0.3, 0.5, Torques::Hold).unwrap();
        let reference = sample(&plan, time, hint);
        prop_assert!(reference.joints.iter().chain(&reference.torques).all(|x| x.is_finite()));
        let pd = CartesianPd::new(&BUILD, feet());
        let command = pd.command(&A1Geared, &m, &reference);
        prop_assert!(inside(&command.torques(&q, &qd, &MOTORS), &qd));
        let damped = JointCommand::damp(2.0).torques(&q, &qd, &MOTORS);
        prop_assert!(inside(&damped, &qd));
        let mut slew = Slew::new(1e4);
        let limited = slew.limit(&command.feed_forward, dt);
        prop_assert!(limited.iter().all(|tau| tau.is_finite()));
    }

    #[test]
    fn landing_with_any_numbers_stays_inside_the_motors(
        m in measurement(),
        contacts in uniform4(any::<bool>()),
        target in (number(), rotation(), number(), number()),
        waiting in uniform12(number()),
        (q, qd) in (uniform12(number()), uniform12(number())),
    ) {
        let landing = Landing::<f64, 12, 4>::new(feet(), Settings::new(&BUILD), [33.5; 12]);
        let mut workspace = Workspace::new();
        let (height, rot_wb, x, y) = target;
        let target = Target { height, rot_wb, offset_w: [x, y] };
        let mut land = |m: &Measurement<f64, 12, 4>, contacts, target: &Target<f64>, waiting| {
            let at = Configuration { base: m.base, joints: m.joints };
            let moving = Tangent { base: m.base_velocity, joints: m.joint_velocities };
            landing.step(&A1Geared, &at, &moving, contacts, target, waiting, &mut workspace)
        };
        let c = land(&m, &contacts, &target, &waiting);
        for (force, on) in c.forces_w.iter().zip(&contacts) {
            prop_assert!(force.iter().all(|f| f.is_finite()) && (0.0..=400.0).contains(&force.z));
            prop_assert!(*on || force.norm() == 0.0);
        }
        let command = JointCommand {
            position: c.position,
            velocity: [0.0; 12],
            feed_forward: c.feed_forward,
            gains: core::array::from_fn(|i| JointGains {
                stiffness: c.stiffness[i],
                damping: c.damping[i],
            }),
        };
        prop_assert!(inside(&command.torques(&q, &qd, &MOTORS), &qd));
        if !m.joints.iter().all(|x| x.is_finite()) {
            prop_assert_eq!(c.outcome, Outcome::BadData);
        }
        // The memory of a bad tick does not spoil the next.
        let level = Target { height: 0.25, ..Target::LEVEL };
        let c = land(&standing(), &[true; 4], &level, &CROUCH);
        prop_assert!(matches!(c.outcome, Outcome::Solved(_)), "{:?}", c.outcome);
        prop_assert!(c.forces_w.iter().map(|f| f.z).sum::<f64>() > 50.0);
    }

    #[test]
    fn detection_with_any_numbers_recovers(
        bad in vec((measurement(), uniform12(number()), number()), 1..6),
    ) {
        let detector = Detector::<f64, 12, 4>::new(&BUILD, feet());
        let mut state = DetectorState::new();
        let mut tick = |m: &Measurement<f64, 12, 4>, torques: &[f64; 12], dt: f64| {
            let at = Configuration { base: m.base, joints: m.joints };
            let moving = Tangent { base: m.base_velocity, joints: m.joint_velocities };
            detector.update(&A1Geared, &mut state, &at, &moving, torques, &m.foot_forces, dt);
            state
        };
        for (m, torques, dt) in &bad {
            let _ = tick(m, torques, *dt);
        }
        // In the air, limp and falling: nothing is felt and nothing is said.
        let mut air = standing();
        air.foot_forces = [0.0; 4];
        let mut last = DetectorState::new();
        for k in 0..1000 {
            air.base_velocity.linear.z = -9.81e-3 * f64::from(k);
            last = tick(&air, &[0.0; 12], 1e-3);
        }
        prop_assert_eq!(last.contacts, [false; 4]);
        prop_assert_eq!(last.faulty, [false; 4]);
    }

    #[test]
    fn legs_meet_the_ground_within_reach(up in vector(), velocity in vector()) {
        let posture = PreLanding::new(&BUILD, feet(), CROUCH);
        let joints = posture.joints(&A1Geared, &up, &velocity);
        let near = |q: &f64, level: &f64| (q - level).abs() <= posture.reach + 1e-12;
        prop_assert!(joints.iter().zip(&CROUCH).all(|(q, level)| near(q, level)));
    }

    #[test]
    fn the_estimate_is_always_finite_and_comes_back(
        bad in vec(
            (vector(), vector(), uniform12(number()), uniform12(number()), uniform4(number()), number(), any::<bool>()),
            1..12,
        ),
    ) {
        let estimator = Estimator::<f64, 12, 4, 6> {
            feet: FEET.map(|foot| Foot::of(&foot)),
            imu: Transform::IDENTITY,
            settings: state_est::Settings::new(),
        };
        let start = Configuration { joints: CROUCH, ..Configuration::NEUTRAL };
        let mut state = State::new(&estimator, &A1Geared, &start);
        for (force, rate, q, v, evidence, dt, there) in bad {
            let sample = Sample {
                specific_force_i: force,
                angular_velocity_i: rate,
                joints: q,
                joint_velocities: v,
                evidence,
            };
            let dt = if dt.is_finite() && dt.abs() < 3.0 { 1e-3 } else { dt };
            let shown = there.then_some(&sample);
            let e = estimator.step(&A1Geared, &mut state, shown, dt);
            prop_assert!(finite(&e), "{e:?}");
            let broken = !(sane(&force.amax()) && sane(&rate.amax()) && q.iter().chain(&v).all(sane));
            prop_assert!(e.fault.is_some() || (there && !broken), "{e:?}");
        }
        let good = Sample {
            specific_force_i: Vector3::new(0.0, 0.0, 9.81),
            angular_velocity_i: Vector3::zeros(),
            joints: CROUCH,
            joint_velocities: [0.0; 12],
            evidence: [1.0; 4],
        };
        let mut e = estimator.step(&A1Geared, &mut state, Some(&good), 1e-3);
        for _ in 0..1000 {
            e = estimator.step(&A1Geared, &mut state, Some(&good), 1e-3);
        }
        prop_assert_eq!((e.status, e.fault), (Status::Good, None));
        prop_assert!(finite(&e) && e.velocity.linear.norm() < 0.2, "{e:?}");
    }
}
