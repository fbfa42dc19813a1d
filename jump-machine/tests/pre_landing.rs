//! When the legs begin to follow the body before the ground, and feet of a body that turns.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, MOTORS};
use jump_control::Phase;
use jump_machine::{Machine, Settings, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::Transform;

use super::flight::{
    POSED, TAKEOFF, TOUCHDOWN, arriving_at, ballistic, crouch, feet, fly, flying, foot_velocities,
    jump, nodes, place,
};

/// Up to the time of levelling legs keep to the plan however fast the body is, then they go after the point over which it can come to rest.
#[test]
fn legs_follow_the_body_from_the_time_of_levelling_on() {
    let mut settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    settings.levelling = 0.4 * POSED;
    let (mut workspace, nodes) = (Workspace::new(), nodes(0.0));
    let mut machine = Machine::new(&A1Geared, settings, &mut workspace);
    machine.arm(jump(&nodes), 0.0).unwrap();
    let (height, speed, _) = arriving_at(0.9);
    let (mut before, mut after) = (0, 0);
    for k in -500..799 {
        let t = f64::from(k) * 1e-3;
        let (z, vz) = ballistic(height, speed, (t - TAKEOFF).max(0.0));
        let base = Transform::new(Rotation3::identity(), Vector3::new(0.0, 0.0, z));
        // Fast enough that this point is outside the feet.
        let velocity = Vector3::new(2.0, 0.0, vz);
        machine.tick(t, Some(&flying(base, velocity, Vector3::zeros())));
        machine.joint_tick(&crouch(), &[0.0; 12], 1e-4);
        if machine.phase() != Phase::PreLanding {
            continue;
        }
        let moved = place(&machine.command().position)[0] - place(&crouch())[0];
        let until = TOUCHDOWN - settings.levelling - t;
        if until > 5e-4 {
            assert!(moved.norm() < 1e-9, "{t}: {moved}");
            before += 1;
        } else if until < -5e-3 {
            assert!(moved.x > 0.05, "{t}: {moved}");
            after += 1;
        }
    }
    assert!(before > 20 && after > 10, "{before} {after}");
}

/// Of a body that turns one side comes down faster than the other: each foot that goes along with the ground is as much faster.
#[test]
fn feet_of_a_body_that_turns_go_along_each_with_its_own_ground() {
    let settings = Settings::new(&BUILD, feet(), MOTORS, crouch());
    for rate in [-0.5, 0.5] {
        let (height, speed, _) = arriving_at(1.5);
        let over_ground = |t: f64, place: &Vector3<f64>| {
            let flown = t - TAKEOFF;
            let rotation = so3::exp(&(Vector3::y() * (rate * flown)));
            ballistic(height, speed, flown).0 + (rotation * place).z
        };
        let mut found = 0;
        let flight = (height, speed, rate);
        fly(
            &settings,
            &nodes(rate),
            flight,
            TOUCHDOWN - 0.0005,
            |t, machine| {
                let up_b = so3::exp(&(Vector3::y() * (-rate * (t - TAKEOFF)))) * Vector3::z();
                for (foot, place) in foot_velocities(machine).iter().zip(place(&crouch())) {
                    if foot.norm() == 0.0 {
                        continue;
                    }
                    let falls =
                        (over_ground(t - 1e-4, &place) - over_ground(t + 1e-4, &place)) / 2e-4;
                    let wanted = falls - settings.retraction.gentle;
                    // The Tikhonov term takes some of the way.
                    assert!(
                        (foot.dot(&up_b) - wanted).abs() < 0.02 * falls,
                        "{t}: {foot} {wanted}"
                    );
                    // It is not the body's own fall.
                    let body = -ballistic(height, speed, t - TAKEOFF).1;
                    assert!(falls - body > 0.03, "{falls} {body}");
                    found += 1;
                }
                None::<()>
            },
        );
        assert!(found > 20, "{found}");
    }
}
