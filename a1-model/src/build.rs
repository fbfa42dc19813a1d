//! The size of A1, from which controllers take their gains.

use rbd_core::Build;

use crate::table1::LEG_LINKS;

/// Mass, leg and inertia of A1.
///
/// | figure | value | source |
/// |---|---|---|
/// | mass | 13.741 kg | the URDF's links |
/// | leg, stretched | 0.4 m | thigh and calf of the URDF and of paper A, Table I |
/// | inertia | 0.141, 0.379, 0.410 kg m² | crouched, with which the landing was tuned; the URDF's at hip 0, thigh 0.9, calf −1.8 rad is 0.140, 0.361, 0.392 |
pub static BUILD: Build<f64> = Build {
    mass: 13.741,
    leg_length: LEG_LINKS[0] + LEG_LINKS[1],
    inertia_b: [0.141, 0.379, 0.410],
};

/// [`BUILD`] in single precision.
pub static BUILD_F32: Build<f32> = BUILD.to_f32();

#[cfg(test)]
mod tests {
    use super::{BUILD, BUILD_F32};
    use crate::A1;
    use crate::a1::frame;
    use rbd_core::{
        Configuration, Kinematics, Motion, Posture, Tangent, centroidal_state, forward_kinematics,
    };

    /// Hip, thigh and calf of a leg, rad.
    const CROUCHED: [f64; 3] = [0.0, 0.9, -1.8];

    fn posture(leg: [f64; 3]) -> Posture<f64, 12> {
        let q = Configuration {
            joints: core::array::from_fn(|i| leg[i % 3]),
            ..Configuration::NEUTRAL
        };
        Posture::new(&A1, &q)
    }

    /// Gains stand in the code as measured on this robot: it flies with them to the bit.
    #[test]
    fn gains_are_those_that_stand_in_the_code() {
        for x in [1.0, 0.1, 28.0, 1e-4] {
            assert_eq!([BUILD.time(x), BUILD.force(x)], [x; 2]);
            let single = [BUILD_F32.time(x), BUILD_F32.force(x)];
            assert_eq!(single, [x as f32; 2]);
        }
    }

    #[test]
    fn the_build_is_that_of_the_tables() {
        let crouched = posture(CROUCHED);
        for (axis, inertia) in BUILD.inertia_b.into_iter().enumerate() {
            let mut turning = [0.0; 6];
            turning[3 + axis] = 1.0;
            let velocity = Tangent {
                base: Motion::from_array(turning),
                ..Tangent::ZERO
            };
            let body = centroidal_state(&A1, &crouched, &velocity);
            assert!((body.mass - BUILD.mass).abs() < 1e-9, "{}", body.mass);
            let off = body.momentum_w.angular[axis] / inertia - 1.0;
            assert!(off.abs() < 0.05, "{axis}: {}", body.momentum_w.angular);
        }
        let mut poses = Kinematics::IDENTITY;
        let stretched = posture([0.0; 3]);
        forward_kinematics(&A1, &stretched, &mut poses);
        let hip = poses.frame(&frame::FL_THIGH).translation;
        let leg = (poses.frame(&frame::FL_FOOT).translation - hip).norm();
        assert!((leg - BUILD.leg_length).abs() < 1e-12, "{leg}");
    }
}
