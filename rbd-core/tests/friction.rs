//! Joint friction, by its formula and by what it must not depend on.

use proptest::prelude::*;
use rbd_core::{JointLimits, joint_friction};
use so3::math;

fn torque(damping: f64, friction: f64, speed: f64, smoothing: f64) -> f64 {
    let joint = JointLimits {
        damping,
        friction,
        ..JointLimits::NONE
    };
    joint_friction(&[joint], &[speed], smoothing)[0]
}

proptest! {
    /// τ = −d q̇ − f tanh(q̇/v_s), whose Coulomb part is that of any unit of speed; without smoothing it is the sign.
    #[test]
    fn friction_follows_its_formula(damping in 0.0..2.0_f64, friction in 0.0..5.0_f64, speed in -30.0..30.0_f64, smoothing in 1e-3..10.0_f64) {
        let expected = -damping * speed - friction * math::tanh(speed / smoothing);
        prop_assert!((torque(damping, friction, speed, smoothing) - expected).abs() < 1e-12 * (1.0 + expected.abs()));
        let coulomb = torque(0.0, friction, speed, smoothing);
        prop_assert!((torque(0.0, friction, 8.0 * speed, 8.0 * smoothing) - coulomb).abs() < 1e-12 * (1.0 + friction));
        // Against the motion, and never more than both together.
        prop_assert!(torque(damping, friction, speed, smoothing) * speed <= 0.0);
        let most = damping * speed.abs() + friction;
        prop_assert!(torque(damping, friction, speed, smoothing).abs() <= most * (1.0 + 1e-12));
        // Nothing at rest.
        for sharp in [0.0, -1.0] {
            let expected = -damping * speed - friction * speed.signum();
            prop_assert!((torque(damping, friction, speed, sharp) - expected).abs() < 1e-12 * (1.0 + expected.abs()));
            prop_assert_eq!(torque(damping, friction, 0.0, sharp), 0.0);
        }
    }
}
