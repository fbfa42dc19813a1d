//! What a row of a node constrains, for answers that people read. The order is that of [`crate::rows`].

use crate::problem::Problem;
use crate::robot::BASE;
use crate::state::Units;
use so3::Scalar;

/// What a row constrains. Coordinates count from the base's first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// A joint at the pre-landing configuration, at rest.
    Landing,
    /// Friction or normal force of a foot.
    Friction {
        /// The foot.
        foot: usize,
    },
    /// Equations of motion of the base.
    Dynamics,
    /// Acceleration of a foot that stands.
    Slip {
        /// The foot.
        foot: usize,
    },
    /// Effort of a joint.
    Effort {
        /// Coordinate of the joint.
        joint: usize,
    },
    /// Torque-speed line of a joint.
    Line {
        /// Coordinate of the joint.
        joint: usize,
    },
    /// A foot that stands away from its place.
    Drift {
        /// The foot.
        foot: usize,
    },
    /// Height of a point.
    Clearance {
        /// The point.
        point: usize,
    },
    /// Height of a foot in the air.
    Swing {
        /// The foot.
        foot: usize,
    },
    /// Position of a joint.
    Position {
        /// Coordinate of the joint.
        joint: usize,
    },
    /// Speed of a joint.
    Speed {
        /// Coordinate of the joint.
        joint: usize,
    },
    /// Two links that keep apart.
    Apart {
        /// The pair.
        pair: usize,
    },
    /// Base at the end, by coordinate.
    Goal {
        /// Coordinate of the base.
        axis: usize,
    },
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// What row `row` of node `k` constrains, and the unit in which the solver has it; none if there is no such row.
    #[must_use]
    pub fn row(&self, k: usize, row: usize) -> Option<(Row, T)> {
        let units = Units::new();
        if k >= self.intervals() {
            return (row < BASE).then_some((Row::Goal { axis: row }, T::ONE));
        }
        let groups = self.groups(k);
        let foot = |wanted: bool, i: usize| {
            let flags = self.contacts(k).into_iter().enumerate();
            let mut feet = flags.filter(|(_, on)| *on == wanted).map(|(foot, _)| foot);
            feet.nth(i)
        };
        let mut at = row;
        let mut within = |count: usize| {
            let inside = (at < count).then_some(at);
            at = at.saturating_sub(count);
            inside
        };
        if within(groups.landing).is_some() {
            return Some((Row::Landing, T::ONE));
        }
        if let Some(i) = within(groups.forces()) {
            return foot(true, i / groups.per_foot.max(1))
                .map(|foot| (Row::Friction { foot }, units.force));
        }
        if let Some(i) = within(BASE) {
            return Some((Row::Dynamics, units.effort(i)));
        }
        if let Some(i) = within(groups.feet.saturating_mul(3)) {
            return foot(true, i / 3).map(|foot| (Row::Slip { foot }, units.foot_acceleration));
        }
        let joint = |i: usize| BASE.saturating_add(i);
        if let Some(i) = within(groups.joints) {
            return Some((Row::Effort { joint: joint(i) }, units.moment));
        }
        if let Some(i) = within(groups.lines) {
            let joint = joint(i % groups.joints.max(1));
            return Some((Row::Line { joint }, units.moment));
        }
        if let Some(i) = within(groups.feet.saturating_mul(3)) {
            return foot(true, i / 3).map(|foot| (Row::Drift { foot }, units.position));
        }
        if let Some(point) = within(groups.clearances) {
            return Some((Row::Clearance { point }, units.position));
        }
        if let Some(i) = within(groups.swing) {
            return foot(false, i).map(|foot| (Row::Swing { foot }, units.position));
        }
        if let Some(i) = within(groups.limited) {
            return Some((Row::Position { joint: joint(i) }, T::ONE));
        }
        if let Some(i) = within(groups.limited) {
            return Some((Row::Speed { joint: joint(i) }, units.speed));
        }
        within(groups.apart).map(|pair| (Row::Apart { pair }, units.position))
    }
}
