//! Flight and landing by one torque program: the controller that paper B names as future work (section V).
//!
//! In the air every contact's load is zero: the program is then the inverse dynamics of the free robot that moves the joints
//! along their reference and keeps rectangular soles level, whatever the base does. As contacts come (their load rises), the centre of
//! mass takes over: it is slowed down along [`Absorption`], the trunk turns upright, angular momentum is damped, and the posture
//! has what is left. Nothing here is a stiff servo, so the ground's first blow meets the inertia of the feet only, and no torque leaves
//! its limits.

use nalgebra::{Rotation3, Vector3};
use rbd_core::{Frame, JointLimits, Motor, Tree, joint_friction};
use so3::{Scalar, math};

use super::{ComReference, Residuals, distance};
use crate::task::{orientation_error, position_error};
use crate::{
    Contact, Error, Gains, Horizon, Patch, Snapshot, TorqueQp, jump::TorqueTick, torque_range,
};

/// The way of the centre of mass from touchdown to rest: v(t) = v₀ (1 − t/T)², T = 3 d/|v₀|, a distance d in all.
///
/// The force on the ground starts at m (g + 2 |v₀|/T) and falls to m g: largest while the legs are longest, where
/// the knees' levers are shortest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorption<T> {
    /// Vertical speed at touchdown, m/s; negative downwards.
    pub speed: T,
    /// T, s.
    pub duration: T,
}

impl<T: Scalar> Absorption<T> {
    /// From this speed to rest within `distance` > 0, m. Slow touchdowns take at most `longest`, s.
    #[must_use]
    pub fn new(speed: T, distance: T, longest: T) -> Self {
        let duration = T::of(3.0) * distance / math::abs(speed);
        // Also for a speed of zero, and for a NaN.
        let duration = if duration < longest {
            duration
        } else {
            longest
        };
        Self { speed, duration }
    }

    /// Displacement, speed and acceleration a time after touchdown.
    #[must_use]
    pub fn at(&self, time: T) -> [T; 3] {
        let x = math::clamp(time / self.duration, T::ZERO, T::ONE);
        let left = T::ONE - x;
        let third = self.speed * self.duration / T::of(3.0);
        [
            third * (T::ONE - left * left * left),
            self.speed * left * left,
            -T::TWO * self.speed / self.duration * left,
        ]
    }
}

/// Gains and weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandingSettings<T, const N: usize> {
    /// Of the centre of mass, on the ground.
    pub com: Gains<T>,
    /// Weight of its rows.
    pub com_weight: T,
    /// Damping of the angular momentum, 1/s, on the ground.
    pub momentum_gain: T,
    /// Weight of its rows.
    pub momentum_weight: T,
    /// Of the trunk's orientation, on the ground.
    pub trunk: Gains<T>,
    /// Weight of its rows.
    pub trunk_weight: T,
    /// Of the soles' level, in the air.
    pub sole: Gains<T>,
    /// Weight of its rows.
    pub sole_weight: T,
    /// Of the posture, in the air and on the ground.
    pub posture: [Gains<T>; 2],
    /// Weight of each joint.
    pub posture_weight: [T; N],
    /// Weight of a change of torque.
    pub continuity_weight: T,
    /// Weight of forces and moments of the contacts, per N² and (N m)².
    pub force_weight: T,
    /// How limits act.
    pub horizon: Horizon<T>,
    /// Largest mechanical power of a joint, W; ∞ for none.
    pub max_power: T,
    /// [`TorqueQp::max_steps`]; none by default.
    pub max_steps: u32,
}

/// What flight and landing are to follow in this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandingReference<T: Scalar, const N: usize> {
    /// Of the centre of mass, on the ground.
    pub com: ComReference<T>,
    /// Orientation of the trunk, on the ground.
    pub trunk: Rotation3<T>,
    /// Positions of the joints.
    pub posture: [T; N],
    /// Their velocities.
    pub velocity: [T; N],
}

/// The controller with its memory.
#[derive(Clone, Debug)]
pub struct Landing<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize> {
    /// Gains and weights.
    pub settings: LandingSettings<T, N>,
    qp: TorqueQp<T, N, K, V, M>,
    previous: Option<[T; N]>,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    Landing<T, N, K, V, M>
{
    /// A controller without a memory of torques.
    #[must_use]
    pub fn new(settings: LandingSettings<T, N>) -> Self {
        Self {
            settings,
            qp: TorqueQp::new(),
            previous: None,
        }
    }

    /// Forgets the torques of earlier ticks.
    pub const fn restart(&mut self) {
        self.previous = None;
    }

    /// One tick; the contacts' loads say how much ground there is.
    ///
    /// # Errors
    /// As [`TorqueQp::solve`]; the last command, or damping, is then safe.
    pub fn tick<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Contact<T>],
        joints: (&[JointLimits<T>; N], &[Motor<T>; N]),
        wanted: &LandingReference<T, N>,
    ) -> Result<TorqueTick<T, N, K>, Error> {
        let s = &self.settings;
        let (limits, motors) = joints;
        let qd = &snapshot.velocity.joints;
        let friction = joint_friction(limits, qd, T::of(0.1));
        self.qp.begin(model, snapshot, contacts, &friction)?;
        let ground = contacts
            .iter()
            .fold(T::ZERO, |most, c| math::max(most, c.load));
        let com = snapshot.com();
        let com_target = com.acceleration(
            wanted.com.acceleration_w.into(),
            wanted.com.velocity_w.into(),
            position_error(&wanted.com.position_w, &snapshot.com_w()),
            s.com,
        );
        self.qp
            .minimise(&com, &com_target, &[s.com_weight * ground; 3]);
        let momentum = snapshot.angular_momentum();
        let rate: Vector3<T> = -snapshot.momentum_w.angular * s.momentum_gain;
        let momentum_target = rate.into();
        self.qp.minimise(
            &momentum,
            &momentum_target,
            &[s.momentum_weight * ground; 3],
        );
        let trunk = snapshot.frame_orientation(model, &Frame::IDENTITY);
        let error = orientation_error(&wanted.trunk, &snapshot.configuration.base.rotation);
        let target = trunk.acceleration([T::ZERO; 3], [T::ZERO; 3], error, s.trunk);
        self.qp
            .minimise(&trunk, &target, &[s.trunk_weight * ground; 3]);
        level_soles(&mut self.qp, model, snapshot, contacts, s);
        let posture = follow(s, snapshot, wanted, ground);
        self.qp.minimise_joints(&posture, &s.posture_weight);
        if let Some(previous) = &self.previous {
            self.qp
                .minimise_torques(previous, &[s.continuity_weight; N]);
        }
        self.qp.minimise_forces(&[T::ZERO; K], &[s.force_weight; K]);
        self.qp.limit_joints(snapshot, limits, &s.horizon);
        let mut ranges = [[T::ZERO; 2]; N];
        for (range, (motor, qd)) in ranges.iter_mut().zip(motors.iter().zip(qd)) {
            *range = torque_range(motor, *qd, s.max_power);
        }
        self.qp.limit_torques(&ranges)?;
        self.qp.max_steps = s.max_steps;
        let answer = self.qp.solve()?;
        self.previous = Some(answer.torques);
        let (com, momentum) = (
            com.reached(&answer.acceleration),
            momentum.reached(&answer.acceleration),
        );
        let ground_only = |x: T| if ground > T::ZERO { x } else { T::ZERO };
        Ok(TorqueTick {
            answer,
            residuals: Residuals {
                com: ground_only(distance(&com, &com_target)),
                momentum: ground_only(distance(&momentum, &momentum_target)),
            },
        })
    }
}

/// Keeps soles level in the air, the less the more of their contact there is.
#[inline(never)] // Its rows are not to lie on the stack while the program is solved.
fn level_soles<T, R, const N: usize, const K: usize, const V: usize, const M: usize>(
    qp: &mut TorqueQp<T, N, K, V, M>,
    model: &R,
    snapshot: &Snapshot<T, N>,
    contacts: &[Contact<T>],
    s: &LandingSettings<T, N>,
) where
    T: Scalar,
    R: Tree<T, N>,
{
    for contact in contacts {
        if contact.is_whole() || matches!(contact.shape, Patch::Ball { .. }) {
            continue;
        }
        let sole = snapshot.frame_orientation(model, &contact.frame);
        let normal = snapshot.pose(&contact.frame).rotation * Vector3::z();
        let target = sole.acceleration(
            [T::ZERO; 3],
            [T::ZERO; 3],
            normal.cross(&Vector3::z()).into(),
            s.sole,
        );
        let weight = s.sole_weight * (T::ONE - contact.load);
        // Yaw is the posture's.
        qp.minimise(&sole, &target, &[weight, weight, T::ZERO]);
    }
}

/// Accelerations of the joints towards their reference; the gains go from those in the air to those on the ground.
fn follow<T: Scalar, const N: usize>(
    s: &LandingSettings<T, N>,
    snapshot: &Snapshot<T, N>,
    wanted: &LandingReference<T, N>,
    ground: T,
) -> [T; N] {
    let (q, qd) = (&snapshot.configuration.joints, &snapshot.velocity.joints);
    let [air, floor] = s.posture;
    let between = |a: T, b: T| a + (b - a) * ground;
    let stiffness = between(air.stiffness, floor.stiffness);
    let damping = between(air.damping, floor.damping);
    let mut posture = wanted.posture;
    let state = q.iter().zip(qd).zip(&wanted.velocity);
    for (x, ((q, qd), v)) in posture.iter_mut().zip(state) {
        *x = stiffness * (*x - *q) + damping * (*v - *qd);
    }
    posture
}

#[cfg(test)]
mod tests {
    use super::Absorption;

    #[test]
    fn absorption_comes_to_rest_after_its_distance() {
        let a = Absorption::new(-0.9_f64, 0.08, 1.0);
        assert!((a.at(a.duration)[0] + 0.08).abs() < 1e-12);
        assert_eq!(a.at(0.0)[1], -0.9);
        assert_eq!(a.at(2.0)[1..], [0.0, 0.0]);
        for i in 0..10 {
            let (t, h) = (0.02 * f64::from(i) + 1e-3, 1e-6);
            for k in 0..2 {
                let slope = (a.at(t + h)[k] - a.at(t - h)[k]) / (2.0 * h);
                assert!((slope - a.at(t)[k + 1]).abs() < 1e-5, "{k}");
            }
        }
        assert_eq!(Absorption::new(0.0, 0.08, 0.5).duration, 0.5);
        assert_eq!(Absorption::new(f64::NAN, 0.08, 0.5).duration, 0.5);
    }
}
