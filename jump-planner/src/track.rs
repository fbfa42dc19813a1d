//! The base of a robot over time, as a single-rigid-body plan gives it.

use core::f64::consts::{PI, TAU};
use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::Transform;
use wb_opt::{BASE, EulerOrder};

/// Where the base is at the nodes of a plan, with at least one interval.
pub struct Track<P> {
    times: Vec<f64>,
    places: Vec<P>,
}

/// A place of the base that has places between it and another.
pub trait Between {
    /// A share of the way to `to`.
    fn between(&self, to: &Self, share: f64) -> Self;
}

impl Between for Transform<f64> {
    fn between(&self, to: &Self, share: f64) -> Self {
        let turn = so3::Geodesic::shortest(&self.rotation, &to.rotation);
        let move_w = to.translation - self.translation;
        Self::new(turn.at(share), self.translation + move_w * share)
    }
}

/// Position and angles in the order of a chain.
impl Between for [f64; BASE] {
    fn between(&self, to: &Self, share: f64) -> Self {
        core::array::from_fn(|c| self[c] + share * (to[c] - self[c]))
    }
}

impl Track<Transform<f64>> {
    /// From the times of the nodes, s, ascending, and the base's position and rotation at each.
    pub fn new(times: Vec<f64>, poses: impl Iterator<Item = (Vector3<f64>, Matrix3<f64>)>) -> Self {
        // A product of Taylor exponentials is a rotation only nearly.
        let places = poses.map(|(pos, rot)| {
            let near = Rotation3::from_matrix_unchecked(rot);
            Transform::new(so3::exp(&so3::log(&near)), pos)
        });
        let places = places.collect();
        Self { times, places }
    }
}

impl Track<[f64; BASE]> {
    /// As [`Track::new`], in angles without jumps.
    pub fn in_angles(
        times: Vec<f64>,
        poses: impl Iterator<Item = (Vector3<f64>, Matrix3<f64>)>,
        order: EulerOrder,
    ) -> Self {
        let mut places: Vec<[f64; BASE]> = Vec::with_capacity(times.len());
        for (p, rot_wb) in poses {
            let [first, second, third] = order.angles(&rot_wb);
            let mut row = [p.x, p.y, p.z, first, second, third];
            if let Some(before) = places.last() {
                for (x, x0) in row.iter_mut().zip(before).skip(3) {
                    // Steps above half a turn are jumps of the principal value.
                    if (*x - x0).abs() > PI {
                        *x -= TAU * ((*x - x0) / TAU).round();
                    }
                }
            }
            places.push(row);
        }
        Self { times, places }
    }
}

impl<P: Between> Track<P> {
    /// The interval at a time: that of the last node at or before it, the last one at the end.
    #[must_use]
    pub fn interval(&self, time: f64) -> usize {
        let after = self.times.partition_point(|t| *t <= time + 1e-9);
        after.saturating_sub(1).min(self.times.len() - 2)
    }

    /// Place at a time, on the straight way between nodes.
    #[must_use]
    pub fn at(&self, time: f64) -> P {
        let i = self.interval(time);
        let share = (time - self.times[i]) / (self.times[i + 1] - self.times[i]);
        self.places[i].between(&self.places[i + 1], share.clamp(0.0, 1.0))
    }
}
