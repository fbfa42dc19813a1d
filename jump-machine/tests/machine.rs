//! Every way in which the world may not keep its side: late, missing, impossible.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{Fault, Measurement, Node, Phase, Plan, Torques};
use jump_machine::Workspace;
use jump_machine::regulator::NODES_PER_TICK;
use jump_machine::{Jump, Machine, Observation, Refusal, Settings, Work};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::{
    Just, ProptestConfig, Strategy, any, prop_assert, prop_assert_eq, prop_oneof, proptest,
};
use rbd_core::{Frame, Motion, Motor, Transform};
use so3::Scalar;

type A1Machine<'a, T> = Machine<'a, T, A1Geared, 12, 4>;

fn crouch<T: Scalar>() -> [T; 12] {
    core::array::from_fn(|i| T::of([0.0, 0.8, -1.6][i % 3]))
}

/// A push-off of 0.2 s and a flight of 0.2 s that go nowhere: enough for the machine's clockwork.
fn nodes<T: Scalar>() -> [Node<T, 12, 4>; 3] {
    [-0.001, 0.0, 0.4].map(|time| Node {
        time: T::of(time),
        joints: crouch(),
        torques: core::array::from_fn(|i| T::of([0.5, 2.0, 6.0][i % 3])),
        ..Node::ZERO
    })
}

fn jump<T: Scalar>(nodes: &[Node<T, 12, 4>]) -> Jump<'_, T, 12, 4> {
    let [takeoff, posing, touchdown] = [0.2, 0.35, 0.4].map(T::of);
    Jump {
        plan: Plan::new(nodes, takeoff, posing, touchdown, Torques::Hold).unwrap(),
        rot_goal: Rotation3::identity(),
        landing_joints: crouch(),
    }
}

fn inputs<T: Scalar>() -> Observation<T, 12, 4> {
    Observation {
        measured: Measurement {
            base: Transform::new(
                Rotation3::identity(),
                Vector3::new(T::ZERO, T::ZERO, T::of(0.3)),
            ),
            base_velocity: Motion::ZERO,
            joints: crouch(),
            joint_velocities: [T::ZERO; 12],
            foot_forces: [T::of(33.7); 4],
            age: T::ZERO,
        },
        // −Jᵀf of feet that each carry a quarter of the robot.
        joint_torques: core::array::from_fn(|i| {
            T::of([-2.824, 0.0, 4.835, 2.824, 0.0, 4.835][i % 6])
        }),
    }
}

fn in_air() -> Observation<f64, 12, 4> {
    let mut heard = inputs();
    heard.measured.foot_forces = [0.0; 4];
    heard.joint_torques = [0.0; 12];
    heard
}

fn machine(workspace: &mut Workspace<f64, 12, 4>) -> A1Machine<'_, f64> {
    let settings = Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch());
    Machine::new(&A1Geared, settings, workspace)
}

/// Ticks from millisecond `from` up to `to`, with the joints at rest in between; the last answer.
fn run(
    machine: &mut A1Machine<'_, f64>,
    from: i32,
    to: i32,
    heard: &Observation<f64, 12, 4>,
) -> Option<jump_machine::Tick> {
    let mut last = None;
    for k in from..to {
        last = Some(machine.tick(f64::from(k) * 1e-3, Some(heard)));
        for _ in 0..10 {
            machine.joint_tick(&heard.measured.joints, &[0.0; 12], 1e-4);
        }
    }
    last
}

/// Where the joints are when it is armed, the command begins; where the plan begins, it ends, and nothing moves faster than a minimum jerk does.
#[test]
fn legs_gather_to_where_the_plan_begins_without_a_jolt() {
    let (mut workspace, nodes) = (Workspace::new(), nodes());
    let mut m = machine(&mut workspace);
    let mut ground = inputs();
    let ways = core::array::from_fn::<f64, 12, _>(|i| 0.02 * (i as f64 - 5.5));
    for (joint, way) in ground.measured.joints.iter_mut().zip(&ways) {
        *joint -= way;
    }
    let settings =
        Settings::<f64, 12, 4>::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch());
    let gathering = (settings.gathering * 1e3).round() as i32;
    run(&mut m, -1300, -1200, &ground);
    m.arm(jump(&nodes), 0.0).unwrap();
    let mut last = ground.measured.joints;
    // Then the trunk begins to move.
    for k in -1200..-250 {
        run(&mut m, k, k + 1, &ground);
        let command = m.command();
        for (i, way) in ways.iter().enumerate() {
            let (step, now) = (command.position[i] - last[i], command.position[i]);
            let fastest = 1.875 * way.abs() / settings.gathering + 1e-9;
            assert!(
                step * way >= 0.0 && step.abs() <= fastest * 1e-3,
                "{k}: {step}"
            );
            assert!(command.velocity[i] * way >= 0.0 && command.velocity[i].abs() <= fastest);
            if k >= -1200 + gathering {
                assert!((now - crouch::<f64>()[i]).abs() < 1e-12, "{k}: {now}");
            }
        }
        last = command.position;
    }
}

#[test]
fn a_jump_goes_through_its_phases_and_another_may_follow() {
    let (mut workspace, nodes) = (Workspace::new(), nodes());
    let mut m = machine(&mut workspace);
    let (ground, air) = (inputs(), in_air());
    assert_eq!(
        run(&mut m, -1300, -1200, &ground).unwrap().phase,
        Phase::Stand
    );
    m.arm(jump(&nodes), 0.0).unwrap();
    assert_eq!(m.arm(jump(&nodes), 0.0), Err(Refusal::NotStanding));
    assert_eq!(run(&mut m, -1200, 0, &ground).unwrap().phase, Phase::Hold);
    assert_eq!(run(&mut m, 0, 200, &ground).unwrap().phase, Phase::Stance);
    assert_eq!(run(&mut m, 200, 350, &air).unwrap().phase, Phase::Flight);
    let waiting = run(&mut m, 350, 360, &air).unwrap();
    assert_eq!(
        (waiting.phase, waiting.work),
        (Phase::PreLanding, Work::Cartesian)
    );
    let down = run(&mut m, 360, 370, &ground).unwrap();
    assert_eq!(down.phase, Phase::Landing);
    assert!(matches!(
        down.work,
        Work::Landing(landing::Outcome::Solved(_))
    ));
    assert_eq!(run(&mut m, 370, 700, &ground).unwrap().phase, Phase::Stand);
    m.arm(jump(&nodes), 1.9).unwrap();
    assert_eq!(
        run(&mut m, 700, 1901, &ground).unwrap().phase,
        Phase::Stance
    );
}

/// A robot that stands is pushed: it balances as after a landing, until it is at rest again.
#[test]
fn a_robot_that_is_pushed_lands_again() {
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    assert_eq!(run(&mut m, 0, 100, &inputs()).unwrap().phase, Phase::Stand);
    let mut pushed = inputs();
    pushed.measured.base_velocity.linear.x = 1.0;
    assert_eq!(
        run(&mut m, 100, 110, &pushed).unwrap().phase,
        Phase::Landing
    );
    assert_eq!(
        run(&mut m, 110, 500, &inputs()).unwrap().phase,
        Phase::Stand
    );
}

/// A robot at rest stands as long as it is tilted by less than the settings say, about whatever axis. One that lies does not, and is given no jump
/// until it is on its feet; one that is tipped over in its hold does not push off.
#[test]
fn a_robot_that_lies_does_not_stand_and_does_not_jump() {
    let (ground, nodes) = (inputs(), nodes());
    let settings = Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch());
    let most: f64 = settings.most_tilt;
    proptest!(ProptestConfig::with_cases(20), |(axis in -3.2..3.2, turn in -3.2..3.2, share in 0.0..0.99, over in 0.01..1.0)| {
        let tilted = |by: f64| {
            let mut heard = ground;
            let tilt = so3::exp(&(so3::exp(&(Vector3::z() * axis)) * Vector3::x() * by));
            heard.measured.base.rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), turn) * tilt;
            heard
        };
        let (leaning, lying) = (tilted(share * most), tilted(most + over * (3.1 - most)));
        let mut workspace = Workspace::new();
        let mut m = machine(&mut workspace);
        prop_assert_eq!(run(&mut m, 0, 50, &leaning).unwrap().phase, Phase::Stand);
        m.arm(jump(&nodes), 1.3).unwrap();
        prop_assert_eq!(run(&mut m, 50, 1300, &leaning).unwrap().phase, Phase::Hold);
        let tick = run(&mut m, 1300, 1301, &lying).unwrap();
        prop_assert_eq!((tick.phase, tick.refusal), (Phase::Stand, Some(Refusal::Tilted)));
        prop_assert_eq!(run(&mut m, 1301, 2000, &lying).unwrap().phase, Phase::Landing);
        prop_assert_eq!(m.arm(jump(&nodes), 4.0), Err(Refusal::Tilted));
        prop_assert_eq!(run(&mut m, 2000, 2250, &leaning).unwrap().phase, Phase::Stand);
        prop_assert_eq!(m.arm(jump(&nodes), 4.0), Ok(()));
    });
}

/// Shares of their way that torques have gone after a joint tick, of the joints that have one: until then a leg was where it should be, now it is not.
fn shares(machine: &mut A1Machine<'_, f64>) -> Vec<f64> {
    let bent = core::array::from_fn(|i| crouch::<f64>()[i] + [0.02, -0.1, 0.15][i % 3]);
    let mut after = |q: &[f64; 12], ticks: usize| {
        let torques = (0..ticks).map(|_| machine.joint_tick(q, &[0.0; 12], 1e-4));
        torques.last().unwrap()
    };
    // Less than five milliseconds in all, after which a machine without a tick is silent.
    let from = after(&crouch(), 20);
    let between = after(&bent, 1);
    let last = after(&bent, 25);
    let ways = from.iter().zip(between).zip(last);
    let ways = ways.filter(|((from, _), last)| (last - *from).abs() > 0.1);
    ways.map(|((from, between), last)| (between - from) / (last - from))
        .collect()
}

/// Torques of a plan go straight to what they are to be, all by the same share of their way.
#[test]
fn torques_of_a_plan_keep_their_direction() {
    let (nodes, mut workspace) = (nodes(), Workspace::new());
    let mut machine = machine(&mut workspace);
    machine.arm(jump(&nodes), 1.0).unwrap();
    machine.tick(0.0, Some(&inputs()));
    assert_eq!(machine.phase(), Phase::Hold);
    let shares = shares(&mut machine);
    assert!(shares.len() > 4);
    for share in &shares {
        assert!(
            (share - shares[0]).abs() < 1e-9 && *share < 0.9,
            "{shares:?}"
        );
    }
}

#[test]
fn a_late_plan_and_a_plan_for_another_posture_are_refused_and_the_robot_stands_on() {
    let (mut workspace, nodes) = (Workspace::new(), nodes());
    let mut m = machine(&mut workspace);
    run(&mut m, 0, 100, &inputs());
    for start in [0.05, 1.15, f64::NAN, f64::INFINITY] {
        assert_eq!(m.arm(jump(&nodes), start), Err(Refusal::TooLate));
        assert_eq!(m.phase(), Phase::Stand);
    }
    let mut elsewhere = nodes;
    elsewhere[0].joints[7] += 0.2;
    m.arm(jump(&elsewhere), 1.3).unwrap();
    let tick = run(&mut m, 100, 1302, &inputs()).unwrap();
    assert_eq!(
        (tick.phase, tick.refusal),
        (Phase::Stand, Some(Refusal::Posture(7)))
    );
    assert_eq!(tick.fault, None);
}

/// The push-off begins with its gains or not at all: a start that leaves too few ticks for the nodes of the plan is refused, when it is armed if the time is
/// known by then, else at the start.
#[test]
fn a_start_before_the_gains_are_computed_is_refused() {
    let time = |k: i32| f64::from(k) * 1e-3;
    let many: Vec<_> = (-1..2000)
        .map(|k| Node {
            time: time(k),
            ..nodes()[0]
        })
        .collect();
    // The trunk moves for the last 0.25 s, and no gains are computed then.
    let ticks = 250 + i32::try_from(2001_usize.div_ceil(NODES_PER_TICK)).unwrap();
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    let settings = Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch());
    // A tick to begin with, and one for each pair of nodes.
    let least: f64 = settings.least_hold(&jump(&many).plan);
    assert!((least - time(ticks + 1)).abs() < 1e-9, "{least}");
    // No tick has told the time yet.
    m.arm(jump(&many), time(ticks - 3)).unwrap();
    let tick = run(&mut m, 0, ticks - 1, &inputs()).unwrap();
    assert_eq!(
        (tick.phase, tick.refusal),
        (Phase::Stand, Some(Refusal::TooLate))
    );
    let now = ticks - 2;
    assert_eq!(m.arm(jump(&many), time(now + ticks)), Err(Refusal::TooLate));
    let start = now + ticks + 2;
    m.arm(jump(&many), time(start)).unwrap();
    assert_eq!(
        run(&mut m, now + 1, start, &inputs()).unwrap().phase,
        Phase::Hold
    );
    let tick = run(&mut m, start, start + 2, &inputs()).unwrap();
    assert_eq!((tick.phase, tick.refusal), (Phase::Stance, None));
}

#[test]
fn missing_measurements_are_bridged_for_ten_milliseconds_and_ticks_for_five_and_then_named() {
    let still = [0.0; 12];
    let good = inputs();
    // The first measurement may be as late as others may be old.
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    for k in 0..9 {
        let tick = m.tick(f64::from(k) * 1e-3, None);
        assert_eq!((tick.fault, tick.work), (None, Work::Damping));
    }
    m.tick(0.009, None);
    assert_eq!(m.tick(0.010, None).fault, Some(Fault::Stale));
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    run(&mut m, 0, 20, &good);
    // Measurements.
    for k in 20..29 {
        assert_eq!(m.tick(f64::from(k) * 1e-3, None).fault, None);
    }
    // Ten ages of a millisecond are ten milliseconds but for rounding.
    m.tick(0.029, None);
    assert_eq!(m.tick(0.030, None).fault, Some(Fault::Stale));
    assert_eq!(m.phase(), Phase::Abort);
    // Ticks of 1 kHz, as the joints see it.
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    run(&mut m, 0, 20, &good);
    for _ in 0..39 {
        m.joint_tick(&good.measured.joints, &still, 1e-4);
    }
    assert_eq!(m.fault(), None);
    for _ in 0..3 {
        m.joint_tick(&good.measured.joints, &still, 1e-4);
    }
    assert_eq!(m.fault(), Some(Fault::Silent));
    // And as the next tick sees it, when the joints were missing as well.
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    run(&mut m, 0, 20, &good);
    assert_eq!(m.tick(0.0235, Some(&good)).fault, None);
    assert_eq!(m.tick(0.030, Some(&good)).fault, Some(Fault::Silent));
    // Clocks.
    for now in [0.019, 0.0, f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let mut workspace = Workspace::new();
        let mut m = machine(&mut workspace);
        run(&mut m, 0, 20, &good);
        assert_eq!(m.tick(now, Some(&good)).fault, Some(Fault::Clock), "{now}");
    }
    for dt in [0.0, -1e-4, f64::NAN, 1.0] {
        let mut workspace = Workspace::new();
        let mut m = machine(&mut workspace);
        run(&mut m, 0, 20, &good);
        assert!(
            m.joint_tick(&good.measured.joints, &still, dt)
                .iter()
                .all(|t| t.is_finite())
        );
        assert_eq!(m.fault(), Some(Fault::Clock));
    }
}

/// What was heard last grows older by the time that passes, also where every other tick is missed.
#[test]
fn missed_ticks_do_not_keep_measurements_young() {
    let mut workspace = Workspace::new();
    let mut m = machine(&mut workspace);
    run(&mut m, 0, 20, &inputs());
    for k in [21, 23, 25, 27] {
        assert_eq!(m.tick(f64::from(k) * 1e-3, None).fault, None);
    }
    // Now it is as old as it may be, but for rounding.
    m.tick(0.029, None);
    assert_eq!(m.tick(0.031, None).fault, Some(Fault::Stale));
}

#[test]
fn no_ground_is_given_up() {
    let (mut workspace, nodes) = (Workspace::new(), nodes());
    let mut m = machine(&mut workspace);
    m.arm(jump(&nodes), 0.0).unwrap();
    run(&mut m, -500, 200, &inputs());
    assert_eq!(
        run(&mut m, 200, 900, &in_air()).unwrap().phase,
        Phase::PreLanding
    );
    assert_eq!(
        run(&mut m, 900, 902, &in_air()).unwrap().phase,
        Phase::Abort
    );
}

#[test]
fn single_precision_goes_the_same_way() {
    let nodes = nodes::<f32>();
    let mut workspace = Workspace::new();
    let feet = a1_model::FEET.map(|foot| Frame {
        link: foot.frame.link,
        offset: foot.frame.offset.map(|x| x as f32),
        ..Frame::IDENTITY
    });
    let motors = MOTORS.map(|m| Motor {
        gear: m.gear as f32,
        torque: m.torque as f32,
        corner_speed: m.corner_speed as f32,
        no_load_speed: m.no_load_speed as f32,
        rotor_inertia: m.rotor_inertia as f32,
    });
    let settings = Settings::new(&BUILD.cast(), feet, motors, crouch());
    let mut m: A1Machine<'_, f32> = Machine::new(&A1Geared, settings, &mut workspace);
    m.arm(jump(&nodes), 0.0).unwrap();
    for k in -500..600_i32 {
        let mut heard = inputs();
        if (200..360).contains(&k) {
            heard.measured.foot_forces = [0.0; 4];
            heard.joint_torques = [0.0; 12];
        }
        let tick = m.tick(k as f32 * 1e-3, Some(&heard));
        assert_eq!(tick.fault, None, "{k}");
        for _ in 0..10 {
            let torques = m.joint_tick(&heard.measured.joints, &[0.0; 12], 1e-4);
            assert!(torques.iter().all(|t| t.abs() <= 33.5));
        }
    }
    assert!(matches!(m.phase(), Phase::Landing | Phase::Stand));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    /// One impossible number, in any input of either loop, at any tick: torques stay finite, inside the motors' limits and without
    /// steps; the machine aborts with a fault unless the number is only evidence.
    #[test]
    fn one_impossible_number_anywhere(
        tick in -500_i32..600,
        place in 0_usize..84,
        bad in prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300), Just(-1e30),
            any::<f64>().prop_filter("not a robot's", |x| x.is_nan() || x.abs() > 1e6),
        ],
    ) {
        let (mut workspace, nodes) = (Workspace::new(), nodes());
        let mut m = machine(&mut workspace);
        m.arm(jump(&nodes), 0.0).unwrap();
        let mut last = [0.0; 12];
        // What joints feel is only evidence of contact.
        let evidence = place >= 72;
        for k in -500..(tick + 50) {
            let mut heard = if (200..360).contains(&k) { in_air() } else { inputs() };
            let (mut q, mut qd, mut dt) = (crouch(), [0.0; 12], 1e-4);
            let mut now = f64::from(k) * 1e-3;
            if k == tick {
                let i = place % 12;
                let x = &mut heard.measured;
                match place / 12 {
                    0 => x.joints[i] = bad,
                    1 => x.joint_velocities[i] = bad,
                    2 if i < 3 => x.base.translation[i] = bad,
                    2 if i < 6 => x.base_velocity.linear[i - 3] = bad,
                    2 if i < 9 => x.base_velocity.angular[i - 6] = bad,
                    2 => x.base.rotation =
                        Rotation3::from_matrix_unchecked(nalgebra::Matrix3::repeat(bad)),
                    3 if i < 4 => x.foot_forces[i] = bad,
                    3 if i < 7 => x.age = bad,
                    3 if i < 10 => now = bad,
                    3 => dt = bad,
                    4 => q[i] = bad,
                    5 => qd[i] = bad,
                    _ => heard.joint_torques[i] = bad,
                }
            }
            m.tick(now, Some(&heard));
            for j in 0..10 {
                let torques = if j == 0 {
                    m.joint_tick(&q, &qd, dt)
                } else {
                    m.joint_tick(&crouch(), &[0.0; 12], 1e-4)
                };
                for ((tau, before), motor) in torques.iter().zip(&last).zip(&MOTORS) {
                    prop_assert!(tau.is_finite() && tau.abs() <= motor.torque);
                    prop_assert!((tau - before).abs() <= 1.0 + 1e-9);
                }
                last = torques;
            }
            if k < tick || evidence {
                prop_assert!(m.fault().is_none());
            } else {
                prop_assert!(m.fault().is_some() && m.phase() == Phase::Abort);
            }
        }
        if m.phase() == Phase::Abort {
            // At rest, damped joints carry nothing.
            prop_assert!(last.iter().all(|tau| tau.abs() < 1e-9));
        }
    }
}
