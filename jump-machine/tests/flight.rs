//! What the robot does about a flight that is not the planned one: another tilt, another turn.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{Measurement, Node, Phase, Plan, Torques};
use jump_machine::{Jump, Machine, Observation, Settings, Workspace};
use landing::PreLanding;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::{prop_assert, prop_assert_eq, proptest};
use rbd_core::{
    CentroidalMap, Configuration, Frame, GRAVITY, Limbs, Motion, Posture, Tangent, Transform,
    centroidal_map,
};

pub(super) const TAKEOFF: f64 = 0.2;
pub(super) const TOUCHDOWN: f64 = 0.8;
/// Time in the landing posture before the touchdown.
pub(super) const POSED: f64 = 0.05;

pub(super) fn crouch() -> [f64; 12] {
    core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3])
}

pub(super) fn feet() -> [Frame<f64>; 4] {
    FEET.map(|foot| foot.frame)
}

/// Where the base is `time` after take-off, and how fast it rises.
pub(super) fn ballistic(height: f64, speed: f64, time: f64) -> (f64, f64) {
    let g = -GRAVITY[2];
    (height + (speed - 0.5 * g * time) * time, speed - g * time)
}

/// A plan that rises with 2.5 m/s from 0.35 m and turns with `rate` about y in flight.
pub(super) fn nodes(rate: f64) -> Vec<Node<f64, 12, 4>> {
    let node = |time: f64| {
        let flown = (time - TAKEOFF).max(0.0);
        let (height, speed) = match flown {
            0.0 => (0.35, 2.5),
            _ => ballistic(0.35, 2.5, flown),
        };
        let rotation = so3::exp(&(Vector3::y() * (rate * flown)));
        let speed_b = rotation.inverse() * Vector3::new(0.0, 0.0, speed);
        Node {
            time,
            base: Transform::new(rotation, Vector3::new(0.0, 0.0, height)),
            base_velocity: Motion::new(speed_b, Vector3::y() * rate),
            joints: crouch(),
            ..Node::ZERO
        }
    };
    let flight = (0..=120).map(|k| node(TAKEOFF + 0.005 * f64::from(k)));
    [node(-0.001), node(0.0)]
        .into_iter()
        .chain(flight)
        .collect()
}

pub(super) fn jump(nodes: &[Node<f64, 12, 4>]) -> Jump<'_, f64, 12, 4> {
    Jump {
        plan: Plan::new(nodes, TAKEOFF, TOUCHDOWN - POSED, TOUCHDOWN, Torques::Hold).unwrap(),
        rot_goal: Rotation3::identity(),
        landing_joints: crouch(),
    }
}

/// The robot in the air, as the world has it.
pub(super) fn flying(
    base: Transform<f64>,
    vel_w: Vector3<f64>,
    omega_b: Vector3<f64>,
) -> Observation<f64, 12, 4> {
    Observation {
        measured: Measurement {
            base,
            base_velocity: Motion::new(base.rotation.inverse() * vel_w, omega_b),
            joints: crouch(),
            joint_velocities: [0.0; 12],
            foot_forces: [0.0; 4],
            age: 0.0,
        },
        joint_torques: [0.0; 12],
    }
}

/// A flight from `height` with `speed` that turns with `rate`, to the `end` on the caller's clock; what `watch` makes of each
/// millisecond in the air.
pub(super) fn fly<R>(
    settings: &Settings<f64, 12, 4>,
    nodes: &[Node<f64, 12, 4>],
    (height, speed, rate): (f64, f64, f64),
    end: f64,
    mut watch: impl FnMut(f64, &Machine<'_, f64, A1Geared, 12, 4>) -> Option<R>,
) -> Option<R> {
    let mut workspace = Workspace::new();
    let mut machine = Machine::new(&A1Geared, *settings, &mut workspace);
    machine.arm(jump(nodes), 0.0).unwrap();
    for k in -500.. {
        let t = f64::from(k) * 1e-3;
        if t > end {
            break;
        }
        let flown = (t - TAKEOFF).max(0.0);
        let (z, vz) = ballistic(height, speed, flown);
        let rotation = so3::exp(&(Vector3::y() * (rate * flown)));
        let base = Transform::new(rotation, Vector3::new(0.0, 0.0, z));
        let omega = Vector3::y() * if t < TAKEOFF { 0.0 } else { rate };
        let heard = flying(base, Vector3::new(0.0, 0.0, vz), omega);
        machine.tick(t, Some(&heard));
        machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
        if t >= TAKEOFF
            && let Some(found) = watch(t, &machine)
        {
            return Some(found);
        }
    }
    None
}

proptest! {
    /// The legs take up the landing posture when the plan says, whatever the take-off was.
    #[test]
    fn the_landing_posture_is_taken_up_on_the_plans_time(height in 0.31..0.39, speed in 2.2..2.8) {
        let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
        let posing = fly(&settings, &nodes(0.0), (height, speed, 0.0), 1.0, |t, machine| {
            (machine.phase() == Phase::PreLanding).then_some(t)
        });
        // A millisecond of the tick.
        prop_assert!((posing.unwrap() - (TOUCHDOWN - POSED)).abs() < 1.5e-3, "{posing:?}");
    }

    /// Before the ground, feet are where the body's tilt wants them: legs that do not give way show where that is.
    #[test]
    fn feet_follow_the_tilt_before_the_ground(tilt in -0.4..0.4_f64, rate in -8.0..8.0_f64) {
        let mut settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
        (settings.retraction.share, settings.shortening.most) = (0.0, 0.0);
        // These plans begin wherever their flight has to.
        settings.most_tilt = core::f64::consts::PI;
        let nodes = nodes(rate);
        // The plan's rotation is shifted by the tilt with which the body will arrive.
        let nodes: Vec<_> = nodes
            .into_iter()
            .map(|mut node| {
                let end = so3::exp(&(Vector3::y() * (tilt - rate * (TOUCHDOWN - TAKEOFF))));
                let speed_w = node.base.rotation * node.base_velocity.linear;
                node.base.rotation = end * node.base.rotation;
                node.base_velocity.linear = node.base.rotation.inverse() * speed_w;
                node
            })
            .collect();
        let mut workspace = Workspace::new();
        let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
        machine.arm(jump(&nodes), 0.0).unwrap();
        let (mut k, mut time) = (-500_i32, -0.5_f64);
        while time < TOUCHDOWN - 0.002 {
            let node = nodes.iter().rfind(|node| node.time <= time).unwrap_or(&nodes[0]);
            let ahead = time - node.time;
            let turn = so3::exp(&(node.base_velocity.angular * if time < TAKEOFF { 0.0 } else { ahead }));
            let vel_w = node.base.rotation * node.base_velocity.linear;
            let flown = if time < TAKEOFF { 0.0 } else { ahead };
            let (z, vz) = ballistic(node.base.translation.z, vel_w.z, flown);
            let base = Transform::new(node.base.rotation * turn, Vector3::new(0.0, 0.0, z));
            machine.tick(time, Some(&flying(base, Vector3::new(0.0, 0.0, vz), node.base_velocity.angular)));
            machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
            k += 1;
            time = f64::from(k) * 1e-3;
        }
        prop_assert_eq!(machine.phase(), Phase::PreLanding);
        let posture = PreLanding { joints: crouch(), ..settings.posture };
        let up_b: Vector3<f64> = so3::exp(&(Vector3::y() * -tilt)) * Vector3::z();
        let expected = place(&posture.joints(&A1Geared, &up_b, &Vector3::zeros()));
        let found = place(&machine.command().position);
        for (found, expected) in found.iter().zip(&expected) {
            prop_assert!((found - expected).norm() < 5e-3, "{found} {expected}");
        }
    }

    /// A body that is behind its plan draws its legs in, one that is ahead stretches them, and both let go before the touchdown.
    #[test]
    fn legs_are_drawn_in_when_the_turn_is_late_and_stretched_when_it_is_early(rate in 5.0..12.0, off in 0.03..0.1) {
        let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
        for sign in [-1.0, 1.0] {
            let nodes = nodes(rate);
            let flight = (0.35, 2.5, rate * (1.0 + sign * off));
            let mut longest = 0.0_f64;
            let mut last = 0.0;
            fly(&settings, &nodes, flight, TOUCHDOWN - POSED - 0.001, |_, machine| {
                let reach = |joints: &[f64; 12]| place(joints)[0].xz().norm();
                last = reach(&machine.command().position) - reach(&crouch());
                if last.abs() > longest.abs() {
                    longest = last;
                }
                None::<()>
            });
            prop_assert!(longest * sign > 0.01, "{longest}");
            prop_assert!(last.abs() < 2e-3, "{last}");
        }
    }
}

/// A flight of the planned length at whose end a level body falls at `fall`, as high as planned.
pub(super) fn arriving_at(fall: f64) -> (f64, f64, f64) {
    let (lasting, g) = (TOUCHDOWN - TAKEOFF, -GRAVITY[2]);
    let speed = g * lasting - fall;
    (0.35 + (2.5 - speed) * lasting, speed, 0.0)
}

/// A base that turns only because the legs swing stops turning when they do: it is level at the touchdown.
#[test]
fn what_legs_turn_by_swinging_is_no_tilt() {
    let mut settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    (settings.retraction.share, settings.shortening.most) = (0.0, 0.0);
    let swinging: [f64; 12] = core::array::from_fn(|i| [0.0, 3.0, 0.0][i % 3]);
    let mut v = Tangent::ZERO;
    v.joints = swinging;
    let q = Configuration {
        joints: crouch(),
        ..Configuration::NEUTRAL
    };
    let mut map = CentroidalMap::ZERO;
    centroidal_map(&A1Geared, &Posture::new(&A1Geared, &q), &mut map);
    // Together with what the legs do this is no angular momentum.
    let omega_b = -map.locked_angular_velocity(&map.momentum(&v));
    assert!(omega_b.norm() > 0.3, "{omega_b}");
    let (mut workspace, nodes) = (Workspace::new(), nodes(0.0));
    let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
    machine.arm(jump(&nodes), 0.0).unwrap();
    let (height, speed, _) = arriving_at(1.5);
    let mut velocity = Vector3::zeros();
    for k in -500..795 {
        let t = f64::from(k) * 1e-3;
        let (z, vz) = ballistic(height, speed, (t - TAKEOFF).max(0.0));
        // Fast enough that the capture point is outside the feet, where every tilt would move them.
        velocity = Vector3::new(1.5, 0.0, vz);
        let base = Transform::new(Rotation3::identity(), Vector3::new(0.0, 0.0, z));
        let mut heard = flying(base, velocity, omega_b);
        heard.measured.joint_velocities = swinging;
        if t > TOUCHDOWN - POSED {
            machine.tick(t, Some(&heard));
        } else {
            machine.tick(t, Some(&flying(base, velocity, Vector3::zeros())));
        }
        machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
    }
    assert_eq!(machine.phase(), Phase::PreLanding);
    let posture = PreLanding {
        joints: crouch(),
        ..settings.posture
    };
    let level = place(&posture.joints(&A1Geared, &Vector3::z(), &velocity));
    for (found, level) in place(&machine.command().position).iter().zip(&level) {
        assert!((found - level).norm() < 2e-4, "{found} {level}");
    }
}

/// Velocities, relative to the base and base axes, with which the command moves the feet of a crouching robot.
pub(super) fn foot_velocities(machine: &Machine<'_, f64, A1Geared, 12, 4>) -> [Vector3<f64>; 4] {
    let q = Configuration {
        joints: crouch(),
        ..Configuration::NEUTRAL
    };
    let velocities = &machine.command().velocity;
    Limbs::new(&A1Geared, &q, &feet())
        .ends
        .map(|end| end.mul(velocities))
}

#[test]
fn feet_near_the_ground_go_along_with_it() {
    let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    let gentle = settings.retraction.gentle;
    for fall in [1.4, 1.7, 1.9] {
        let mut began = 0.0_f64;
        let flight = arriving_at(fall);
        fly(
            &settings,
            &nodes(0.0),
            flight,
            TOUCHDOWN - 0.0005,
            |t, machine| {
                if t < TOUCHDOWN - 0.05 {
                    return None::<()>;
                }
                let falls = fall - (TOUCHDOWN - t) * -GRAVITY[2];
                for foot in foot_velocities(machine) {
                    if foot.z == 0.0 {
                        assert_eq!(began, 0.0);
                        continue;
                    }
                    // The Tikhonov term takes some of the way.
                    assert!((foot.z - (falls - gentle)).abs() < 0.02 * falls, "{foot}");
                    assert!(foot.xy().norm() < 0.01, "{foot}");
                    if began == 0.0 {
                        began = TOUCHDOWN - t;
                    }
                }
                None
            },
        );
        // From a centimetre above the ground on.
        assert!((began - 0.01 / fall).abs() < 2.5e-3, "{began}");
    }
    // Slow feet are left alone, and a fast fall needs the whole legs.
    for fall in [1.0, 3.1] {
        let flight = arriving_at(fall);
        fly(
            &settings,
            &nodes(0.0),
            flight,
            TOUCHDOWN - 0.0005,
            |t, machine| {
                if t > TOUCHDOWN - 0.009 {
                    assert_eq!(foot_velocities(machine), [Vector3::zeros(); 4]);
                }
                None::<()>
            },
        );
    }
}

/// One foot is on the ground and the body still falls: the other feet go on for 40 ms, then stand as the robot will.
#[test]
fn feet_that_are_still_in_the_air_go_on_when_one_has_touched() {
    let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    let (mut workspace, nodes, fall) = (Workspace::new(), nodes(0.0), 1.5);
    let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
    let jump = jump(&nodes);
    machine.arm(jump, 0.0).unwrap();
    let (height, speed, _) = arriving_at(fall);
    let mut last = [0.0; 12];
    for k in -500..=870 {
        let t = f64::from(k) * 1e-3;
        let flown = (t - TAKEOFF).clamp(0.0, TOUCHDOWN - TAKEOFF);
        let (z, vz) = ballistic(height, speed, flown);
        let base = Transform::new(Rotation3::identity(), Vector3::new(0.0, 0.0, z));
        let mut heard = flying(base, Vector3::new(0.0, 0.0, vz), Vector3::zeros());
        if t >= TOUCHDOWN {
            heard.measured.foot_forces = [60.0, 0.0, 0.0, 0.0];
            heard.measured.base.translation.z -= 0.001;
        }
        machine.tick(t, Some(&heard));
        machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
        if t < TOUCHDOWN + 0.001 {
            continue;
        }
        assert_eq!(machine.phase(), Phase::Landing);
        let [first, others @ ..] = foot_velocities(&machine);
        let (stands, waits) = machine.command().position.split_at(3);
        assert_eq!(first, Vector3::zeros());
        let goes_on = t < TOUCHDOWN + 0.0385;
        for foot in others {
            if goes_on {
                assert!((foot.z - (fall - 1.0)).abs() < 0.02, "{t} {foot}");
            } else if t > TOUCHDOWN + 0.041 {
                assert_eq!(foot, Vector3::zeros());
                assert_eq!(waits, &jump.landing_joints[3..]);
            }
        }
        if goes_on {
            last[..3].copy_from_slice(stands);
            last[3..].copy_from_slice(waits);
        }
    }
    let raised = place(&last)[3].z - place(&crouch())[3].z;
    let way = (fall - 1.0) * (0.01 / fall + 0.039);
    assert!((raised - way).abs() < 2e-3, "{raised}");
}

/// Legs wait shorter for a ground that would tear their joints along at more than 20 rad/s, unless that would not help.
#[test]
fn legs_wait_shorter_for_a_fast_ground() {
    let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    // At the end, and the most on the way.
    let course = |settings: &Settings<f64, 12, 4>, fall: f64| {
        let (mut raised, mut most) = (0.0, 0.0_f64);
        fly(
            settings,
            &nodes(0.0),
            arriving_at(fall),
            TOUCHDOWN - 0.012,
            |_, machine| {
                raised = place(&machine.command().position)[0].z - place(&crouch())[0].z;
                most = most.max(raised);
                None::<()>
            },
        );
        (raised, most)
    };
    let raised = |fall: f64| course(&settings, fall).0;
    // The knees of this crouch turn by 7 rad for a metre of fall.
    for slow in [1.0, 2.0, 2.8] {
        assert!(raised(slow).abs() < 1e-4, "{}", raised(slow));
    }
    assert!((0.003..0.035).contains(&raised(3.1)), "{}", raised(3.1));
    assert!(raised(5.0).abs() < 1e-4, "{}", raised(5.0));
    // Legs with no more stroke than the fall takes wait long, also while it is not as fast as it will be.
    let most = |stroke: f64| {
        let mut settings = settings;
        let law = &mut settings.shortening;
        law.travel = stroke * 3.1 * 3.1 / (2.0 * law.deceleration);
        course(&settings, 3.1).1
    };
    assert!(most(1.1) > 1e-3 && most(0.99) < 1e-4);
}

pub(super) fn place(joints: &[f64; 12]) -> [Vector3<f64>; 4] {
    let q = Configuration {
        joints: *joints,
        ..Configuration::NEUTRAL
    };
    Limbs::new(&A1Geared, &q, &feet())
        .ends
        .map(|end| end.position)
}

/// The plan's torques of the flight come a lookahead early, and not at once to legs whose feet are on the ground still: those are only pulled up at first.
#[test]
fn legs_swing_when_their_feet_have_let_go() {
    let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    let mut nodes = nodes(0.0);
    for node in nodes.iter_mut().filter(|node| node.time >= TAKEOFF) {
        node.torques = [5.0; 12];
    }
    let mut workspace = Workspace::new();
    let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
    machine.arm(jump(&nodes), 0.0).unwrap();
    let mut heard = flying(
        Transform::new(Rotation3::identity(), Vector3::z() * 0.35),
        Vector3::z() * 2.5,
        Vector3::zeros(),
    );
    heard.measured.foot_forces = [0.0, 0.0, 100.0, 100.0];
    let q = heard.measured.configuration();
    let limbs = Limbs::new(&A1Geared, &q, &feet());
    let mut pulled = [0.0; 12];
    for end in &limbs.ends {
        end.add_tr_mul(&(Vector3::z() * settings.unloading.pull), &mut pulled);
    }
    let from = TAKEOFF - settings.lookahead;
    let lifted = from + settings.unloading.letting_go;
    let (mut swung, mut others) = (0, 0);
    for k in -500..=240 {
        let t = f64::from(k) * 1e-3;
        machine.tick(t, Some(&heard));
        machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
        let ordered = &machine.command().feed_forward;
        let early = t < from - 1e-9;
        if early && machine.phase() != Phase::Stance {
            continue;
        }
        for (j, ordered) in ordered.iter().enumerate() {
            let wanted = match j {
                _ if early => 0.0,
                0..6 => 5.0,
                _ if t < lifted => pulled[j],
                _ => 5.0 + pulled[j],
            };
            assert!(
                (ordered - wanted).abs() < 1e-9,
                "{t}, joint {j}: {ordered}, {wanted}"
            );
        }
        if early { others += 1 } else { swung += 1 }
    }
    assert!(swung > 40 && others > 150, "{swung}, {others}");
}
