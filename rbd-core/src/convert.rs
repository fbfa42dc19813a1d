//! Conversions at the edges: how others write the same base, velocity and joints.
//!
//! Inside Saltus the base is a pose, and its velocity, acceleration and wrench are in base axes, linear
//! first: Pinocchio's free-flyer. Each function here goes one way and says what the other side means; the
//! way back stands beside it.
//!
//! | who | base position | base velocity | legs |
//! |---|---|---|---|
//! | Pinocchio, Saltus | p, quaternion x y z w | Rᵀṗ, ω in base axes | FL FR RL RR |
//! | paper B ("mixed") | p, R | ṗ, ω in world axes | |
//! | MuJoCo | p, quaternion w x y z | ṗ in world, ω in base axes | as modelled |
//! | Unitree | | | FR FL RR RL |
//! | single rigid body | CoM, R | velocity of the CoM, ω | |

use nalgebra::{Rotation3, Vector3};
use so3::{Scalar, quat};

use crate::spatial::{Force, Motion, Transform};

/// Base position as Pinocchio writes it: p, then the quaternion x y z w.
#[must_use]
pub fn base_to_pinocchio<T: Scalar>(base: &Transform<T>) -> [T; 7] {
    let p = base.translation;
    let [x, y, z, w] = quat::to_xyzw(&quat::from_rotation(&base.rotation));
    [p.x, p.y, p.z, x, y, z, w]
}

/// The way back from [`base_to_pinocchio`]; the quaternion is normalised.
///
/// # Errors
/// [`so3::Error`] if the quaternion is zero or not finite.
pub fn base_from_pinocchio<T: Scalar>(q: &[T; 7]) -> Result<Transform<T>, so3::Error> {
    let [px, py, pz, x, y, z, w] = *q;
    let rotation = quat::to_rotation(&quat::from_xyzw([x, y, z, w])?);
    Ok(Transform::new(rotation, Vector3::new(px, py, pz)))
}

/// Base position as MuJoCo's free joint writes it: p, then the quaternion w x y z.
#[must_use]
pub fn base_to_mujoco<T: Scalar>(base: &Transform<T>) -> [T; 7] {
    let [px, py, pz, x, y, z, w] = base_to_pinocchio(base);
    [px, py, pz, w, x, y, z]
}

/// The way back from [`base_to_mujoco`]; the quaternion is normalised.
///
/// # Errors
/// [`so3::Error`] if the quaternion is zero or not finite.
pub fn base_from_mujoco<T: Scalar>(qpos: &[T; 7]) -> Result<Transform<T>, so3::Error> {
    let [px, py, pz, w, x, y, z] = *qpos;
    base_from_pinocchio(&[px, py, pz, x, y, z, w])
}

/// Base velocity as MuJoCo's free joint writes it: ṗ in world axes, ω in base axes.
#[must_use]
pub fn velocity_to_mujoco<T: Scalar>(base: &Transform<T>, velocity: &Motion<T>) -> [T; 6] {
    Motion {
        linear: base.rotation * velocity.linear,
        angular: velocity.angular,
    }
    .to_array()
}

/// The way back from [`velocity_to_mujoco`].
#[must_use]
pub fn velocity_from_mujoco<T: Scalar>(base: &Transform<T>, qvel: &[T; 6]) -> Motion<T> {
    let velocity = Motion::from_array(*qvel);
    Motion {
        linear: base.rotation.inverse() * velocity.linear,
        angular: velocity.angular,
    }
}

/// Base acceleration as MuJoCo writes it, the time derivative of its velocity: (R(v̇ + ω × v), ω̇).
#[must_use]
pub fn acceleration_to_mujoco<T: Scalar>(
    base: &Transform<T>,
    velocity: &Motion<T>,
    acceleration: &Motion<T>,
) -> [T; 6] {
    let classical = acceleration.linear + velocity.angular.cross(&velocity.linear);
    Motion {
        linear: base.rotation * classical,
        angular: acceleration.angular,
    }
    .to_array()
}

/// The way back from [`acceleration_to_mujoco`]; `velocity` is ours, in base axes.
#[must_use]
pub fn acceleration_from_mujoco<T: Scalar>(
    base: &Transform<T>,
    velocity: &Motion<T>,
    qacc: &[T; 6],
) -> Motion<T> {
    let acceleration = velocity_from_mujoco(base, qacc);
    Motion {
        linear: acceleration.linear - velocity.angular.cross(&velocity.linear),
        angular: acceleration.angular,
    }
}

/// Wrench on the base as MuJoCo writes it, so that power is the same: force in world, moment in base axes.
#[must_use]
pub fn force_to_mujoco<T: Scalar>(base: &Transform<T>, force: &Force<T>) -> [T; 6] {
    Force {
        linear: base.rotation * force.linear,
        angular: force.angular,
    }
    .to_array()
}

/// The way back from [`force_to_mujoco`].
#[must_use]
pub fn force_from_mujoco<T: Scalar>(base: &Transform<T>, qfrc: &[T; 6]) -> Force<T> {
    let force = Force::from_array(*qfrc);
    Force {
        linear: base.rotation.inverse() * force.linear,
        angular: force.angular,
    }
}

/// Paper B's mixed base velocity: velocity of the base's origin and angular velocity, both in world axes.
#[must_use]
pub fn velocity_to_mixed<T: Scalar>(base: &Transform<T>, velocity: &Motion<T>) -> Motion<T> {
    rotate_motion(&base.rotation, velocity)
}

/// The way back from [`velocity_to_mixed`].
#[must_use]
pub fn velocity_from_mixed<T: Scalar>(base: &Transform<T>, mixed: &Motion<T>) -> Motion<T> {
    rotate_motion(&base.rotation.inverse(), mixed)
}

/// Time derivative of the mixed velocity: (R(v̇ + ω × v), R ω̇).
#[must_use]
pub fn acceleration_to_mixed<T: Scalar>(
    base: &Transform<T>,
    velocity: &Motion<T>,
    acceleration: &Motion<T>,
) -> Motion<T> {
    let classical = acceleration.linear + velocity.angular.cross(&velocity.linear);
    Motion {
        linear: base.rotation * classical,
        angular: base.rotation * acceleration.angular,
    }
}

/// The way back from [`acceleration_to_mixed`]; `velocity` is ours, in base axes.
#[must_use]
pub fn acceleration_from_mixed<T: Scalar>(
    base: &Transform<T>,
    velocity: &Motion<T>,
    mixed: &Motion<T>,
) -> Motion<T> {
    let acceleration = rotate_motion(&base.rotation.inverse(), mixed);
    Motion {
        linear: acceleration.linear - velocity.angular.cross(&velocity.linear),
        angular: acceleration.angular,
    }
}

/// Wrench on the base, about its origin, from base axes to the world axes that go with the mixed velocity.
#[must_use]
pub fn force_to_mixed<T: Scalar>(base: &Transform<T>, force: &Force<T>) -> Force<T> {
    Force {
        linear: base.rotation * force.linear,
        angular: base.rotation * force.angular,
    }
}

/// The way back from [`force_to_mixed`].
#[must_use]
pub fn force_from_mixed<T: Scalar>(base: &Transform<T>, mixed: &Force<T>) -> Force<T> {
    let back = base.rotation.inverse();
    Force {
        linear: back * mixed.linear,
        angular: back * mixed.angular,
    }
}

/// Pose of the single rigid body: the base's axes at the centre of mass. `com_b` is the CoM in the base frame, m.
#[must_use]
pub fn pose_to_com<T: Scalar>(base: &Transform<T>, com_b: &Vector3<T>) -> Transform<T> {
    Transform::new(base.rotation, base.point(com_b))
}

/// The way back from [`pose_to_com`].
#[must_use]
pub fn pose_from_com<T: Scalar>(body: &Transform<T>, com_b: &Vector3<T>) -> Transform<T> {
    let origin = body.translation - body.rotation * com_b;
    Transform::new(body.rotation, origin)
}

/// Velocity with the CoM for its reference point, in base axes: (v + ω × c + ċ, ω).
///
/// `com_b` is the CoM c in the base frame, m; `com_rate_b` its velocity there, ċ = J_c q̇, m/s: what the joints
/// add. Zero for legs that stand still.
#[must_use]
pub fn velocity_to_com<T: Scalar>(
    velocity: &Motion<T>,
    com_b: &Vector3<T>,
    com_rate_b: &Vector3<T>,
) -> Motion<T> {
    Motion {
        linear: velocity.linear + velocity.angular.cross(com_b) + com_rate_b,
        angular: velocity.angular,
    }
}

/// The way back from [`velocity_to_com`].
#[must_use]
pub fn velocity_from_com<T: Scalar>(
    velocity: &Motion<T>,
    com_b: &Vector3<T>,
    com_rate_b: &Vector3<T>,
) -> Motion<T> {
    Motion {
        linear: velocity.linear - velocity.angular.cross(com_b) - com_rate_b,
        angular: velocity.angular,
    }
}

/// Legs between our order FL FR RL RR and Unitree's FR FL RR RL; the same function goes back.
#[must_use]
pub fn swap_unitree_legs<X: Copy>([a, b, c, d]: [X; 4]) -> [X; 4] {
    [b, a, d, c]
}

/// Joints of four legs of three between our order and Unitree's; the same function goes back.
#[must_use]
pub fn swap_unitree_joints<X: Copy>(joints: [X; 12]) -> [X; 12] {
    let [a, b, c, d, e, f, g, h, i, j, k, l] = joints;
    [d, e, f, a, b, c, j, k, l, g, h, i]
}

/// Where each joint of one order stands in another: entry i is the index in `from` of the name `to[i]`.
///
/// `None` if a name of `to` is not in `from`.
#[must_use]
pub fn order_by_names<const N: usize>(from: &[&str], to: &[&str; N]) -> Option<[usize; N]> {
    let mut order = [0; N];
    for (slot, name) in order.iter_mut().zip(to) {
        *slot = from.iter().position(|other| other == name)?;
    }
    Some(order)
}

/// Values in the order that [`order_by_names`] found: entry i is `values[order[i]]`, or zero beyond the end.
#[must_use]
pub fn reordered<T: Scalar, const N: usize>(values: &[T], order: &[usize; N]) -> [T; N] {
    order.map(|i| values.get(i).copied().unwrap_or(T::ZERO))
}

fn rotate_motion<T: Scalar>(rotation: &Rotation3<T>, motion: &Motion<T>) -> Motion<T> {
    Motion {
        linear: rotation * motion.linear,
        angular: rotation * motion.angular,
    }
}
