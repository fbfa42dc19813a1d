//! Jumps in both simulators, nominal and disturbed.
#![allow(clippy::unwrap_used, reason = "tests")]
use super::judge::{GAIN, Judged};
use super::{GRAVITY, JOINTS, Landing, ROBOT, State, Task};
use super::{com, execute, on_the_floor, plant, poses, squat};
use crate::Sim;
use crate::lab::{Disturbance, Lab, PlantArgument};
use icub_model::MOTORS;
use icub_model::gazebo::joint;
use icub_model::hardware::{MOTORS_F32, SOLES_F32};
use icub_model::limits::LIMITS_F32;
use icub_model::{LIMITS, SOLES, profile};
use jump_control::Phase;
use nalgebra::Vector3;
use rbd_core::{Configuration, Motion, Tangent, Transform};
use wbc_qp::jump::{ComReference, TorqueJump, TorqueJumpSettings};
use wbc_qp::{Contact, Snapshot};

#[test]
fn the_squat_stands_on_both_soles_inside_its_limits() {
    let q = on_the_floor(squat());
    let poses = poses(&q);
    for sole in SOLES {
        let pose = poses.frame(&sole.frame);
        assert!(pose.translation.z.abs() < 1e-4);
        assert!((pose.rotation.matrix()[(2, 2)] - 1.0).abs() < 1e-6);
    }
    let c = com(&q);
    assert!((c.z - 0.38).abs() < 0.015, "{c:?}");
    assert!(c.x > -0.03 && c.x < 0.08, "{c:?}");
    for (q, limits) in q.joints.iter().zip(&LIMITS) {
        assert!(*q > limits.lower && *q < limits.upper);
    }
}

/// Names of the links that something presses on after so many ticks without torque.
fn touched(start: &State, ticks: u32, sim: Sim) -> Vec<&'static str> {
    let task = Task::named("icub/torque").unwrap();
    let mut world = plant(&task, sim, &Disturbance::NOMINAL, start).unwrap();
    for _ in 0..ticks {
        world.step(&[0.0; JOINTS], false).unwrap();
    }
    let plant = world.plant();
    let touches = execute::touches(plant.contact_forces_w(), plant.link_forces());
    touches.into_iter().map(|(name, _)| name).collect()
}

/// Every link has a shape: a robot that lies is carried by more than its soles, crossed legs meet, and one that stands touches nothing.
#[test]
fn links_touch_the_ground_and_each_other() {
    let sims: &[Sim] = if cfg!(feature = "mujoco") {
        &[Sim::Native, Sim::MUJOCO]
    } else {
        &[Sim::Native]
    };
    for sim in sims {
        let stands = on_the_floor(squat());
        assert_eq!(touched(&stands, 100, *sim), [""; 0]);
        let mut lies = stands;
        lies.base.rotation = so3::exp(&Vector3::new(0.0, core::f64::consts::FRAC_PI_2, 0.0));
        lies.base.translation = Vector3::new(0.0, 0.0, 0.3);
        let carried = touched(&lies, 8000, *sim);
        assert!(carried.contains(&"trunk"), "{sim:?}: {carried:?}");
        let mut crossed = squat();
        crossed[joint::L_HIP_ROLL] = LIMITS[joint::L_HIP_ROLL].lower;
        crossed[joint::R_HIP_ROLL] = LIMITS[joint::R_HIP_ROLL].lower;
        let mut flies = on_the_floor(crossed);
        flies.base.translation.z += 1.0;
        let met = touched(&flies, 3, *sim);
        let side = |side| met.iter().any(|name: &&str| name.starts_with(side));
        assert!(side("l_") && side("r_"), "{sim:?}: {met:?}");
    }
}

/// However the plant differs: every program is solved, what had to yield is counted, and no command leaves its limits. The
/// jump itself may suffer. The base is known from `state-est` alone.
#[test]
fn no_program_fails_whatever_the_plant_does() {
    let cases = [
        (0.6, ""),
        (1.0, "mass=1.1"),
        (1.0, "mass=0.9"),
        (1.0, "friction=0.4"),
        (1.0, "latency_ms=2"),
        (1.0, "noise"),
        (0.6, "mass=1.1,friction=0.4,latency_ms=2,noise"),
    ];
    for name in ["icub/velocity", "icub/torque"] {
        for (torque_share, plant) in cases {
            let disturbance = PlantArgument::plant(Some(&plant.parse().unwrap()), Lab::Icub, 1);
            let task = Task {
                torque_share,
                ..Task::named(name).unwrap()
            };
            let run = execute::run(&task, Sim::Native, &disturbance, 1, |_, _| {}).unwrap();
            let case = format!("{name} torque x {torque_share} {plant}");
            assert_eq!(run.qp.failures, 0, "{case}");
            // With 0.6 of the torques and all of the rest it may not even leave the ground.
            if torque_share == 1.0 {
                assert!(run.touchdown.is_some(), "{case}");
            } else if name == "icub/torque" {
                assert!(run.qp.relaxed_ticks > 0, "{case}");
            }
            // The base is an estimate in every run.
            assert!(run.estimate_error[0] > 0.0, "{case}");
            for sample in &run.samples {
                for (tau, motor) in sample.torques.iter().zip(task.motors()) {
                    assert!(tau.abs() <= motor.torque + 1e-9, "{case}");
                }
            }
        }
    }
}

fn jump(task: &Task, sim: Sim, plant: &str) -> Judged {
    let plant = PlantArgument::plant(Some(&plant.parse().unwrap()), Lab::Icub, 1);
    let run = execute::run(task, sim, &plant, 1, |_, _| {}).unwrap();
    Judged::of(task, &run)
}

/// What a nominal run must show with the landing program; the budgets have their own test.
fn lands_softly(name: &str, sim: Sim) {
    let task = Task::named(name).unwrap();
    let run = execute::run(&task, sim, &Disturbance::NOMINAL, 0, |_, _| {}).unwrap();
    let judged = Judged::of(&task, &run);
    for failure in &judged.verdict.failures {
        assert!(failure.name.starts_with("hardware"), "{name}: {failure:?}");
    }
    assert!(judged.upright && judged.locked_rotation < 1.5);
    assert!(run.landing_demand <= 1.0 + 1e-9, "{}", run.landing_demand);
    // Paper B, II-D: what the flight gains follows from the speed at its start.
    let height = judged.takeoff_speed * judged.takeoff_speed / (2.0 * GRAVITY);
    let drift = (height - judged.com_gain).abs();
    assert!(drift < 0.005, "{height} {}", judged.com_gain);

    let stiff = Task {
        landing: Landing::Stiff,
        ..task
    };
    let run = execute::run(&stiff, sim, &Disturbance::NOMINAL, 0, |_, _| {}).unwrap();
    assert!(run.landing_demand > 10.0 && run.landing_saturation > 0.05);

    let free = Task {
        momentum: false,
        ..task
    };
    let run = execute::run(&free, sim, &Disturbance::NOMINAL, 0, |_, _| {}).unwrap();
    assert!(Judged::of(&free, &run).locked_rotation > 4.0 * 1.5);
}

/// The rotors are in the plant, and a controller that does not know of them does not jump as it was told to.
#[test]
fn a_controller_has_to_know_the_rotors() {
    for name in ["icub/velocity", "icub/torque"] {
        let task = Task::named(name).unwrap();
        let blind = Task::variant(&format!("{name}+blind")).unwrap();
        assert!(task.knows_rotors && !blind.knows_rotors);
        let not_hardware = |judged: &Judged| {
            let failures = judged.verdict.failures.iter();
            failures.filter(|f| !f.name.starts_with("hardware")).count()
        };
        assert_eq!(not_hardware(&jump(&task, Sim::Native, "")), 0, "{name}");
        let without = jump(&blind, Sim::Native, "");
        assert!(not_hardware(&without) > 0, "{name}");
        // Where there are no rotors there is nothing to know.
        let light = jump(&blind, Sim::Native, "rotor=0");
        assert!(light.upright, "{name}");
    }
}

/// A robot that carries what its model does not know, with its centre of mass farther back, joints that rub and weak and slow motors gains the height
/// that it is asked for and stands.
#[test]
fn what_the_model_does_not_know_costs_no_height() {
    let task = Task::named("icub/torque").unwrap();
    let plant = "com_x=0.009,payload=0.7,joint_friction=1.9,torque_gain=0.96,rotor=1.25,current_lag_ms=4,latency_ms=1.5";
    let jump = jump(&task, Sim::Native, plant);
    assert!(jump.upright, "{}", jump.verdict.first());
    assert!(
        (jump.com_gain - task.height).abs() < GAIN,
        "{}",
        jump.com_gain
    );
}

/// Every part of the verdict can say no, and names what failed.
#[test]
fn verdicts_name_what_fails() {
    let task = Task::named("icub/torque").unwrap();
    let names = |task: &Task, plant: &str| {
        let failures = jump(task, Sim::Native, plant).verdict.failures;
        failures.into_iter().map(|f| f.name).collect::<Vec<_>>()
    };
    let has = |names: &[String], name: &str| names.iter().any(|x| x.starts_with(name));
    let low = names(
        &Task {
            torque_share: 0.5,
            ..task
        },
        "",
    );
    assert!(
        has(&low, "flight.com_gain_m") && has(&low, "hardware.saturation_ms.push_off"),
        "{low:?}"
    );
    let stiff = names(
        &Task {
            landing: Landing::Stiff,
            ..task
        },
        "",
    );
    assert!(has(&stiff, "hardware.saturation_ms.landing"), "{stiff:?}");
    // A floor that has fallen away is where the robot stands, as high over it as over another.
    let deep = names(&task, "ground_height=-0.1");
    assert!(!has(&deep, "stand.height_m"), "{deep:?}");
}

/// Names of variants, and what is none.
#[test]
fn variants_are_read() {
    let task = Task::variant("icub/velocity+stiff+3cm").unwrap();
    assert_eq!((task.landing, task.height), (Landing::Stiff, 0.03));
    assert_eq!(Task::variant("icub/torque"), Task::named("icub/torque"));
    for wrong in [
        "icub",
        "icub/torque+",
        "icub/torque+soft",
        "icub/torque+0cm",
        "icub/torque+nancm",
    ] {
        assert_eq!(Task::variant(wrong), None, "{wrong}");
    }
}

#[test]
fn both_jumps_land_softly() {
    lands_softly("icub/velocity", Sim::Native);
    lands_softly("icub/torque", Sim::Native);
}

#[cfg(feature = "mujoco")]
#[test]
fn mujoco_agrees_on_both_jumps() {
    lands_softly("icub/velocity", Sim::MUJOCO);
    lands_softly("icub/torque", Sim::MUJOCO);
}

/// The same states through the torque program in both precisions, tasks held: torques of a whole push-off. Where a limit is
/// about to bind, single precision may end on the active set beside the best one: that is one tick of this push-off, by
/// 3.3 N m, and the next tick is within 0.1 N m again.
#[test]
fn single_precision_follows_over_a_whole_push_off() {
    let task = Task::named("icub/torque").unwrap();
    let run = execute::run(&task, Sim::Native, &Disturbance::NOMINAL, 0, |_, _| {}).unwrap();
    let profile = task.profile().unwrap();
    let f = |x: f64| x as f32;
    let start = com(&on_the_floor(squat()));
    let mut double = TorqueJump::<f64, JOINTS, 12, 35, 61>::new(strict(), squat());
    let mut single = TorqueJump::<f32, JOINTS, 12, 35, 61>::new(strict(), squat().map(f));
    let soles = SOLES.map(|sole| Contact::new(&sole, 0.5, 1000.0));
    let soles_f32 = SOLES_F32.map(|sole| Contact::new(&sole, 0.5, 1000.0));
    let (mut s, mut s_f32) = (Snapshot::<f64, JOINTS>::ZERO, Snapshot::<f32, JOINTS>::ZERO);
    let (mut worst, mut apart, mut ticks) = (0.0_f64, 0, 0);
    for sample in run.samples.iter().filter(|s| s.phase == Phase::Stance) {
        let point = profile.at(sample.time);
        let wanted = |rise: f64, speed: f64, acceleration: f64| {
            (
                start + Vector3::z() * rise,
                Vector3::z() * speed,
                Vector3::z() * acceleration,
            )
        };
        let (position_w, velocity_w, acceleration_w) =
            wanted(point.rise, point.speed, point.acceleration);
        let q = State {
            base: Transform::new(sample.orientation.to_rotation_matrix(), sample.position),
            joints: sample.joints,
        };
        let v = Tangent {
            base: sample.base_velocity,
            joints: sample.joint_velocities,
        };
        s.update(&ROBOT, &q, &v);
        let reference = ComReference {
            position_w,
            velocity_w,
            acceleration_w,
        };
        let joints = (&LIMITS, &MOTORS);
        let a = double
            .tick(&ROBOT, &s, &soles, joints, &reference, 1e-3)
            .unwrap();
        let q = Configuration {
            base: Transform::new(
                nalgebra::Rotation3::from_matrix_unchecked(q.base.rotation.matrix().map(f)),
                q.base.translation.map(f),
            ),
            joints: q.joints.map(f),
        };
        let v = Tangent {
            base: Motion::from_array(v.base.to_array().map(f)),
            joints: v.joints.map(f),
        };
        s_f32.update(&ROBOT, &q, &v);
        let reference = ComReference {
            position_w: position_w.map(f),
            velocity_w: velocity_w.map(f),
            acceleration_w: acceleration_w.map(f),
        };
        let joints = (&LIMITS_F32, &MOTORS_F32);
        let b = single
            .tick(&ROBOT, &s_f32, &soles_f32, joints, &reference, 1e-3)
            .unwrap();
        let torques = a.answer.torques.iter().zip(b.answer.torques);
        let gap = torques
            .map(|(x, y)| (x - f64::from(y)).abs())
            .fold(0.0, f64::max);
        apart += usize::from(gap > 0.05);
        worst = worst.max(gap);
        ticks += 1;
    }
    assert!(
        ticks > 400 && apart <= 2 && worst < 5.0,
        "{apart} of {ticks} ticks are more than 0.05 N m apart, {worst} N m at worst"
    );
}

/// The states are those of another program's push-off: what moves the robot besides the strict one is not looked for.
fn strict<T: so3::Scalar>() -> TorqueJumpSettings<T, JOINTS> {
    TorqueJumpSettings {
        strict: true,
        surplus_gain: T::ZERO,
        ..profile::TORQUE.cast()
    }
}
