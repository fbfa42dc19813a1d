//! Ranges of the joints that a plan uses: not up to their stops.

use rbd_core::JointLimits;

/// Way of a joint that a plan leaves before its stops, rad. In the lab a knee is up to 0.08 rad more stretched at the take-off than planned, on ground that
/// gives or below a trunk that is higher, and turns faster, and its motor needs the rest to stop it.
const MARGIN: f64 = 0.1;

/// Takes the margin, and a share of its range, from a joint's range at both ends. A posture in which the robot stands or lands stays in it, however near
/// to a stop: half the way to there is left.
pub(crate) fn keep_away(limit: &mut JointLimits<f64>, share: f64, stands: [f64; 2]) {
    let [lowest, highest] = [stands[0].min(stands[1]), stands[0].max(stands[1])];
    let rooms = [lowest - limit.lower, limit.upper - highest];
    let [below, above] = rooms.map(|room| MARGIN.min(0.5 * room.max(0.0)));
    let drawn = share * (limit.upper - limit.lower);
    // A share of an infinite range is none.
    let drawn = if drawn.is_finite() { drawn } else { 0.0 };
    limit.lower += below + drawn;
    limit.upper -= above + drawn;
}

#[cfg(test)]
mod tests {
    use super::{MARGIN, keep_away};
    use rbd_core::JointLimits;

    #[test]
    fn joints_keep_away_from_their_stops_but_not_from_where_the_robot_stands() {
        let kept = |[lower, upper]: [f64; 2], share, stands| {
            let mut limit = JointLimits {
                lower,
                upper,
                ..JointLimits::NONE
            };
            keep_away(&mut limit, share, stands);
            [limit.lower, limit.upper]
        };
        let near = |found: [f64; 2], wanted: [f64; 2]| {
            assert!((found[0] - wanted[0]).abs() < 1e-12, "{found:?}");
            assert!((found[1] - wanted[1]).abs() < 1e-12, "{found:?}");
        };
        let range = [-2.7, -0.9];
        near(
            kept(range, 0.0, [-1.6, -1.4]),
            [-2.7 + MARGIN, -0.9 - MARGIN],
        );
        near(kept(range, 0.01, [-1.6, -1.4]), [-2.582, -1.018]);
        // It stands 0.06 rad before one stop, or lands beyond the other.
        near(kept(range, 0.0, [-0.96, -1.4]), [-2.6, -0.93]);
        near(kept(range, 0.0, [-1.6, -2.8]), [-2.7, -1.0]);
        let infinite = [f64::NEG_INFINITY, f64::INFINITY];
        assert_eq!(kept(infinite, 0.01, [0.0, 1.0]), infinite);
    }
}
