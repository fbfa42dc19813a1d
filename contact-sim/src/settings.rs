//! Everything about the plant that is not the robot's tables.

use rbd_core::{JointLimits, Motor};
use so3::Scalar;
use so3::math::max;

use crate::{ContactLaw, Stops};

/// Most friction per speed, N m s/rad: with 350 a step turns A1's joints around.
const MOST_DAMPING: f64 = 300.0;

/// Plant settings: step, ground, motors and joint losses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T, const N: usize> {
    /// Time of one tick of [`Simulator::step`](crate::Simulator::step), s.
    pub tick: T,
    /// Integration steps per tick.
    pub substeps: u32,
    /// Ground.
    pub contact: ContactLaw<T>,
    /// Range, viscous and Coulomb friction of each joint.
    pub limits: [JointLimits<T>; N],
    /// Motors.
    pub motors: [Motor<T>; N],
    /// Joint stops.
    pub stops: Stops<T>,
    /// Speed below which Coulomb friction in the joints fades, rad/s: 0.1, and more for more friction than 30 N m, which would shake a joint
    /// that is hardly heavier than its rotor.
    pub friction_smoothing: T,
}

impl<T: Scalar, const N: usize> Settings<T, N> {
    /// 10 kHz ticks of two steps, friction 0.6 on the ground, and joints and motors as the robot's tables
    /// have them.
    #[must_use]
    pub fn new(limits: &[JointLimits<T>; N], motors: &[Motor<T>; N]) -> Self {
        let each = limits.iter().map(|limit| limit.friction);
        let friction = each.fold(T::ZERO, max);
        Self {
            tick: T::of(1e-4),
            substeps: 2,
            contact: ContactLaw::new(T::of(0.6)),
            limits: *limits,
            motors: *motors,
            stops: Stops {
                stiffness: T::of(800.0),
                damping: T::of(2.0),
            },
            friction_smoothing: max(T::of(0.1), friction / T::of(MOST_DAMPING)),
        }
    }
}
