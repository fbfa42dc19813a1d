//! The profile is one of this robot: what it repeats in constants is what the model and its tables say.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use icub_model::profile::{self, GUARDED_LIMITS, LANDING_POSTURE, SOLE_CONTACTS, SQUAT};
use icub_model::{Icub23GazeboGeared, LIMITS, SOLES};
use jump_machine::humanoid::{middle_of_feet, on_the_floor};
use rbd_core::{Kinematics, Posture, center_of_mass, forward_kinematics};
use wbc_qp::Contact;

#[test]
fn soles_and_limits_are_those_of_the_tables() {
    for (constant, sole) in SOLE_CONTACTS.iter().zip(&SOLES) {
        let made = Contact::new(sole, constant.friction, constant.max_force);
        assert_eq!(*constant, made);
    }
    for (guarded, limits) in GUARDED_LIMITS.iter().zip(&LIMITS) {
        assert!(guarded.speed < limits.speed && guarded.speed > 0.85 * limits.speed);
        assert_eq!((guarded.lower, guarded.upper), (limits.lower, limits.upper));
    }
}

/// Both postures are inside the limits and stand on level soles with the centre of mass over them; from the squat to the landing
/// posture the legs have the push-off's way less what they are drawn up by.
#[test]
fn postures_stand_on_both_soles_inside_the_limits() {
    let robot = Icub23GazeboGeared;
    let heights = [SQUAT, LANDING_POSTURE].map(|joints| {
        for (q, limits) in joints.iter().zip(&LIMITS) {
            assert!(*q > limits.lower && *q < limits.upper);
        }
        let q = on_the_floor(&robot, &SOLE_CONTACTS, &joints);
        let posture = Posture::new(&robot, &q);
        let mut poses = Kinematics::IDENTITY;
        forward_kinematics(&robot, &posture, &mut poses);
        for sole in &SOLES {
            let pose = poses.frame(&sole.frame);
            assert!(pose.translation.z.abs() < 1e-3);
            assert!(pose.rotation.matrix()[(2, 2)] > 1.0 - 1e-6);
        }
        let com = center_of_mass(&robot, &posture).position_w;
        let off = com - middle_of_feet(&poses, &SOLE_CONTACTS);
        assert!(off.x.abs() < 0.06 && off.y.abs() < 0.01, "{off}");
        com.z
    });
    assert!((heights[0] - 0.38).abs() < 0.015, "{heights:?}");
    let rise = heights[1] - heights[0];
    assert!(rise > 0.03 && rise < profile::DISPLACEMENT + 0.03, "{rise}");
    assert!(profile::rise(profile::HEIGHT).is_some());
    for height in [0.0, -0.1, f64::NAN] {
        assert!(profile::rise(height).is_none());
    }
}
