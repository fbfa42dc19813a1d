//! Gains, weights and limits of the landing controller, and where it is to bring the body.

use nalgebra::Rotation3;
use rbd_core::{Build, Transform};
use so3::{Scalar, math};

/// Settings; [`Settings::new`] holds those measured on drops, for a robot of any size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// Gains on height: s⁻², s⁻¹.
    pub height: (T, T),
    /// Gains on the horizontal position over the feet. Stiffer ones tip over after 1.2 m/s.
    pub horizontal: (T, T),
    /// Gains on the rotation.
    pub rotation: (T, T),
    /// Composite inertia of the landing posture about the centre of mass, diagonal, base axes, kg m².
    pub inertia_b: [T; 3],
    /// Weight on the error of the total force, N⁻².
    pub force_weight: T,
    /// Weight on the error of the total moment, (N m)⁻².
    pub moment_weight: T,
    /// Weight on the forces themselves, N⁻²: positive, for it shares the load where the wrench does not say how.
    pub effort_weight: T,
    /// Coulomb coefficient of the friction pyramid.
    pub friction: T,
    /// Largest normal force of one foot, N.
    pub max_normal_force: T,
    /// Damping of the joints of stance legs, N m s/rad: of slow ones, and of those that are as fast as the second of
    /// [`Self::stance_speeds`] or faster.
    pub stance_damping: [T; 2],
    /// Joint speeds between which the damping grows from the first to the second, rad/s.
    pub stance_speeds: [T; 2],
    /// Falls at the first touch from which on, and at which wholly, slow joints are damped as fast ones, m/s: a landing that the knees can
    /// hardly take up needs all that takes energy. See [`Self::after_fall`].
    pub hard: [T; 2],
    /// Stiffness of the joints of swing legs, N m/rad.
    pub swing_stiffness: T,
    /// Damping of the joints of swing legs, N m s/rad.
    pub swing_damping: T,
}

impl<T: Scalar> Settings<T> {
    /// Those of a robot of this size, by [dynamic similarity](rbd_core::similarity).
    ///
    /// The numbers were measured on drops of A1 from 0.3 to 2 m
    /// (`cargo xtask mujoco run --release -p saltus-tests --features mujoco --example drops -- 1000`). Height and rotation are damped by
    /// 0.64 and 0.89 of critical; a foot may carry three times the robot's weight; a moment weighs as much as the
    /// force that makes it at 0.18 m, half a trunk. Joints of stance legs are damped little, for what damps a joint that the ground
    /// has just torn along is a blow on the ground, and five times as much near the 21 rad/s that they can do. Friction is the ground's and does not scale.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        let gains = |way, speed| (build.rate_squared(way), build.rate(speed));
        Self {
            height: gains(120.0, 14.0),
            horizontal: gains(20.0, 11.2),
            rotation: gains(250.0, 28.0),
            inertia_b: build.inertia_b,
            force_weight: build.per_force_squared(1.0),
            moment_weight: build.per_torque_squared(30.0),
            effort_weight: build.per_force_squared(1e-4),
            friction: T::HALF,
            max_normal_force: build.force(400.0),
            stance_damping: [build.joint_damping(0.2), build.joint_damping(1.0)],
            stance_speeds: [build.rate(15.0), build.rate(21.0)],
            hard: [build.speed(3.5), build.speed(4.5)],
            swing_stiffness: build.joint_stiffness(60.0),
            swing_damping: build.joint_damping(2.0),
        }
    }

    /// The settings for a landing of a body that falls with `fall`, m/s, at the first touch; one that is not a number changes nothing.
    #[must_use]
    pub fn after_fall(&self, fall: T) -> Self {
        let ([slow, fast], [begin, end]) = (self.stance_damping, self.hard);
        let mut after = *self;
        if fall > begin {
            let share = math::clamp((fall - begin) / (end - begin), T::ZERO, T::ONE);
            after.stance_damping = [slow + (fast - slow) * share, fast];
        }
        after
    }

    /// Damping of a joint of a stance leg at this speed, N m s/rad.
    #[inline(always)]
    pub(crate) fn damping(&self, speed: T) -> T {
        let ([slow, fast], [begin, end]) = (self.stance_damping, self.stance_speeds);
        let beyond = (math::abs(speed) - begin) / (end - begin);
        slow + (fast - slow) * math::clamp(beyond, T::ZERO, T::ONE)
    }
}

/// Where the body is to come to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<T: Scalar> {
    /// Height of the centre of mass over the feet in contact, m.
    pub height: T,
    /// Rotation of the base.
    pub rot_wb: Rotation3<T>,
    /// Offset of the centre of mass from the middle of the feet, world x and y, m.
    pub offset_w: [T; 2],
}

impl<T: Scalar> Target<T> {
    /// Level, over the middle of the feet, at no height: set one.
    pub const LEVEL: Self = Self {
        height: T::ZERO,
        rot_wb: Transform::<T>::IDENTITY.rotation,
        offset_w: [T::ZERO; 2],
    };
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use a1_model::BUILD;

    #[test]
    fn fast_joints_and_hard_landings_are_damped() {
        let settings = Settings::<f64>::new(&BUILD);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        for (speed, damping) in [
            (0.0, 0.2),
            (15.0, 0.2),
            (-18.0, 0.6),
            (21.0, 1.0),
            (-90.0, 1.0),
        ] {
            near(settings.damping(speed), damping);
        }
        for (fall, damping) in [(-2.0, 0.2), (3.5, 0.2), (4.0, 0.6), (4.5, 1.0), (7.0, 1.0)] {
            let after = settings.after_fall(fall);
            near(after.damping(3.0), damping);
            near(after.damping(22.0), 1.0);
        }
        assert_eq!(settings.after_fall(f64::NAN), settings);
    }
}
