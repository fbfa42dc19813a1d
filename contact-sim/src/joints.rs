//! Coulomb friction of a joint, and what happens at the ends of its range.

use rbd_core::{AbaWorkspace, Configuration, Effort, JointLimits, Posture, Tree, mass_solve};
use so3::{Scalar, math};

/// Time in which a joint under friction comes to rest, s: MuJoCo's `solreffriction`.
pub(crate) const FRICTION_TIME: f64 = 0.004;
/// d₀ and d₁ of joint friction: MuJoCo's default of `solimpfriction`.
const FRICTION_SHARES: [f64; 2] = [0.9, 0.95];
/// ω of the relaxation, as for contacts.
const RELAXATION: f64 = 0.5;

/// Inertia that each joint shows to a torque while all others are free, with the joints at zero: 1/(M⁻¹)ᵢᵢ, kg m² (kg for a sliding one).
/// It is the inverse of what MuJoCo calls `dof_invweight0`.
pub(crate) fn joint_inertias<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    workspace: &mut AbaWorkspace<T, N>,
) -> [T; N] {
    let neutral = Configuration::NEUTRAL;
    let posture = Posture::new(model, &neutral);
    core::array::from_fn(|i| {
        let mut unit = Effort::ZERO;
        unit.joints = core::array::from_fn(|j| if i == j { T::ONE } else { T::ZERO });
        let answer = mass_solve(model, &posture, &unit, workspace);
        let mobility = answer.joints.get(i).copied().unwrap_or(T::ONE);
        T::ONE / math::max(mobility, T::of(1e-9))
    })
}

/// One relaxation step of a joint's Coulomb friction, N m, by MuJoCo's equations (`frictionloss`): friction asks for the acceleration −b q̇
/// of a joint, and gives for it up to `limit`. As a contact's force its torque τ costs R τ of acceleration, with R = (1 − d₀)/(d₀ I) and
/// b = 2/(d₁ t_c): a joint that sticks creeps with up to R τ/b, some thousandths of a radian per second. `inertia` is that of
/// [`joint_inertias`], `qdd` the acceleration under the `last` torque.
#[inline]
pub(crate) fn coulomb<T: Scalar>(last: T, limit: T, [qd, qdd]: [T; 2], inertia: T) -> T {
    let [d0, d1] = FRICTION_SHARES;
    let soft = T::of((1.0 - d0) / d0) / inertia;
    let wanted = -qd * T::of(2.0 / (d1 * FRICTION_TIME));
    let missing = wanted - qdd - last * soft;
    let torque = last + missing * (T::of(RELAXATION) / (T::ONE / inertia + soft));
    math::clamp(torque, -limit, limit)
}

/// Springs with dampers at the ends of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops<T> {
    /// Stiffness, N m/rad.
    pub stiffness: T,
    /// Damping while pressed, N m s/rad.
    pub damping: T,
}

impl<T: Scalar> Stops<T> {
    /// Torque of the stop: zero inside the range, never pulling.
    #[inline]
    #[must_use]
    pub fn torque(&self, limits: &JointLimits<T>, q: T, qd: T) -> T {
        if q < limits.lower {
            math::max(
                self.stiffness * (limits.lower - q) - self.damping * qd,
                T::ZERO,
            )
        } else if q > limits.upper {
            math::min(
                self.stiffness * (limits.upper - q) - self.damping * qd,
                T::ZERO,
            )
        } else {
            T::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Stops, coulomb};
    use rbd_core::JointLimits;

    #[test]
    fn a_stop_pushes_back_and_never_pulls() {
        let stops = Stops {
            stiffness: 100.0,
            damping: 1.0,
        };
        let limits = JointLimits {
            lower: -1.0,
            upper: 1.0,
            ..JointLimits::NONE
        };
        assert_eq!(stops.torque(&limits, 0.5, 100.0), 0.0);
        assert!(stops.torque(&limits, 1.1, 0.0) < 0.0);
        assert_eq!(stops.torque(&limits, 1.1, -50.0), 0.0);
        assert!(stops.torque(&limits, -1.1, 0.0) > 0.0);
    }

    /// A joint of 0.05 kg m² under a torque and up to 0.2 N m of friction, after half a second: its speed, and the acceleration at last.
    fn turned(applied: f64) -> [f64; 2] {
        let (inertia, dt) = (0.05, 5e-5);
        let (mut qd, mut qdd, mut friction) = (0.0, 0.0, 0.0);
        for _ in 0..10_000 {
            friction = coulomb(friction, 0.2, [qd, qdd], inertia);
            qdd = (applied + friction) / inertia;
            qd += qdd * dt;
        }
        [qd, qdd]
    }

    #[test]
    fn a_joint_sticks_under_its_friction_and_loses_it_beyond() {
        let [creep, rest] = turned(0.19);
        assert!(creep > 0.0 && creep < 2e-3 && rest.abs() < 1e-6, "{creep}");
        let [speed, rate] = turned(0.3);
        assert!((rate - 0.1 / 0.05).abs() < 1e-9, "{rate}");
        assert!((speed - 0.5 * rate).abs() < 0.01, "{speed}");
    }
}
