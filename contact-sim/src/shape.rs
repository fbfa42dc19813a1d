//! Swept balls where they are, and how near they come to each other.

use nalgebra::Vector3;
use so3::{Scalar, math};

use crate::{Terrain, Touch};

/// Contacts that one shape may have with the world: at both its ends, and where an edge meets it between them.
pub(crate) const SLOTS: usize = 3;
/// Shares of a shape's way that count as its ends.
const END: f64 = 0.01;

/// A swept ball where it is: its ends in the world and its radius.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept<T: Scalar> {
    pub(crate) from_w: Vector3<T>,
    pub(crate) to_w: Vector3<T>,
    pub(crate) radius: T,
}

impl<T: Scalar> Swept<T> {
    pub(crate) const NONE: Self = Self {
        from_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        to_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        radius: T::ZERO,
    };

    /// The point at a share of the way.
    pub(crate) fn at(&self, share: T) -> Vector3<T> {
        self.from_w + (self.to_w - self.from_w) * share
    }

    /// Middle and radius of the ball around it.
    pub(crate) fn bound(&self) -> (Vector3<T>, T) {
        let half = (self.to_w - self.from_w) * T::HALF;
        (
            self.from_w + half,
            self.radius + math::sqrt(half.norm_squared()),
        )
    }

    /// Where it is nearest to the world, and the centre of the ball that touches there.
    pub(crate) fn touches(&self, terrain: &Terrain<T>) -> [(Touch<T>, Vector3<T>); SLOTS] {
        let nothing = Touch {
            depth: -T::ONE,
            normal_w: Vector3::z(),
        };
        let mut out = [(nothing, self.from_w); SLOTS];
        let [first, last, between] = &mut out;
        first.0 = terrain.touch(&self.from_w, self.radius);
        if self.from_w == self.to_w {
            return out;
        }
        *last = (terrain.touch(&self.to_w, self.radius), self.to_w);
        let (center_w, reach) = self.bound();
        let near = terrain
            .block
            .filter(|block| block.is_near(&center_w, reach));
        if let Some(block) = near {
            let share = block.deepest(&self.from_w, &self.to_w);
            if share > T::of(END) && share < T::of(1.0 - END) {
                between.1 = self.at(share);
                let touch = block.touch(&between.1, self.radius);
                // Flat on a face the ends carry the shape; an edge is where the middle is deeper.
                if touch.depth > math::max(first.0.depth, last.0.depth) {
                    between.0 = touch;
                }
            }
        }
        out
    }

    /// Distance to another one, m; negative is the overlap.
    pub(crate) fn gap(&self, other: &Self) -> T {
        let (s, t) = self.nearest(other);
        let apart = self.at(s) - other.at(t);
        math::sqrt(apart.norm_squared()) - self.radius - other.radius
    }

    /// Shares of both ways at which two segments are nearest (Ericson, Real-Time Collision Detection, 5.1.9).
    pub(crate) fn nearest(&self, other: &Self) -> (T, T) {
        let clamp = |x: T| math::clamp(x, T::ZERO, T::ONE);
        let (d1, d2) = (self.to_w - self.from_w, other.to_w - other.from_w);
        let r = self.from_w - other.from_w;
        let (a, e, f) = (d1.norm_squared(), d2.norm_squared(), d2.dot(&r));
        let tiny = T::of(1e-12);
        if a <= tiny && e <= tiny {
            return (T::ZERO, T::ZERO);
        }
        if a <= tiny {
            return (T::ZERO, clamp(f / e));
        }
        let c = d1.dot(&r);
        if e <= tiny {
            return (clamp(-c / a), T::ZERO);
        }
        let b = d1.dot(&d2);
        let wide = a * e - b * b;
        let mut s = if wide > tiny * a * e {
            clamp((b * f - c * e) / wide)
        } else {
            T::ZERO
        };
        let t = (b * s + f) / e;
        if t < T::ZERO {
            s = clamp(-c / a);
        } else if t > T::ONE {
            s = clamp((b - c) / a);
        }
        (s, clamp(t))
    }
}

#[cfg(test)]
mod tests {
    use super::Swept;
    use nalgebra::Vector3;

    fn swept(from: [f64; 3], to: [f64; 3]) -> Swept<f64> {
        Swept {
            from_w: Vector3::from(from),
            to_w: Vector3::from(to),
            radius: 0.1,
        }
    }

    /// No pair of points of a fine grid is nearer than the nearest, for crossing, parallel, touching and degenerate segments.
    #[test]
    fn no_other_points_are_nearer() {
        let segments = [
            swept([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            swept([0.2, -1.0, 0.5], [0.3, 1.0, 0.4]),
            swept([-1.0, 0.3, 0.0], [2.0, 0.3, 0.0]),
            swept([1.5, 0.2, 0.1], [3.0, 0.2, 0.7]),
            swept([0.4, 0.4, 0.4], [0.4, 0.4, 0.4]),
            swept([-0.5, -0.5, -0.1], [-0.5, -0.5, -0.1]),
        ];
        for a in &segments {
            for b in &segments {
                let (s, t) = a.nearest(b);
                let found = (a.at(s) - b.at(t)).norm();
                for i in 0..=100 {
                    for j in 0..=100 {
                        let (s, t) = (f64::from(i) * 0.01, f64::from(j) * 0.01);
                        assert!(found <= (a.at(s) - b.at(t)).norm() + 1e-9);
                    }
                }
            }
        }
    }
}
