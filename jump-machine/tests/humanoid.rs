//! Every way in which the world may not keep its side of a humanoid's jump: late, missing, impossible.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use icub_model::profile::{self, Machine, Settings, Workspace};
use icub_model::{Icub23GazeboGeared, MOTORS};
use jump_control::{Fault, Measurement, Phase};
use jump_machine::humanoid::{Jump, Landing, PushOff, Work, middle_of_feet, on_the_floor};
use jump_machine::{JumpMachine, Observation, Refusal, Tick};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::{Just, ProptestConfig, Strategy, any, prop_assert, prop_oneof, proptest};
use rbd_core::{Configuration, Kinematics, Motion, Motor, Posture, forward_kinematics};
use wbc_qp::Patch;
use wbc_qp::jump::VelocityJumpSettings;

pub(super) const N: usize = 23;
pub(super) const ROBOT: Icub23GazeboGeared = Icub23GazeboGeared;
/// Largest rate of a torque in these tests, N m/s: the profile has none.
const SLEW: f64 = 1e5;
/// The push-off's end, and the apex after it, ms.
pub(super) const TAKEOFF: i32 = 435;
const APEX: i32 = TAKEOFF + 92;

pub(super) type Heard = Observation<f64, N, 2>;
pub(super) type Icub<'a> = Machine<'a, Icub23GazeboGeared>;

pub(super) fn settings() -> Settings {
    Settings {
        slew: SLEW,
        ..profile::SETTINGS
    }
}

pub(super) fn servos() -> Settings {
    Settings {
        push_off: PushOff::Velocity(profile::VELOCITY),
        landing: Landing::Servos(profile::COMPLIANT_SERVOS),
        ..settings()
    }
}

pub(super) fn standing(joints: &[f64; N]) -> Configuration<f64, N> {
    on_the_floor(&ROBOT, &profile::SOLE_CONTACTS, joints)
}

pub(super) fn jump() -> Jump<f64, N> {
    Jump {
        profile: profile::rise(profile::HEIGHT).unwrap(),
        start: standing(&profile::SQUAT),
        landing_joints: profile::LANDING_POSTURE,
    }
}

/// At rest in this posture, with this force on each sole.
pub(super) fn resting(joints: &[f64; N], force: f64) -> Heard {
    let q = standing(joints);
    Heard {
        measured: Measurement {
            base: q.base,
            base_velocity: Motion::ZERO,
            joints: q.joints,
            joint_velocities: [0.0; N],
            foot_forces: [force; 2],
            age: 0.0,
        },
        joint_torques: [0.0; N],
    }
}

/// Soles that are not symmetric, one a rectangle and one a triangle.
#[test]
fn the_middle_of_feet_is_that_of_their_soles() {
    let mut feet = profile::SOLE_CONTACTS;
    feet[0].shape = Patch::Rectangle {
        x: [-0.02, 0.10],
        y: [-0.01, 0.05],
    };
    feet[1].shape = Patch::Polygon {
        vertices: &[[0.09, -0.03], [-0.06, 0.0], [0.03, 0.06]],
    };
    let mut poses = Kinematics::IDENTITY;
    let squat = Posture::new(&ROBOT, &standing(&profile::SQUAT));
    forward_kinematics(&ROBOT, &squat, &mut poses);
    let at = |k: usize, x, y| poses.frame(&feet[k].frame).point(&Vector3::new(x, y, 0.0));
    let middle = (at(0, 0.04, 0.02) + at(1, 0.02, 0.01)) * 0.5;
    assert!((middle_of_feet(&poses, &feet) - middle).amax() < 1e-12);
}

pub(super) fn ground() -> Heard {
    resting(&profile::SQUAT, 162.0)
}

pub(super) fn air() -> Heard {
    resting(&profile::LANDING_POSTURE, 0.0)
}

pub(super) fn landed() -> Heard {
    resting(&profile::LANDING_POSTURE, 162.0)
}

/// What is heard at this millisecond of a jump.
pub(super) fn at(k: i32) -> Heard {
    match k {
        ..TAKEOFF => ground(),
        TAKEOFF..=560 => air(),
        _ => landed(),
    }
}

/// Ticks from millisecond `from` up to `to`, with the joints as they are heard; the last answer.
pub(super) fn run<M: JumpMachine<f64, N, 2>>(
    machine: &mut M,
    from: i32,
    to: i32,
    heard: &Heard,
) -> Tick<M::Work> {
    let mut last = None;
    for k in from..to {
        last = Some(machine.tick(f64::from(k) * 1e-3, Some(heard)));
        for _ in 0..10 {
            machine.joint_tick(&heard.measured.joints, &[0.0; N], 1e-4);
        }
    }
    last.unwrap()
}

pub(super) fn with<R>(settings: Settings, test: impl FnOnce(&mut Icub<'_>) -> R) -> R {
    let mut workspace = Box::new(Workspace::new(&settings));
    test(&mut Machine::new(&ROBOT, settings, &mut workspace))
}

/// A jump that goes well, from standing to standing.
fn whole(m: &mut Icub<'_>, start: i32) {
    m.arm(&jump(), 1e-3 * f64::from(start)).unwrap();
    assert_eq!(m.arm(&jump(), 10.0), Err(Refusal::NotStanding));
    let run = |m: &mut Icub<'_>, from: i32, to: i32, heard: &Heard| {
        let tick = run(m, start + from, start + to, heard);
        assert_eq!((tick.fault, tick.refusal), (None, None));
        tick.phase
    };
    assert_eq!(run(m, -20, 0, &ground()), Phase::Hold);
    assert_eq!(run(m, 0, TAKEOFF, &ground()), Phase::Stance);
    assert_eq!(run(m, TAKEOFF, APEX - 2, &air()), Phase::Flight);
    assert_eq!(run(m, APEX - 2, APEX + 2, &air()), Phase::PreLanding);
    assert_eq!(run(m, APEX + 2, 640, &landed()), Phase::Landing);
    assert_eq!(run(m, 640, 780, &landed()), Phase::Stand);
}

#[test]
fn a_jump_goes_through_its_phases_and_another_may_follow() {
    for settings in [settings(), servos()] {
        with(settings, |m| {
            assert_eq!(run(m, 0, 30, &landed()).phase, Phase::Stand);
            whole(m, 50);
            whole(m, 850);
        });
    }
}

#[test]
fn each_phase_has_the_controller_that_the_settings_name() {
    for (settings, servos) in [(settings(), false), (servos(), true)] {
        with(settings, |m| {
            m.arm(&jump(), 0.0).unwrap();
            for k in -20..700 {
                let work = run(m, k, k + 1, &at(k)).work;
                match m.phase() {
                    Phase::Hold | Phase::Stance => assert!(matches!(work, Work::PushOff(Ok(_)))),
                    _ if servos => assert_eq!(work, Work::Servos),
                    _ => assert!(matches!(work, Work::Landing(Ok(_)))),
                }
                // Programs of torques command torques, all else positions.
                let torques = m.command().feed_forward.iter().any(|tau| *tau != 0.0);
                assert_eq!(torques, !servos);
            }
        });
    }
}

#[test]
fn a_robot_that_lies_does_not_stand_and_is_not_armed() {
    with(settings(), |m| {
        let mut lying = landed();
        lying.measured.base.rotation = Rotation3::new(Vector3::y() * 0.6);
        assert_eq!(run(m, 0, 20, &landed()).phase, Phase::Stand);
        assert_eq!(run(m, 20, 400, &lying).phase, Phase::Landing);
        assert_eq!(m.arm(&jump(), 0.5), Err(Refusal::Tilted));
        assert_eq!(run(m, 400, 620, &landed()).phase, Phase::Stand);
    });
}

#[test]
fn a_jump_that_cannot_begin_is_refused_with_its_reason_and_the_robot_stands_on() {
    with(settings(), |m| {
        run(m, 0, 20, &landed());
        for start in [0.010, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(m.arm(&jump(), start), Err(Refusal::TooLate));
        }
        for k in 0..3 {
            let mut bad = jump();
            match k {
                0 => bad.landing_joints[3] = f64::NAN,
                1 => bad.start.joints[22] = f64::INFINITY,
                _ => bad.start.base.translation.z = f64::NAN,
            }
            assert_eq!(m.arm(&bad, 0.1), Err(Refusal::NotFinite));
        }
        let tick = run(m, 20, 21, &landed());
        assert_eq!((tick.phase, tick.refusal), (Phase::Stand, None));
        // It stands in the landing posture: the first joint of the squat that is elsewhere is the left hip.
        m.arm(&jump(), 0.05).unwrap();
        let tick = run(m, 21, 60, &landed());
        assert_eq!(
            (tick.phase, tick.refusal),
            (Phase::Stand, Some(Refusal::Posture(0)))
        );
        assert_eq!(tick.fault, None);
        assert!(matches!(tick.work, Work::Landing(Ok(_))));
    });
}

/// The push-off would run after it with all its torque.
#[test]
fn a_jump_that_begins_elsewhere_is_refused_at_once() {
    with(settings(), |m| {
        run(m, 0, 20, &landed());
        let mut elsewhere = jump();
        elsewhere.start.base.translation.x += 0.04;
        m.arm(&elsewhere, 0.5).unwrap();
        let tick = run(m, 20, 21, &ground());
        assert_eq!(
            (tick.phase, tick.refusal),
            (Phase::Stand, Some(Refusal::Place))
        );
        elsewhere.start.base.translation.x -= 0.02;
        m.arm(&elsewhere, 0.5).unwrap();
        assert_eq!(run(m, 21, 60, &ground()).phase, Phase::Hold);
    });
}

#[test]
fn missing_measurements_are_bridged_for_ten_milliseconds_and_ticks_for_five_and_then_named() {
    let (good, still) = (landed(), [0.0; N]);
    with(settings(), |m| {
        assert_eq!(m.tick(0.0, None).fault, None);
    });
    with(settings(), |m| {
        run(m, 0, 20, &good);
        for k in 20..29 {
            assert_eq!(m.tick(f64::from(k) * 1e-3, None).fault, None);
        }
        // Ten ages of a millisecond are ten milliseconds but for rounding.
        m.tick(0.029, None);
        assert_eq!(m.tick(0.030, None).fault, Some(Fault::Stale));
        assert_eq!(m.phase(), Phase::Abort);
    });
    with(settings(), |m| {
        run(m, 0, 20, &good);
        for _ in 0..39 {
            m.joint_tick(&good.measured.joints, &still, 1e-4);
        }
        assert_eq!(m.fault(), None);
        for _ in 0..3 {
            m.joint_tick(&good.measured.joints, &still, 1e-3);
        }
        assert_eq!(m.fault(), Some(Fault::Silent));
    });
    with(settings(), |m| {
        run(m, 0, 20, &good);
        assert_eq!(m.tick(0.0235, Some(&good)).fault, None);
        assert_eq!(m.tick(0.030, Some(&good)).fault, Some(Fault::Silent));
    });
    for now in [0.019, 0.0, f64::NAN, f64::INFINITY, -f64::INFINITY] {
        with(settings(), |m| {
            run(m, 0, 20, &good);
            assert_eq!(m.tick(now, Some(&good)).fault, Some(Fault::Clock), "{now}");
        });
    }
    for dt in [0.0, -1e-4, f64::NAN, 1.0] {
        with(settings(), |m| {
            run(m, 0, 20, &good);
            let torques = m.joint_tick(&good.measured.joints, &still, dt);
            assert!(torques.iter().all(|tau| tau.is_finite()));
            assert_eq!(m.fault(), Some(Fault::Clock));
        });
    }
}

#[test]
fn no_ground_is_given_up_a_second_after_the_take_off() {
    with(settings(), |m| {
        m.arm(&jump(), 0.0).unwrap();
        run(m, -20, TAKEOFF, &ground());
        let tick = run(m, TAKEOFF, TAKEOFF + 998, &air());
        assert_eq!(tick.phase, Phase::PreLanding);
        let tick = run(m, TAKEOFF + 998, TAKEOFF + 1003, &air());
        assert_eq!((tick.phase, tick.work), (Phase::Abort, Work::Damping));
    });
}

/// One sole's sensor is dead: the other one's finds the ground, and only its contact carries.
#[test]
fn a_dead_sole_sensor_does_not_end_the_jump() {
    for dead in 0..2 {
        with(settings(), |m| {
            m.arm(&jump(), 0.0).unwrap();
            for k in -20..1000 {
                let mut heard = at(k);
                heard.measured.foot_forces[dead] = 0.0;
                assert_eq!(run(m, k, k + 1, &heard).fault, None);
            }
            assert!(matches!(m.phase(), Phase::Landing | Phase::Stand));
        });
    }
}

/// Data that are no numbers leave a program without an answer: the last command stays for five milliseconds, and then the joints are
/// damped.
#[test]
fn a_program_without_an_answer_ends_in_damping() {
    let mut wrong = settings();
    wrong.feet[1].friction = f64::NAN;
    let velocity = Settings {
        push_off: PushOff::Velocity(VelocityJumpSettings {
            com_weight: f64::NAN,
            ..profile::VELOCITY
        }),
        ..settings()
    };
    for settings in [wrong, velocity] {
        with(settings, |m| {
            m.arm(&jump(), 0.0).unwrap();
            for k in -20..-14 {
                let tick = run(m, k, k + 1, &ground());
                if k < -15 {
                    assert!(matches!(tick.work, Work::PushOff(Err(_))), "{k}");
                    assert_eq!(tick.fault, None);
                }
            }
            let tick = run(m, -14, -12, &ground());
            assert_eq!(tick.fault, Some(Fault::Unsolved));
            assert_eq!((tick.phase, tick.work), (Phase::Abort, Work::Damping));
        });
    }
    // The landing's program likewise.
    let landing = |settings: Settings| {
        with(settings, |m| {
            let tick = run(m, 0, 8, &landed());
            (tick.phase, tick.fault)
        })
    };
    assert_eq!(landing(wrong), (Phase::Abort, Some(Fault::Unsolved)));
    assert_eq!(landing(settings()), (Phase::Stand, None));
}

/// Motors with a hundredth of their torque cannot do what is asked for: the centre of mass misses it, which the answer tells, and the torques
/// stay inside their limits.
#[test]
fn an_impossible_jump_misses_its_profile_and_stays_inside_the_motors() {
    let weak: [Motor<f64>; N] = MOTORS.map(|motor| Motor {
        torque: 0.01 * motor.torque,
        ..motor
    });
    let settings = Settings {
        motors: weak,
        ..settings()
    };
    with(settings, |m| {
        m.arm(&jump(), 0.0).unwrap();
        let mut missed = 0;
        for k in -20..1000 {
            let tick = run(m, k, k + 1, &at(k));
            assert_eq!(tick.fault, None, "{k}");
            if let Work::PushOff(Ok(solved)) | Work::Landing(Ok(solved)) = tick.work {
                missed += u32::from(solved.residuals.com > 1.0);
            }
            let torques = m.joint_tick(&at(k).measured.joints, &[0.0; N], 1e-4);
            for (tau, motor) in torques.iter().zip(&weak) {
                assert!(tau.abs() <= motor.torque);
            }
        }
        assert!(missed > 400, "{missed}");
    });
}

/// Between two ticks of the program the servos' targets move on at the speed asked for.
#[test]
fn servos_go_on_between_ticks() {
    let settings = Settings {
        slew: f64::INFINITY,
        ..servos()
    };
    with(settings, |m| {
        m.arm(&jump(), 0.0).unwrap();
        for k in -20..400 {
            m.tick(f64::from(k) * 1e-3, Some(&ground()));
            if k < 399 {
                m.joint_tick(&ground().measured.joints, &[0.0; N], 1e-4);
            }
        }
        let command = *m.command();
        let q = command.position;
        let first = m.joint_tick(&q, &command.velocity, 1e-4);
        let second = m.joint_tick(&q, &command.velocity, 1e-4);
        let knee = 3;
        let rise = second[knee] - first[knee];
        let wanted = command.gains[knee].stiffness * command.velocity[knee] * 1e-4;
        assert!(wanted.abs() > 1e-3);
        let off = (rise - wanted).abs();
        assert!(off < 1e-9 * wanted.abs().max(1.0), "{rise} {wanted}");
    });
}

/// Memory that was made for a push-off by velocities and a landing by servos serves the programs of torques as well.
#[test]
fn memory_of_another_push_off_is_made_anew() {
    let mut workspace = Box::new(Workspace::new(&servos()));
    let mut m: Icub<'_> = Machine::new(&ROBOT, settings(), &mut workspace);
    m.arm(&jump(), 0.0).unwrap();
    let tick = run(&mut m, -20, -10, &ground());
    assert!(matches!(tick.work, Work::PushOff(Ok(_))));
    assert!(m.command().feed_forward.iter().any(|tau| *tau != 0.0));
}

/// Puts `bad` in one place of what one tick hears; returns the encoders, the joints' step of time and the clock of that tick.
fn spoil(place: usize, bad: f64, heard: &mut Heard, now: &mut f64) -> ([f64; N], [f64; N], f64) {
    let (mut q, mut qd, mut dt) = (heard.measured.joints, [0.0; N], 1e-4);
    let (kind, i) = (place / N, place % N);
    let x = &mut heard.measured;
    match kind {
        0 => x.joints[i] = bad,
        1 => x.joint_velocities[i] = bad,
        2 => q[i] = bad,
        3 => qd[i] = bad,
        _ if i < 3 => x.base.translation[i] = bad,
        _ if i < 6 => x.base_velocity.linear[i - 3] = bad,
        _ if i < 9 => x.base_velocity.angular[i - 6] = bad,
        _ if i < 18 => {
            let mut matrix: Matrix3<f64> = *x.base.rotation.matrix();
            matrix[i - 9] = bad;
            x.base.rotation = Rotation3::from_matrix_unchecked(matrix);
        }
        _ if i < 20 => x.foot_forces[i - 18] = bad,
        _ if i < 21 => x.age = bad,
        _ if i < 22 => *now = bad,
        _ => dt = bad,
    }
    (q, qd, dt)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    /// One impossible number, in any input of either loop, at any tick: torques stay finite, inside the motors' limits and without
    /// steps, and the machine aborts with a fault.
    #[test]
    fn one_impossible_number_anywhere(
        tick in -10_i32..600,
        place in 0_usize..5 * N,
        servo in any::<bool>(),
        bad in prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300), Just(-1e30),
            any::<f64>().prop_filter("not a robot's", |x| x.is_nan() || x.abs() > 1e6),
        ],
    ) {
        let settings = if servo { servos() } else { settings() };
        with(settings, |m| {
            m.arm(&jump(), 0.0).unwrap();
            let mut last = [0.0; N];
            for k in -20..(tick + 20) {
                let mut heard = at(k);
                let still = heard.measured.joints;
                let mut now = f64::from(k) * 1e-3;
                let (mut q, mut qd, mut dt) = (still, [0.0; N], 1e-4);
                if k == tick {
                    (q, qd, dt) = spoil(place, bad, &mut heard, &mut now);
                }
                m.tick(now, Some(&heard));
                for j in 0..10 {
                    let torques = match j {
                        0 => m.joint_tick(&q, &qd, dt),
                        _ => m.joint_tick(&still, &[0.0; N], 1e-4),
                    };
                    for ((tau, before), motor) in torques.iter().zip(&last).zip(&MOTORS) {
                        prop_assert!(tau.is_finite() && tau.abs() <= motor.torque);
                        prop_assert!((tau - before).abs() <= SLEW * 1e-4 + 1e-9);
                    }
                    last = torques;
                }
                if k < tick {
                    prop_assert!(m.fault().is_none());
                } else {
                    prop_assert!(m.fault().is_some() && m.phase() == Phase::Abort);
                }
            }
            // At rest, damped joints carry nothing.
            prop_assert!(last.iter().all(|tau| tau.abs() < 1e-9));
            Ok(())
        })?;
    }
}
