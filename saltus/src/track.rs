//! The base of a robot over time, as a single-rigid-body plan gives it, in the coordinates of a whole-body problem.

use core::f64::consts::{PI, TAU};
use nalgebra::{Matrix3, Vector3};
use wb_opt::{BASE, EulerOrder};

/// Base coordinates at the nodes of a plan, with at least one interval.
pub(crate) struct Track {
    times: Vec<f64>,
    /// Position and angles in the order of the chain, angles without jumps.
    base: Vec<[f64; BASE]>,
}

impl Track {
    /// From the times of the nodes, s, ascending, and the base's position and rotation at each.
    pub(crate) fn new(
        times: Vec<f64>,
        poses: impl Iterator<Item = (Vector3<f64>, Matrix3<f64>)>,
        order: EulerOrder,
    ) -> Self {
        let mut base: Vec<[f64; BASE]> = Vec::with_capacity(times.len());
        for (p, rot_wb) in poses {
            let [first, second, third] = order.angles(&rot_wb);
            let mut row = [p.x, p.y, p.z, first, second, third];
            if let Some(before) = base.last() {
                for (x, x0) in row.iter_mut().zip(before).skip(3) {
                    // Steps above half a turn are jumps of the principal value.
                    if (*x - x0).abs() > PI {
                        *x -= TAU * ((*x - x0) / TAU).round();
                    }
                }
            }
            base.push(row);
        }
        Self { times, base }
    }

    /// The interval at a time: that of the last node at or before it, the last one at the end.
    pub(crate) fn interval(&self, time: f64) -> usize {
        let after = self.times.partition_point(|t| *t <= time + 1e-9);
        after.saturating_sub(1).min(self.times.len() - 2)
    }

    /// Coordinates at a time, linear between nodes.
    pub(crate) fn at(&self, time: f64) -> [f64; BASE] {
        let i = self.interval(time);
        let (from, to) = (&self.base[i], &self.base[i + 1]);
        let share = (time - self.times[i]) / (self.times[i + 1] - self.times[i]);
        let share = share.clamp(0.0, 1.0);
        core::array::from_fn(|c| from[c] + share * (to[c] - from[c]))
    }
}
