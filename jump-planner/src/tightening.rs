//! Limits drawn in by what the audit of a plan found beyond them between its nodes.
//!
//! A plan's rows hold in the middle of its intervals. Torques are held over an interval, so where legs turn fast the forces between nodes
//! leave those of the middle: a foot's by a few per cent of the largest in a quick roll. Which limit that breaks, and by how much, is
//! known once there is a plan; a margin for all tasks would take from those that do not need it.

use crate::audit::{Audit, Limit};

/// How much more than what was exceeded limits are drawn in, since the plan that follows is another one.
const FACTOR: f64 = 1.5;

/// Shares of their ranges by which limits are drawn in; of heights, of the leg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tightening {
    /// Ranges of the joints, at both ends.
    pub position: f64,
    /// Speeds, those of the torque-speed lines included.
    pub speed: f64,
    /// Joint torques.
    pub torque: f64,
    /// The friction cone, whose apex rises by that share of the largest normal force.
    pub friction: f64,
    /// Heights over the ground: of feet on their way, of knees and of the trunk.
    pub height: f64,
}

impl Tightening {
    /// Drawn in further by what an audit found. None where that is no remedy: the plan passes, its flight is not true to the
    /// dynamics, or something else than these limits is exceeded.
    pub(crate) fn after(&self, audit: &Audit) -> Option<Self> {
        let (mut before, mut next) = (*self, *self);
        // Links that pass through each other are no matter of margins, and the plan is a motion all the same.
        let exceeded = audit.exceeded()?;
        for margin in exceeded.filter(|margin| margin.limit != Limit::Robot) {
            let drawn = *before.share(margin.limit)? - FACTOR * margin.value;
            let share = next.share(margin.limit)?;
            *share = share.max(drawn);
        }
        (next != *self).then_some(next)
    }

    fn share(&mut self, limit: Limit) -> Option<&mut f64> {
        match limit {
            Limit::Position => Some(&mut self.position),
            Limit::Speed => Some(&mut self.speed),
            Limit::Torque => Some(&mut self.torque),
            Limit::Friction => Some(&mut self.friction),
            Limit::Height | Limit::Ground => Some(&mut self.height),
            Limit::NormalForce | Limit::Robot => None,
        }
    }
}

impl core::fmt::Display for Tightening {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for (share, limit) in [
            (self.position, "positions"),
            (self.speed, "speeds"),
            (self.torque, "torques"),
            (self.friction, "friction"),
            (self.height, "heights"),
        ] {
            if share > 0.0 {
                write!(f, ", {limit} drawn in by {:.1} %", 100.0 * share)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::audit::Margin;

    /// An audit of a true motion with these margins.
    fn audit(margins: &[(Limit, f64)]) -> Audit {
        let margin = |(limit, value): &(Limit, f64)| Margin {
            limit: *limit,
            name: String::new(),
            value: *value,
            time: 0.0,
        };
        Audit::with_margins(margins.iter().map(margin).collect())
    }

    #[test]
    fn what_is_exceeded_most_is_drawn_in_and_adds_up() {
        let first = Tightening::default()
            .after(&audit(&[
                (Limit::Friction, -0.02),
                (Limit::Friction, -0.03),
                (Limit::Speed, 0.2),
            ]))
            .unwrap();
        let friction = FACTOR * 0.03;
        assert_eq!(
            first,
            Tightening {
                friction,
                ..Tightening::default()
            }
        );
        let second = first.after(&audit(&[
            (Limit::Position, -0.02),
            (Limit::Friction, -0.011),
        ]));
        let second = second.unwrap();
        assert_eq!(second.position, FACTOR * 0.02);
        assert!((second.friction - FACTOR * 0.041).abs() < 1e-12);
    }

    #[test]
    fn a_link_in_the_ground_raises_all_heights() {
        let margins = [
            (Limit::Ground, -0.03),
            (Limit::Height, -0.02),
            (Limit::Robot, -0.5),
        ];
        let raised = Tightening::default().after(&audit(&margins)).unwrap();
        let height = FACTOR * 0.03;
        assert_eq!(
            raised,
            Tightening {
                height,
                ..Tightening::default()
            }
        );
        assert_eq!(raised.to_string(), ", heights drawn in by 4.5 %");
    }

    #[test]
    fn nothing_is_drawn_in_where_that_is_no_remedy() {
        let none = |margins: &[(Limit, f64)]| Tightening::default().after(&audit(margins));
        assert_eq!(none(&[(Limit::Friction, -0.005)]), None);
        assert_eq!(none(&[(Limit::Robot, -0.5)]), None);
        assert_eq!(
            none(&[(Limit::NormalForce, -0.1), (Limit::Friction, -0.1)]),
            None
        );
        let mut untrue = audit(&[(Limit::Friction, -0.1)]);
        untrue.flight_orientation_error = 1.0;
        assert_eq!(Tightening::default().after(&untrue), None);
    }
}
