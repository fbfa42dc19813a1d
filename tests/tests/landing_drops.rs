//! Closed loop: A1 dropped on its feet, landing controller against the native simulator.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, FEET, FOOT_RADIUS, MOTORS, a1};
use contact_sim::{ContactSphere, NativeSimulator, Simulator, Terrain};
use jump_control::{JointCommand, JointGains};
use landing::{ContactFilter, Landing, Outcome, Settings, Target, TouchdownState, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Link, Motion, Tangent};

type Plant = NativeSimulator<f64, A1Geared, 12, 12>;

/// Feet and trunk corners.
fn plant() -> Plant {
    let spheres = core::array::from_fn(|i| match FEET.get(i) {
        Some(foot) => ContactSphere::of(foot).unwrap(),
        None => {
            let side = |bit: usize| if (i >> bit) & 1 == 0 { 1.0 } else { -1.0 };
            ContactSphere {
                link: Link::Base,
                offset: [0.1235 * side(0), 0.087 * side(1), 0.047 * side(2)],
                radius: 0.01,
            }
        }
    });
    let settings = contact_sim::Settings::new(&a1::LIMITS, &MOTORS);
    Plant::new(A1Geared, spheres, Terrain::FLAT, settings)
}

/// Legs under and 4 cm outside the hips, 0.29 m long.
const POSTURE: [f64; 12] = [
    0.14, 0.77, -1.54, -0.14, 0.77, -1.54, 0.14, 0.77, -1.54, -0.14, 0.77, -1.54,
];

/// What a drop ended in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct End {
    upright: bool,
    trunk_touched: bool,
    at_rest: bool,
    failures: u32,
}

impl End {
    fn good(&self) -> bool {
        self.upright && !self.trunk_touched && self.at_rest
    }
}

/// Drops the robot so that its lowest foot starts `height` above the floor; `dead` is a foot whose sensor reads 0.
fn drop(height: f64, roll: f64, pitch: f64, sideways: f64, dead: Option<usize>) -> End {
    let mut plant = plant();
    let mut q = Configuration {
        joints: POSTURE,
        ..Configuration::NEUTRAL
    };
    q.base.rotation = Rotation3::from_euler_angles(roll, pitch, 0.0);
    let mut kinematics = rbd_core::Kinematics::IDENTITY;
    rbd_core::forward_kinematics(
        &A1Geared,
        &rbd_core::Posture::new(&A1Geared, &q),
        &mut kinematics,
    );
    let feet = FEET.map(|foot| foot.frame);
    let low = feet
        .iter()
        .map(|f| kinematics.frame(f).translation.z)
        .fold(f64::INFINITY, f64::min);
    q.base.translation.z = height + FOOT_RADIUS - low;
    let along = q.base.rotation.inverse() * Vector3::new(0.0, sideways, 0.0);
    let mut start = Tangent::ZERO;
    start.base = Motion::new(along, Vector3::zeros());
    plant.reset(&q, &start);

    let landing = Landing::<f64, 12, 4, 12, 28>::new(feet, Settings::a1(), [33.5; 12]);
    let mut workspace = Workspace::new();
    let (filter, mut contact) = (ContactFilter::new(), TouchdownState::<f64, 4>::new());
    let target = Target {
        height: 0.25,
        ..Target::LEVEL
    };
    let mut end = End {
        upright: false,
        trunk_touched: false,
        at_rest: false,
        failures: 0,
    };
    for _ in 0..3000 {
        let mut forces: [f64; 4] = core::array::from_fn(|i| plant.contact_forces_w()[i].norm());
        if let Some(foot) = dead {
            forces[foot] = 0.0;
        }
        filter.update(&mut contact, &forces, 1e-3);
        let (q, v) = (*plant.configuration(), *plant.velocity());
        let c = landing.step(
            &A1Geared,
            &q,
            &v,
            &contact.contacts,
            &target,
            &POSTURE,
            &mut workspace,
        );
        end.failures += u32::from(!matches!(c.outcome, Outcome::Solved(_) | Outcome::Airborne));
        let command = JointCommand {
            position: c.position,
            velocity: [0.0; 12],
            feed_forward: c.feed_forward,
            gains: core::array::from_fn(|i| JointGains {
                stiffness: c.stiffness[i],
                damping: c.damping[i],
            }),
        };
        for _ in 0..10 {
            let torques = command.torques(
                &plant.configuration().joints,
                &plant.velocity().joints,
                &MOTORS,
            );
            plant.step(&torques).unwrap();
            end.trunk_touched |= plant.contact_forces_w()[4..].iter().any(|f| f.norm() > 0.0);
        }
    }
    let up = plant.configuration().base.rotation * Vector3::z();
    end.upright = up.z > so3::math::cos(10_f64.to_radians());
    end.at_rest = plant.velocity().base.linear.norm() < 0.05;
    end
}

/// The eighteen drops of one height: roll or pitch by 0, ±10 and ±20 degrees, at rest or at 0.5 m/s sideways.
fn drops() -> impl Iterator<Item = (f64, f64, f64)> {
    let tilts = [
        (0.0, 0.0),
        (10.0, 0.0),
        (-10.0, 0.0),
        (20.0, 0.0),
        (-20.0, 0.0),
        (0.0, 10.0),
        (0.0, -10.0),
        (0.0, 20.0),
        (0.0, -20.0),
    ];
    tilts.into_iter().flat_map(|(roll, pitch): (f64, f64)| {
        [0.0, 0.5].map(|sideways| (roll.to_radians(), pitch.to_radians(), sideways))
    })
}

fn good_drops(height: f64) -> usize {
    let ends: Vec<End> = drops()
        .map(|(r, p, v)| drop(height, r, p, v, None))
        .collect();
    assert!(
        ends.iter().all(|end| end.failures == 0),
        "a QP failed: {ends:?}"
    );
    let good = ends.iter().filter(|end| end.good()).count();
    println!(
        "drop of {height} m: {good} of {} upright, at rest, trunk untouched",
        ends.len()
    );
    good
}

#[test]
fn eighteen_of_eighteen_drops_from_30_cm_are_landed() {
    assert_eq!(good_drops(0.3), 18);
}

#[test]
fn drops_from_half_a_metre_are_landed() {
    assert_eq!(good_drops(0.5), 18);
}

#[test]
fn a_dead_foot_sensor_does_not_fell_the_robot() {
    for foot in 0..4 {
        let end = drop(0.3, 0.1, 0.0, 0.0, Some(foot));
        assert!(end.upright && !end.trunk_touched, "foot {foot}: {end:?}");
    }
}
