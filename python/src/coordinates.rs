//! Where a robot is and how it moves, as Pinocchio writes them: q = (p, quaternion x y z w, joints), v = (ṗ and ω in base axes, joints).

use jump_planner::robot::State;
use jump_planner::{JOINTS, Velocity};
use nalgebra::{Rotation3, Vector3};
use pyo3::PyResult;
use rbd_core::convert::{base_from_pinocchio, base_to_pinocchio};
use rbd_core::{Effort, Force, Motion, Tangent, Transform};

use crate::arrays::{Numbers, vector};
use crate::errors::bad;

/// Numbers of a configuration.
pub(crate) const NQ: usize = 7 + JOINTS;
/// Numbers of a velocity.
pub(crate) const NV: usize = 6 + JOINTS;

/// The first `A` numbers, and the joints' after them.
fn split<const A: usize>(x: &[f64]) -> ([f64; A], [f64; JOINTS]) {
    let mut parts = ([0.0; A], [0.0; JOINTS]);
    for (to, from) in parts.0.iter_mut().chain(&mut parts.1).zip(x) {
        *to = *from;
    }
    parts
}

/// A configuration; its quaternion is normalised.
pub(crate) fn configuration(name: &str, q: &Numbers<'_>) -> PyResult<State> {
    let (base, joints) = split::<7>(&vector::<NQ>(name, q)?);
    let base = base_from_pinocchio(&base).map_err(|error| bad(format!("{name}[3:7]: {error}")))?;
    Ok(State { base, joints })
}

/// A configuration that was measured: where its quaternion is none, the base is not a number, and the machine says so.
pub(crate) fn measured(name: &str, q: &Numbers<'_>) -> PyResult<State> {
    let (base, joints) = split::<7>(&vector::<NQ>(name, q)?);
    let nowhere = Transform::new(Rotation3::identity(), Vector3::from_element(f64::NAN));
    Ok(State {
        base: base_from_pinocchio(&base).unwrap_or(nowhere),
        joints,
    })
}

/// A velocity, an acceleration or a displacement.
pub(crate) fn tangent(name: &str, v: &Numbers<'_>) -> PyResult<Velocity> {
    let (base, joints) = split::<6>(&vector::<NV>(name, v)?);
    Ok(Tangent {
        base: Motion::from_array(base),
        joints,
    })
}

/// Force on the base, and torques.
pub(crate) fn effort(name: &str, tau: &Numbers<'_>) -> PyResult<Effort<f64, JOINTS>> {
    Ok(effort_of(&vector::<NV>(name, tau)?))
}

/// A row over a velocity, or a force and torques.
pub(crate) fn effort_of(row: &[f64]) -> Effort<f64, JOINTS> {
    let (base, joints) = split::<6>(row);
    Effort {
        base: Force::from_array(base),
        joints,
    }
}

/// Base and joints one after the other.
pub(crate) fn joined<const K: usize>(base: &[f64], joints: &[f64]) -> [f64; K] {
    let mut out = [0.0; K];
    for (to, from) in out.iter_mut().zip(base.iter().chain(joints)) {
        *to = *from;
    }
    out
}

/// The way back from [`configuration`].
pub(crate) fn of_configuration(q: &State) -> [f64; NQ] {
    joined(&base_to_pinocchio(&q.base), &q.joints)
}

/// The way back from [`tangent`].
pub(crate) fn of_tangent(v: &Velocity) -> [f64; NV] {
    joined(&v.base.to_array(), &v.joints)
}

/// The way back from [`effort`].
pub(crate) fn of_effort(tau: &Effort<f64, JOINTS>) -> [f64; NV] {
    joined(&tau.base.to_array(), &tau.joints)
}
