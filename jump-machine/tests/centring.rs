//! A robot whose centre of mass is aside moves its trunk before it jumps, and keeps its feet under its centre of mass until it lands.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{Measurement, Node, Phase, Plan, Torques};
use jump_machine::{Jump, Machine, Observation, Refusal, Settings, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, GRAVITY, Limbs, Motion, Transform, center_of_mass};

const TAKEOFF: f64 = 0.2;
const POSING: f64 = 0.3;
const TOUCHDOWN: f64 = 0.5;

fn crouch() -> [f64; 12] {
    core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3])
}

fn legs(joints: &[f64; 12]) -> Limbs<f64, 12, 4> {
    let q = Configuration {
        joints: *joints,
        ..Configuration::NEUTRAL
    };
    Limbs::new(&A1Geared, &q, &FEET.map(|foot| foot.frame))
}

/// Normal forces, N, that hold a crouching robot whose centre of mass is farther by `aside_b`: a part that is linear in the places of the feet, which stand on a rectangle.
fn loads(aside_b: &Vector3<f64>) -> [f64; 4] {
    let legs = legs(&crouch());
    let com = center_of_mass(&A1Geared, &legs.posture);
    let middle = legs
        .ends
        .iter()
        .map(|end| end.position)
        .sum::<Vector3<f64>>()
        / 4.0;
    let way = com.position_w + aside_b - middle;
    let spread = legs.ends[0].position - middle;
    legs.ends.map(|end| {
        let arm = end.position - middle;
        let share = way.x * arm.x / (spread.x * spread.x) + way.y * arm.y / (spread.y * spread.y);
        0.25 * com.mass * -GRAVITY[2] * (1.0 + share)
    })
}

/// Standing on feet with these loads, or in the air.
fn heard(loads: Option<[f64; 4]>) -> Observation<f64, 12, 4> {
    let foot_forces = loads.unwrap_or_default();
    let legs = legs(&crouch());
    let mut joint_torques = rbd_core::generalized_gravity(&A1Geared, &legs.posture).joints;
    for (end, load) in legs.ends.iter().zip(&foot_forces) {
        end.add_tr_mul(&(Vector3::z() * -load), &mut joint_torques);
    }
    Observation {
        measured: Measurement {
            base: Transform::new(Rotation3::identity(), Vector3::z() * 0.3),
            base_velocity: Motion::ZERO,
            joints: crouch(),
            joint_velocities: [0.0; 12],
            foot_forces,
            age: 0.0,
        },
        joint_torques,
    }
}

/// A crouch.
fn nodes() -> [Node<f64, 12, 4>; 3] {
    [-0.001, 0.0, 0.6].map(|time| Node {
        time,
        joints: crouch(),
        ..Node::ZERO
    })
}

fn jump(nodes: &[Node<f64, 12, 4>]) -> Jump<'_, f64, 12, 4> {
    Jump {
        plan: Plan::new(nodes, TAKEOFF, POSING, TOUCHDOWN, Torques::Hold).unwrap(),
        rot_goal: Rotation3::identity(),
        landing_joints: crouch(),
    }
}

fn settings() -> Settings<f64, 12, 4> {
    Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch())
}

/// By how much every foot that is commanded is farther than planned, base axes: at the start of the push-off, late in it, in flight, and before the ground.
fn shifts(most: f64, aside_b: &Vector3<f64>) -> Vec<[Vector3<f64>; 4]> {
    let nodes = nodes();
    let mut settings = settings();
    settings.centring.most = most;
    let mut workspace = Workspace::new();
    let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
    machine.arm(jump(&nodes), 0.0).unwrap();
    let planned = legs(&crouch()).ends.map(|end| end.position);
    let mut found = Vec::new();
    for k in -500..480 {
        let stands = k < 200;
        let tick = machine.tick(
            f64::from(k) * 1e-3,
            Some(&heard(stands.then(|| loads(aside_b)))),
        );
        assert_eq!(tick.fault, None);
        let phase = match k {
            -260 | -1 => Phase::Hold,
            150 => Phase::Stance,
            250 => Phase::Flight,
            470 => Phase::PreLanding,
            _ => continue,
        };
        assert_eq!(tick.phase, phase, "{k}");
        let feet = legs(&machine.command().position).ends;
        found.push(core::array::from_fn(|i| feet[i].position - planned[i]));
    }
    found
}

#[test]
fn feet_are_as_much_farther_as_the_centre_of_mass_is() {
    let aside_b = Vector3::new(0.012, -0.008, 0.0);
    let found = shifts(0.04, &aside_b);
    for (feet, wanted) in found.iter().zip([0.0, 1.0, 1.0, 1.0, 1.0]) {
        for way in feet {
            // Joints are moved to first order.
            assert!((way - aside_b * wanted).norm() < 1e-3, "{way} {wanted}");
        }
    }
}

#[test]
fn an_offset_that_is_not_believed_moves_nothing() {
    let aside_b = Vector3::new(0.012, -0.008, 0.0);
    for most in [0.0, 0.01] {
        for way in shifts(most, &aside_b).iter().flatten() {
            assert!(way.norm() < 1e-9, "{way}");
        }
    }
}

/// The push-off begins where the trunk has moved to: a robot that followed begins it, and one that stayed where the plan begins is refused.
#[test]
fn a_robot_begins_where_its_trunk_has_moved_to() {
    let (nodes, mut settings) = (nodes(), settings());
    settings.start_tolerance = 0.01;
    for follows in [true, false] {
        let mut workspace = Workspace::new();
        let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
        machine.arm(jump(&nodes), 0.0).unwrap();
        let mut last = None;
        for k in -500..=0 {
            let mut heard = heard(Some(loads(&Vector3::new(0.012, -0.008, 0.0))));
            if follows && k > -200 {
                heard.measured.joints = machine.command().position;
            }
            last = Some(machine.tick(f64::from(k) * 1e-3, Some(&heard)));
        }
        let tick = last.unwrap();
        if follows {
            assert_eq!((tick.phase, tick.refusal), (Phase::Stance, None));
        } else {
            assert_eq!(tick.phase, Phase::Stand);
            assert!(matches!(tick.refusal, Some(Refusal::Posture(_))));
        }
    }
}

/// While the trunk moves each tick moves one leg, each leg every fourth tick.
#[test]
fn legs_take_turns_to_move_the_trunk() {
    let (nodes, mut workspace) = (nodes(), Workspace::new());
    let mut machine = Machine::new(&A1Geared, settings(), &mut workspace);
    machine.arm(jump(&nodes), 0.0).unwrap();
    let heard = heard(Some(loads(&Vector3::new(0.012, -0.008, 0.0))));
    let mut moved = Vec::new();
    for k in -500..-100 {
        let before = machine.command().position;
        machine.tick(f64::from(k) * 1e-3, Some(&heard));
        let now = machine.command().position;
        if k >= -200 {
            let legs = (0..4).filter(|leg| (3 * leg..3 * leg + 3).any(|j| now[j] != before[j]));
            moved.push(legs.collect::<Vec<_>>());
        }
    }
    assert!(moved.iter().all(|legs| legs.len() == 1), "{moved:?}");
    for turns in moved.windows(5) {
        let mut legs = turns[..4].concat();
        legs.sort_unstable();
        assert!(legs == [0, 1, 2, 3] && turns[4] == turns[0], "{turns:?}");
    }
}
