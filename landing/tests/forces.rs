//! Properties of the commanded forces and torques.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use a1_model::{A1Geared, BUILD, FEET};
use landing::{Landing, Outcome, Settings, Target, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Motion, Tangent};

type A1Landing = Landing<f64, 12, 4>;

fn landing() -> A1Landing {
    let feet = FEET.map(|foot| foot.frame);
    Landing::new(feet, Settings::new(&BUILD), [33.5; 12])
}

fn crouched() -> Configuration<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    q.base.translation.z = 0.30;
    q
}

const TARGET: Target<f64> = Target {
    height: 0.26,
    ..Target::LEVEL
};

/// Every subset of feet, falling, tilted: forces in the cone, air feet free, torques inside the limits.
#[test]
fn any_subset_of_feet_gives_forces_inside_all_limits() {
    let landing = landing();
    let mut workspace = Workspace::new();
    for subset in 1_u8..16 {
        for (roll, pitch, fall) in [(0.0, 0.0, 0.0), (0.3, -0.2, 2.0), (-0.35, 0.35, 4.0)] {
            let contacts: [bool; 4] = core::array::from_fn(|i| subset >> i & 1 == 1);
            let mut q = crouched();
            q.base.rotation = Rotation3::from_euler_angles(roll, pitch, 0.2);
            let v = Tangent {
                base: Motion::from_array([0.3, -0.4, -fall, 0.5, -1.0, 0.2]),
                joints: core::array::from_fn(|i| if i % 3 == 2 { -3.0 * fall } else { fall }),
            };
            let c = landing.step(
                &A1Geared,
                &q,
                &v,
                &contacts,
                &TARGET,
                &q.joints,
                &mut workspace,
            );
            assert!(
                matches!(c.outcome, Outcome::Solved(_)),
                "{subset} {:?}",
                c.outcome
            );
            for (force, on) in c.forces_w.iter().zip(contacts) {
                if on {
                    assert!(force.z >= -1e-9 && force.z <= 400.0 + 1e-9);
                    assert!(force.x.abs() <= 0.5 * force.z + 1e-7);
                    assert!(force.y.abs() <= 0.5 * force.z + 1e-7);
                } else {
                    assert_eq!(*force, Vector3::zeros());
                }
            }
            for i in 0..12 {
                let tau = c.feed_forward[i] - c.damping[i] * v.joints[i];
                let stands = contacts[i / 3];
                assert_eq!(c.stiffness[i] == 0.0, stands);
                assert!(
                    !stands || tau.abs() <= 33.5 + 1e-6,
                    "{subset}: joint {i} at {tau}"
                );
            }
        }
    }
}

/// At rest on its target the forces carry the weight and turn nothing.
#[test]
fn at_rest_the_forces_carry_the_weight() {
    let landing = landing();
    let mut workspace = Workspace::new();
    let q = crouched();
    let mut target = TARGET;
    let body = rbd_core::center_of_mass(&A1Geared, &rbd_core::Posture::new(&A1Geared, &q));
    let mut kinematics = rbd_core::Kinematics::IDENTITY;
    rbd_core::forward_kinematics(
        &A1Geared,
        &rbd_core::Posture::new(&A1Geared, &q),
        &mut kinematics,
    );
    let feet: Vector3<f64> = landing
        .feet
        .iter()
        .map(|f| kinematics.frame(f).translation)
        .sum::<Vector3<f64>>()
        / 4.0;
    let offset = body.position_w - feet;
    (target.height, target.offset_w) = (offset.z, [offset.x, offset.y]);
    let c = landing.step(
        &A1Geared,
        &q,
        &Tangent::ZERO,
        &[true; 4],
        &target,
        &q.joints,
        &mut workspace,
    );
    let total: Vector3<f64> = c.forces_w.iter().sum();
    assert!(
        (total - Vector3::z() * (body.mass * 9.81)).norm() < 1e-2,
        "{total}"
    );
    let moment: Vector3<f64> = landing
        .feet
        .iter()
        .zip(&c.forces_w)
        .map(|(f, force)| (kinematics.frame(f).translation - body.position_w).cross(force))
        .sum();
    assert!(moment.norm() < 1e-2, "{moment}");
}

/// A tilted body is turned back and a low one lifted.
#[test]
fn errors_are_opposed() {
    let landing = landing();
    let mut workspace = Workspace::new();
    let mut q = crouched();
    q.base.rotation = Rotation3::from_euler_angles(0.2, 0.0, 0.0);
    let c = landing.step(
        &A1Geared,
        &q,
        &Tangent::ZERO,
        &[true; 4],
        &TARGET,
        &q.joints,
        &mut workspace,
    );
    let (left, right) = (
        c.forces_w[0].z + c.forces_w[2].z,
        c.forces_w[1].z + c.forces_w[3].z,
    );
    assert!(
        right > left,
        "left side is high: push up on the right, {left} {right}"
    );
}

#[test]
fn in_the_air_the_legs_are_held_and_bad_numbers_are_damped() {
    let landing = landing();
    let mut workspace = Workspace::new();
    let q = crouched();
    let c = landing.step(
        &A1Geared,
        &q,
        &Tangent::ZERO,
        &[false; 4],
        &TARGET,
        &q.joints,
        &mut workspace,
    );
    assert_eq!(c.outcome, Outcome::Airborne);
    assert!(c.stiffness.iter().all(|k| *k > 0.0) && c.feed_forward == [0.0; 12]);
    for bad in [f64::NAN, f64::INFINITY] {
        for which in 0..3 {
            let (mut q, mut v) = (q, Tangent::ZERO);
            match which {
                0 => q.joints[4] = bad,
                1 => q.base.translation.x = bad,
                _ => v.base.angular.y = bad,
            }
            let c = landing.step(
                &A1Geared,
                &q,
                &v,
                &[true; 4],
                &TARGET,
                &q.joints,
                &mut workspace,
            );
            assert!(
                c.feed_forward.iter().all(|tau| tau.is_finite()),
                "{which} {bad}"
            );
            assert!(c.forces_w.iter().all(|f| f.iter().all(|x| x.is_finite())));
        }
    }
}
