//! What a humanoid's servos and its landing's program do in time: along their velocities, in their share of the flight, and on the ground.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use icub_model::profile;
use jump_control::Phase;
use jump_machine::humanoid::Work;
use rbd_core::{Posture, center_of_mass};

use super::humanoid::{
    N, ROBOT, TAKEOFF, air, ground, jump, landed, resting, run, servos, settings, standing, with,
};

/// Height of the centre of mass of a robot that stands with these joints, m.
fn height(joints: &[f64; N]) -> f64 {
    center_of_mass(&ROBOT, &Posture::new(&ROBOT, &standing(joints)))
        .position_w
        .z
}

/// In the push-off by velocities each tick's positions are those of the last, gone on at its velocities.
#[test]
fn servos_are_told_the_integral_of_their_velocities() {
    with(servos(), |m| {
        m.arm(&jump(), 0.0).unwrap();
        run(m, -20, -19, &ground());
        assert_eq!(m.command().position, profile::SQUAT);
        let mut fastest = 0.0_f64;
        for k in -19..TAKEOFF {
            let last = *m.command();
            run(m, k, k + 1, &ground());
            for (j, q) in m.command().position.iter().enumerate() {
                let wanted = last.position[j] + 1e-3 * last.velocity[j];
                assert!((q - wanted).abs() < 1e-9, "{k}, joint {j}: {q} {wanted}");
                fastest = fastest.max(last.velocity[j].abs());
            }
        }
        assert!(fastest > 1.0, "{fastest}");
    });
}

/// Servos bring the legs to the landing posture in the setting's share of the flight: from the take-off until the throw comes down to that posture.
#[test]
fn legs_are_ready_to_land_after_their_share_of_the_flight() {
    for share in [0.6, 0.9] {
        let settings = jump_machine::humanoid::Settings {
            aerial_share: share,
            ..servos()
        };
        with(settings, |m| {
            let jump = jump();
            m.arm(&jump, 0.0).unwrap();
            run(m, -20, TAKEOFF, &ground());
            let end = height(&profile::LANDING_POSTURE) - height(&profile::SQUAT);
            let apart = |m: &super::humanoid::Icub<'_>| {
                let joints = m.command().position.iter().zip(profile::LANDING_POSTURE);
                joints.map(|(q, to)| (q - to).abs()).fold(0.0, f64::max)
            };
            // Later it would have given up.
            let ready = (TAKEOFF..TAKEOFF + 900).find(|k| {
                run(m, *k, k + 1, &air());
                apart(m) < 1e-9
            });
            // The ticks before it are as good as there: a minimum jerk ends flat.
            let since = 1e-3 * f64::from(ready.unwrap() - TAKEOFF);
            let landing = jump.profile.at(jump.profile.duration + since / share);
            assert!(
                (landing.rise - end).abs() < 4e-3,
                "{since}: {} {end}",
                landing.rise
            );
            assert!(landing.speed < 0.0);
        });
    }
}

/// A robot that stands where its landing ends is held there: the ground carries it, nothing that is asked of its centre of mass is missed, and how high the floor is
/// changes nothing.
#[test]
fn a_robot_that_stands_is_held_by_the_same_torques_on_every_floor() {
    let torques = |floor: f64| {
        with(settings(), |m| {
            let mut heard = landed();
            heard.measured.base.translation.z += floor;
            for k in 0..40 {
                let tick = run(m, k, k + 1, &heard);
                assert_eq!(tick.phase, Phase::Stand);
                let solved = match tick.work {
                    Work::Landing(solved) => solved.unwrap(),
                    _ => unreachable!("it stands"),
                };
                assert!(solved.residuals.com < 0.05, "{k}: {:?}", solved.residuals);
            }
            m.command().feed_forward
        })
    };
    let (low, high) = (torques(0.0), torques(0.7));
    assert!(low[3].abs() > 5.0, "{low:?}");
    for (low, high) in low.iter().zip(&high) {
        assert!((low - high).abs() < 1e-3, "{low} {high}");
    }
}

/// Once the fall has ended the robot is to rise to its landing posture: one that stays in a squat is pushed up harder and harder.
#[test]
fn a_robot_that_stays_down_is_pushed_up_in_the_end() {
    with(settings(), |m| {
        let heard = resting(&profile::SQUAT, 162.0);
        let mut knee = |from, to| {
            run(m, from, to, &heard);
            m.command().feed_forward[3]
        };
        let (first, last) = (knee(0, 40), knee(40, 1400));
        assert!(first > 5.0 && last > 1.5 * first, "{first} {last}");
    });
}
