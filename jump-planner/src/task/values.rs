//! What the numbers of a task file may be: wide enough for any legged robot, narrow enough that nothing overflows, no memory is asked for
//! that is not there, and a slip of the pen is named.

use super::file::{LimitsTable, WeightsTable};
use crate::range::Range::{self, Above, From};
use crate::range::{Unusable, require, within};

/// Lengths and displacements, m.
pub(crate) const LENGTH: Range = From(-100.0, 100.0);
/// Ten turns, degrees.
pub(crate) const TURN: Range = From(-3600.0, 3600.0);
/// Length of an axis, which is scaled to 1.
pub(crate) const AXIS: Range = From(1e-6, 1e6);
/// Duration of a phase, s.
pub(crate) const DURATION: Range = Above(0.0, 5.0);
/// Duration of a jump, s: intervals of milliseconds are held in memory.
pub(crate) const TOTAL: Range = Above(0.0, 10.0);
/// Largest normal force of a foot of the rigid body where none is given, in weights of the robot: paper A's, Table I.
pub(crate) const BODY_FORCE: f64 = 1.18695;
/// A share of what there is.
const SHARE: Range = Above(0.0, 1.0);
/// Weights of costs.
const WEIGHT: Range = From(1e-12, 1e12);

pub(crate) fn limits(limits: &LimitsTable) -> Result<(), Unusable> {
    within(limits.friction, From(0.0, 10.0), "limits.friction")?;
    within(limits.friction_share, SHARE, "limits.friction_share")?;
    within(
        limits.force_weights.unwrap_or(BODY_FORCE),
        Above(0.0, 100.0),
        "limits.force_weights",
    )?;
    within(limits.speed_share, SHARE, "limits.speed_share")?;
    within(limits.clearance_m, From(0.0, 10.0), "limits.clearance_m")?;
    let shares = limits.torque_shares.iter();
    shares
        .copied()
        .try_for_each(|x| within(x, SHARE, "limits.torque_shares"))?;
    require(
        limits.torque_shares.is_sorted(),
        "limits.torque_shares",
        &format!("must be rising, not {:?}", limits.torque_shares),
    )
}

pub(crate) fn weights(weights: &WeightsTable) -> Result<(), Unusable> {
    let all = [
        ("weights.omega", weights.omega),
        ("weights.force", weights.force),
        ("weights.rotation", weights.rotation),
        ("weights.position", weights.position),
        ("weights.torque", weights.torque),
        ("weights.goal", weights.goal),
    ];
    all.into_iter()
        .try_for_each(|(key, x)| within(x, WEIGHT, key))
}
