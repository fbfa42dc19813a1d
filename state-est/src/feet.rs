//! Feet, and what the legs say of them.

use nalgebra::{Matrix3, Vector3};
use rbd_core::{Contact, ContactShape, Frame};
use so3::Scalar;

use crate::Settings;

/// A foot: the centre of a ball that may roll, or the middle of a sole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot<T> {
    /// Where it is.
    pub frame: Frame<T>,
    /// Radius of the ball, m; zero for a sole, which neither rolls nor turns while it stands.
    pub radius: T,
}

impl<T: Scalar> Foot<T> {
    /// A robot's contact: a ball by its centre, a sole by its middle.
    #[must_use]
    pub fn of(contact: &Contact<T>) -> Self {
        match contact.shape {
            ContactShape::Sphere { radius } => Self {
                frame: contact.frame,
                radius,
            },
            ContactShape::Rectangle {
                x: [a, b],
                y: [c, d],
            } => {
                let middle = Vector3::new((a + b) * T::HALF, (c + d) * T::HALF, T::ZERO);
                let mut frame = contact.frame;
                frame.offset = frame.placement().point(&middle).into();
                Self {
                    frame,
                    radius: T::ZERO,
                }
            }
        }
    }
}

/// A foot as the legs say: from the IMU's point, world axes.
#[derive(Clone, Copy)]
pub(crate) struct Seen<T: Scalar> {
    /// Place.
    pub(crate) arm_w: Vector3<T>,
    /// Velocity of the IMU's point if the foot stands or rolls.
    pub(crate) velocity_w: Vector3<T>,
    /// Velocity of a ball's centre while it rolls.
    pub(crate) rolling_w: Vector3<T>,
    /// Angular velocity of a sole, which would be zero if it stands; none for a ball, which may roll.
    pub(crate) turning_w: Option<Vector3<T>>,
    /// Evidence of contact; zero where the leg cannot be used.
    pub(crate) evidence: T,
}

/// Angular velocity, world axes, that the soles in contact miss in the gyroscope's: with it, they would not turn; none without such a sole.
///
/// The middles of two soles say nothing about the axis through them ([`turn_of_feet`]), about which a humanoid leans forward; one sole that
/// stands says all.
pub(crate) fn turn_of_soles<T: Scalar, const F: usize>(
    seen: &[Seen<T>; F],
    confidence: &[T; F],
) -> Option<Vector3<T>> {
    let feet = seen.iter().zip(confidence);
    let standing = feet.filter(|(_, c)| **c > T::HALF);
    let (mut sum, mut count) = (Vector3::zeros(), T::ZERO);
    for turning in standing.filter_map(|(foot, _)| foot.turning_w) {
        sum -= turning;
        count += T::ONE;
    }
    (count > T::ZERO).then(|| sum / count)
}

/// The velocity on which more than half of all feet agree, if they do.
pub(crate) fn consensus<T: Scalar, const F: usize>(
    seen: &[Seen<T>; F],
    settings: &Settings<T>,
) -> Option<Vector3<T>> {
    let standing = || seen.iter().filter(|foot| foot.evidence > T::HALF);
    let count = standing().count();
    if 2 * count <= F {
        return None;
    }
    let sum: Vector3<T> = standing().fold(Vector3::zeros(), |sum, foot| sum + foot.velocity_w);
    let mean = sum / T::of(count as f64);
    let agree = standing().all(|foot| (foot.velocity_w - mean).norm() < settings.slip_gate);
    agree.then_some(mean)
}

/// Angular velocity, world axes, that the feet in contact miss in the gyroscope's: with it, they would all stand.
///
/// With d_i from the middle of these feet and V_i the velocity that foot i gives the body, δ × d_i = V_i − V̄ in the sense
/// of least squares: (Σ |d|² 1 − d dᵀ + λ 1) δ = Σ d × (V_i − V̄). Two feet say nothing about the axis through them, and λ
/// leaves it at zero.
pub(crate) fn turn_of_feet<T: Scalar, const F: usize>(
    seen: &[Seen<T>; F],
    confidence: &[T; F],
) -> Vector3<T> {
    let standing = || {
        let feet = seen.iter().zip(confidence);
        feet.filter(|(_, c)| **c > T::HALF).map(|(foot, _)| foot)
    };
    let share = T::ONE / T::of(standing().count().max(1) as f64);
    let zero = (Vector3::zeros(), Vector3::zeros());
    let (arm, velocity) = standing().fold(zero, |(arm, velocity), foot| {
        (arm + foot.arm_w * share, velocity + foot.velocity_w * share)
    });
    let mut square = Matrix3::from_diagonal_element(T::of(0.01));
    let mut moment = Vector3::zeros();
    for foot in standing() {
        let d = foot.arm_w - arm;
        square += Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose();
        moment += d.cross(&(foot.velocity_w - velocity));
    }
    square
        .try_inverse()
        .map_or_else(Vector3::zeros, |inverse| inverse * moment)
}
