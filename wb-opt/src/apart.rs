//! Links that keep apart: how near two segments of the robot are, with derivatives.
//!
//! With the least distance d and the way w(s, t) from a point of the second segment to one of the first, s and t being the shares of their
//! lengths, a row is
//!
//! c = min over 0 ≤ s, t ≤ 1 of |w(s, t)|² / (2 d) + ρ/2 ((s - ½)² + (t - ½)²) ≥ d / 2, with ρ = d / 50.
//!
//! Where the row counts its slope is that of the distance. The second part, a 200th of the distance at most, says which points are the nearest
//! where segments are parallel and many would be; without it they would leap from one end to the other.

use crate::robot::Point;
use nalgebra::Vector3;
use rbd_core::second_order::{Gradient, Hessian, PositionTerms, Sweep};
use so3::{Scalar, math};

/// ρ / d.
const SOFTNESS: f64 = 0.02;

/// A straight part of a link, such as the axis of a capsule; a point where both ends are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<T: Scalar> {
    /// Its ends, points of one link.
    pub ends: [Point<T>; 2],
}

/// Two segments that keep a distance from each other while the joints move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart<T: Scalar> {
    /// The segments.
    pub segments: [Segment<T>; 2],
    /// Least distance between them, m: of the axes of two capsules at least the sum of their radii.
    pub distance: T,
}

/// How near the segments of a pair are to each other.
pub(crate) struct Near<T: Scalar> {
    /// Links of the two segments.
    links: [usize; 2],
    /// Ends of the two segments, world, m.
    ends: [[Vector3<T>; 2]; 2],
    /// From start to end of each, m.
    along: [Vector3<T>; 2],
    /// The nearest points, world, m.
    nearest: [Vector3<T>; 2],
    /// Second derivatives of c in the shares of the first, of both and of the second segment.
    bends: [T; 3],
    /// Which of the nearest points move along their segments.
    slides: [bool; 2],
    /// 1 / d.
    scale: T,
    /// c, m.
    pub(crate) value: T,
}

impl<T: Scalar> Apart<T> {
    pub(crate) fn near<const N: usize>(&self, sweep: &Sweep<'_, T, N>) -> Near<T> {
        let place = |point: &Point<T>| sweep.place(point.link, &point.offset_l);
        let ends = |segment: &Segment<T>| segment.ends.each_ref().map(place);
        let links = self.segments.each_ref().map(|segment| segment.ends[0].link);
        Near::of(links, self.segments.each_ref().map(ends), self.distance)
    }
}

/// Where on the unit square `slopes` · x + ½ x · `bends` x is least, and which coordinates are not at its border.
fn least<T: Scalar>(slopes: &[T; 2], bends: &[T; 3]) -> ([T; 2], [bool; 2]) {
    let [a, b, e] = *bends;
    let [f, g] = *slopes;
    let clamped = |x: T| math::clamp(x, T::ZERO, T::ONE);
    let inside = |x: T| x > T::ZERO && x < T::ONE;
    let wide = a * e - b * b;
    let free = [(b * g - e * f) / wide, (b * f - a * g) / wide];
    if free.iter().all(|x| inside(*x)) {
        return (free, [true; 2]);
    }
    let value = |[s, t]: [T; 2]| s * (f + T::HALF * a * s + b * t) + t * (g + T::HALF * e * t);
    let mut best = ([T::ZERO; 2], T::INFINITY, [false; 2]);
    for edge in [T::ZERO, T::ONE] {
        let (s, t) = (clamped(-(f + b * edge) / a), clamped(-(g + b * edge) / e));
        for (at, slides) in [
            ([edge, t], [false, inside(t)]),
            ([s, edge], [inside(s), false]),
        ] {
            if value(at) < best.1 {
                best = (at, value(at), slides);
            }
        }
    }
    (best.0, best.2)
}

impl<T: Scalar> Near<T> {
    /// Of segments on these links with these ends, for a least distance.
    fn of(links: [usize; 2], ends: [[Vector3<T>; 2]; 2], distance: T) -> Self {
        let along = ends.map(|[from, to]| to - from);
        let between = ends[0][0] - ends[1][0];
        let (scale, soft) = (T::ONE / distance, distance * T::of(SOFTNESS));
        // c = c(0, 0) + slopes · (s, t) + ½ (s, t) · bends (s, t).
        let slopes = [
            between.dot(&along[0]) * scale - soft * T::HALF,
            -between.dot(&along[1]) * scale - soft * T::HALF,
        ];
        let bends = [
            along[0].norm_squared() * scale + soft,
            -along[0].dot(&along[1]) * scale,
            along[1].norm_squared() * scale + soft,
        ];
        let (shares, slides) = least(&slopes, &bends);
        let nearest: [_; 2] = core::array::from_fn(|i| ends[i][0] + along[i] * shares[i]);
        let off = shares.map(|share| (share - T::HALF) * (share - T::HALF));
        let way = (nearest[0] - nearest[1]).norm_squared();
        Self {
            links,
            ends,
            along,
            nearest,
            bends,
            slides,
            scale,
            value: (way * scale + (off[0] + off[1]) * soft) * T::HALF,
        }
    }

    /// Gradient of |w|² / (2 d), times its d, along a direction with the shares held.
    fn gradient_along<const N: usize, const FEET: usize>(
        &self,
        sweep: &Sweep<'_, T, N>,
        direction: &Vector3<T>,
    ) -> Gradient<T, N, FEET> {
        let [to, from] =
            [0, 1].map(|i| sweep.position_gradient(self.links[i], &self.nearest[i], direction));
        let mut gradient: Gradient<T, N, FEET> = to;
        gradient.add(-T::ONE, &from);
        gradient
    }

    /// Gradient of c: the shares are where it has no slope in them, or do not move.
    pub(crate) fn gradient<const N: usize, const FEET: usize>(
        &self,
        sweep: &Sweep<'_, T, N>,
    ) -> Gradient<T, N, FEET> {
        self.gradient_along(sweep, &(self.way() * self.scale))
    }

    fn way(&self) -> Vector3<T> {
        self.nearest[0] - self.nearest[1]
    }

    /// Adds the second derivatives of `y` c: with the shares held (∂w·∂w + w·∂²w) / d, of which the last goes to `terms`; less what c gains as
    /// they move, g·K⁻¹g with their slopes' gradients g and their bends K.
    pub(crate) fn bend<const N: usize, const FEET: usize>(
        &self,
        sweep: &Sweep<'_, T, N>,
        y: T,
        hessian: &mut Hessian<T, N, FEET>,
        terms: &mut PositionTerms<T, N>,
    ) {
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let gradient = self.gradient_along(sweep, &axis);
            hessian.add_outer(y * self.scale, &gradient, 0..N);
        }
        let pull = self.way() * (y * self.scale);
        terms.add(self.links[0], &self.nearest[0], &pull);
        terms.add(self.links[1], &self.nearest[1], &-pull);

        let [a, b, e] = self.bends;
        let mut left = e;
        let mut second = self.slope_gradient(sweep, 1);
        if self.slides[0] {
            let first = self.slope_gradient(sweep, 0);
            hessian.add_outer(-y / a, &first, 0..N);
            second.add(-b / a, &first);
            left -= b * b / a;
        }
        if self.slides[1] {
            hessian.add_outer(-y / left, &second, 0..N);
        }
    }

    /// Gradient of the slope of c in a share.
    fn slope_gradient<const N: usize, const FEET: usize>(
        &self,
        sweep: &Sweep<'_, T, N>,
        segment: usize,
    ) -> Gradient<T, N, FEET> {
        let sign = if segment == 0 {
            self.scale
        } else {
            -self.scale
        };
        let mut gradient = self.gradient_along(sweep, &(self.along[segment] * sign));
        let way = self.way() * sign;
        let [from, to] = self.ends[segment]
            .each_ref()
            .map(|end| sweep.position_gradient(self.links[segment], end, &way));
        gradient.add(T::ONE, &to);
        gradient.add(-T::ONE, &from);
        gradient
    }
}

#[cfg(test)]
mod tests {
    use super::{Near, SOFTNESS};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// Ends of a segment; now and then a point.
    fn segment() -> impl Strategy<Value = [Vector3<f64>; 2]> {
        let end = || prop::array::uniform3(-0.2..0.2_f64).prop_map(Vector3::from);
        prop_oneof![
            4 => (end(), end()).prop_map(|(from, to)| [from, to]),
            1 => end().prop_map(|point| [point; 2]),
        ]
    }

    /// Two segments; now and then parallel.
    fn segments() -> impl Strategy<Value = [[Vector3<f64>; 2]; 2]> {
        let moved = prop::array::uniform3(-0.2..0.2_f64).prop_map(Vector3::from);
        prop_oneof![
            2 => (segment(), segment()).prop_map(|(a, b)| [a, b]),
            1 => (segment(), moved, -1.0..1.0_f64).prop_map(|(a, by, share)| {
                [a, [a[0] + by, a[0] + by + (a[1] - a[0]) * share]]
            }),
        ]
    }

    proptest! {
        /// No pair of points of a fine grid has less, and it is what the two nearest points give, but for what tells parallel ones apart.
        #[test]
        fn no_other_points_are_nearer(ends in segments(), distance in 0.01..0.1_f64) {
            let near = Near::of([0, 1], ends, distance);
            let at = |i: usize, share: f64| ends[i][0] + (ends[i][1] - ends[i][0]) * share;
            let (mut least, mut nearest) = (f64::INFINITY, f64::INFINITY);
            for i in 0..=40 {
                for j in 0..=40 {
                    let (s, t) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                    let way = (at(0, s) - at(1, t)).norm_squared() / (2.0 * distance);
                    let off = (s - 0.5) * (s - 0.5) + (t - 0.5) * (t - 0.5);
                    least = least.min(way + 0.5 * SOFTNESS * distance * off);
                    nearest = nearest.min(way);
                }
            }
            prop_assert!(near.value <= least * (1.0 + 1e-12), "{} {least}", near.value);
            // Between the points of the grid the way is shorter by a half of its meshes at most.
            let mesh = (at(0, 1.0) - at(0, 0.0)).norm() + (at(1, 1.0) - at(1, 0.0)).norm();
            let shortest = (so3::math::sqrt(2.0 * distance * nearest) - mesh / 80.0).max(0.0);
            prop_assert!(near.value >= shortest * shortest / (2.0 * distance) - 1e-15);
            prop_assert!(near.value <= nearest + 0.25 * SOFTNESS * distance + 1e-15);
        }
    }
}
