//! What a row of a node constrains, for answers that people read. The order is that of [`crate::rows`].

use crate::dynamics::force_unit;
use crate::problem::Problem;
use so3::Scalar;

/// What a row constrains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// A foot in the leg's workspace, along an axis of the body.
    Reach {
        /// The foot.
        foot: usize,
        /// Axis of the body.
        axis: usize,
    },
    /// A corner over the ground.
    Clearance {
        /// The corner.
        corner: usize,
    },
    /// Duration of a phase.
    Duration {
        /// The phase.
        phase: usize,
    },
    /// Sum of the durations.
    Total,
    /// Position at the end, along an axis of the world.
    Goal {
        /// Axis of the world.
        axis: usize,
    },
    /// Rotation at the end.
    Rotation,
    /// Friction of a foot.
    Friction {
        /// The foot.
        foot: usize,
    },
    /// Normal force of a foot.
    Force {
        /// The foot.
        foot: usize,
    },
}

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// What row `row` of node `k` constrains, and the unit in which the solver has it; none if there is no such row.
    #[must_use]
    pub fn row(&self, k: usize, row: usize) -> Option<(Row, T)> {
        let standing = || {
            let phase = self.phase_of(k).filter(|_| k < self.intervals());
            let flags = phase.map_or([false; FEET], |(_, phase)| phase.contacts);
            flags
                .into_iter()
                .enumerate()
                .filter(|(_, on)| *on)
                .map(|(foot, _)| foot)
        };
        let feet = standing().count();
        let mut at = row;
        let mut within = |count: usize| {
            let inside = (at < count).then_some(at);
            at = at.saturating_sub(count);
            inside
        };
        if k > 0 {
            if let Some(i) = within(feet.saturating_mul(3)) {
                let foot = standing().nth(i / 3)?;
                return Some((Row::Reach { foot, axis: i % 3 }, T::ONE));
            }
            if let Some(corner) = within(8) {
                return Some((Row::Clearance { corner }, T::ONE));
            }
        } else {
            if let Some(phase) = within(self.phase_count) {
                return Some((Row::Duration { phase }, T::ONE));
            }
            if within(1).is_some() {
                return Some((Row::Total, T::ONE));
            }
        }
        if k == self.intervals() {
            if let Some(axis) = within(3) {
                return Some((Row::Goal { axis }, T::ONE));
            }
            return within(4).map(|_| (Row::Rotation, T::ONE));
        }
        let i = within(feet.saturating_mul(5))?;
        let foot = standing().nth(i / 5)?;
        let row = if i % 5 < 4 {
            Row::Friction { foot }
        } else {
            Row::Force { foot }
        };
        Some((row, force_unit(self)))
    }
}
