//! The torque controller: posture and continuity, paper B eq. (6a); centre of mass, eq. (6b); feet at rest, eq. (6c);
//! angular momentum, eq. (6d), which is to decay as in eq. (5); joint and torque limits, eq. (6e); contacts, eq. (6f).
//!
//! The paper prints the posture's s̈* = K_d ṡ − K_p (s − s_d): with that sign damping would drive the joints away from rest, so
//! it is a slip of the pen; s̈* = −K_d ṡ − K_p (s − s_d) here. Likewise K_p and K_d of eq. (6b) act on the errors in
//! position and velocity, with a minus sign each. Its A f = −K H_ω is Ḣ_ω = −K H_ω written in forces: the program's elimination of
//! the base turns the one into the other.
//!
//! Both laws are for the robot as it moves, not as its model does: what was seen to accelerate it besides is taken off before the program is
//! asked (`surplus`).

use nalgebra::Vector3;
use rbd_core::{JointLimits, Motor, Tree, joint_friction};
use so3::Scalar;

use super::surplus::Surplus;
use super::{ComReference, Residuals, distance};
use crate::task::position_error;
use crate::{Contact, Error, Gains, Horizon, Snapshot, TorqueAnswer, TorqueQp, torque_range};

/// Gains and weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueJumpSettings<T, const N: usize> {
    /// Of the centre of mass, eq. (6b).
    pub com: Gains<T>,
    /// K of eq. (6d), 1/s.
    pub momentum_gain: T,
    /// How fast it is found what accelerates centre of mass and angular momentum besides the program, such as a payload, 1/s; zero for never.
    pub surplus_gain: T,
    /// Of the posture, eq. (6a).
    pub posture: Gains<T>,
    /// Λ of eq. (6a), per joint.
    pub posture_weight: [T; N],
    /// Δ of eq. (6a): weight of a change of torque.
    pub continuity_weight: T,
    /// Whether centre of mass and angular momentum are held (strictly before posture and continuity, as the paper
    /// writes them; six rows more) instead of weighed. Single precision needs it.
    pub strict: bool,
    /// Weight of the centre of mass's rows.
    pub com_weight: T,
    /// Weight of the angular momentum's rows; zero leaves eq. (6d) out.
    pub momentum_weight: T,
    /// Weight of the tangential forces and moments of the contacts, per N² and (N m)²: what redundant contacts share is
    /// decided by it.
    pub force_weight: T,
    /// How limits act.
    pub horizon: Horizon<T>,
    /// Largest mechanical power of a joint, W; ∞ for none.
    pub max_power: T,
    /// [`TorqueQp::max_steps`]; none by default.
    pub max_steps: u32,
    /// Whether damping and friction of the joints are known to the program; the paper's did not know them.
    pub knows_friction: bool,
}

impl<const N: usize> TorqueJumpSettings<f64, N> {
    /// The same in either precision.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> TorqueJumpSettings<T, N> {
        TorqueJumpSettings {
            com: self.com.cast(),
            momentum_gain: T::of(self.momentum_gain),
            surplus_gain: T::of(self.surplus_gain),
            posture: self.posture.cast(),
            posture_weight: self.posture_weight.map(T::of),
            continuity_weight: T::of(self.continuity_weight),
            strict: self.strict,
            com_weight: T::of(self.com_weight),
            momentum_weight: T::of(self.momentum_weight),
            force_weight: T::of(self.force_weight),
            horizon: self.horizon.cast(),
            max_power: T::of(self.max_power),
            max_steps: self.max_steps,
            knows_friction: self.knows_friction,
        }
    }
}

/// The controller with its memory.
#[derive(Clone, Debug)]
pub struct TorqueJump<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize> {
    /// Gains and weights.
    pub settings: TorqueJumpSettings<T, N>,
    /// s_d: the posture to stay near.
    pub posture: [T; N],
    qp: TorqueQp<T, N, K, V, M>,
    previous: Option<[T; N]>,
    /// Of the centre of mass and of the angular momentum.
    surplus: [Surplus<T, 3>; 2],
}

/// The result of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueTick<T, const N: usize, const K: usize> {
    /// What the program found; `answer.torques` is the command.
    pub answer: TorqueAnswer<T, N, K>,
    /// How far the paper's equalities were from holding.
    pub residuals: Residuals<T>,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueJump<T, N, K, V, M>
{
    /// At rest in a posture.
    #[must_use]
    pub fn new(settings: TorqueJumpSettings<T, N>, posture: [T; N]) -> Self {
        Self {
            settings,
            posture,
            qp: TorqueQp::new(),
            previous: None,
            surplus: [Surplus::NONE; 2],
        }
    }

    /// At rest again in a posture: torques and motion of earlier ticks are forgotten.
    pub const fn restart(&mut self, posture: &[T; N]) {
        self.posture = *posture;
        self.previous = None;
        self.surplus = [Surplus::NONE; 2];
    }

    /// The program of the last tick: for a log, or another solver's opinion.
    #[must_use]
    pub const fn program(&self) -> &TorqueQp<T, N, K, V, M> {
        &self.qp
    }

    /// One tick, `dt` after the last.
    ///
    /// # Errors
    /// As [`TorqueQp::solve`]; the last command, or damping, is then safe.
    pub fn tick<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Contact<T>],
        joints: (&[JointLimits<T>; N], &[Motor<T>; N]),
        wanted: &ComReference<T>,
        dt: T,
    ) -> Result<TorqueTick<T, N, K>, Error> {
        let s = &self.settings;
        let (limits, motors) = joints;
        let (q, qd) = (&snapshot.configuration.joints, &snapshot.velocity.joints);
        let friction = if s.knows_friction {
            joint_friction(limits, qd, T::of(0.1))
        } else {
            [T::ZERO; N]
        };
        self.qp.begin(model, snapshot, contacts, &friction)?; // (6c), (6f)
        let com = snapshot.com(); // (6b)
        let [of_com, of_momentum] = &mut self.surplus;
        let com_target = com.acceleration(
            wanted.acceleration_w.into(),
            wanted.velocity_w.into(),
            position_error(&wanted.position_w, &snapshot.com_w()),
            s.com,
        );
        let com_target = less(com_target, of_com.observe(&com.rate, s.surplus_gain, dt));
        if s.strict {
            self.qp.hold(&com, &com_target)?;
        } else {
            self.qp.minimise(&com, &com_target, &[s.com_weight; 3]);
        }
        let momentum = snapshot.angular_momentum(); // (6d)
        let rate: Vector3<T> = -snapshot.momentum_w.angular * s.momentum_gain;
        let surplus = of_momentum.observe(&momentum.rate, s.surplus_gain, dt);
        let momentum_target = less(rate.into(), surplus);
        if s.strict && s.momentum_weight > T::ZERO {
            self.qp.hold(&momentum, &momentum_target)?;
        } else {
            let weights = [s.momentum_weight; 3];
            self.qp.minimise(&momentum, &momentum_target, &weights);
        }
        let mut posture = self.posture; // (6a)
        for (x, (q, qd)) in posture.iter_mut().zip(q.iter().zip(qd)) {
            *x = s.posture.stiffness * (*x - *q) - s.posture.damping * *qd;
        }
        self.qp.minimise_joints(&posture, &s.posture_weight);
        if let Some(previous) = &self.previous {
            self.qp
                .minimise_torques(previous, &[s.continuity_weight; N]);
        }
        self.qp.minimise_forces(&[T::ZERO; K], &[s.force_weight; K]);
        self.qp.limit_joints(snapshot, limits, &s.horizon); // (6e)
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
        of_com.reached(&com);
        of_momentum.reached(&momentum);
        Ok(TorqueTick {
            answer,
            residuals: Residuals {
                com: distance(&com, &com_target),
                momentum: distance(&momentum, &momentum_target),
            },
        })
    }
}

/// a − b.
fn less<T: Scalar, const R: usize>(mut a: [T; R], b: [T; R]) -> [T; R] {
    for (a, b) in a.iter_mut().zip(b) {
        *a -= b;
    }
    a
}
