//! What the world is made of: a floor and, where a task has one, a block with true edges.

use nalgebra::Vector3;
use so3::{Scalar, math};

/// An axis-aligned solid block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block<T> {
    /// Lowest corner in the world, m.
    pub lower: [T; 3],
    /// Highest corner in the world, m.
    pub upper: [T; 3],
}

/// Floor and block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terrain<T> {
    /// Height of the floor, m.
    pub floor: T,
    /// A block standing anywhere.
    pub block: Option<Block<T>>,
}

/// Where a sphere meets the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<T: Scalar> {
    /// Penetration, m; negative is the gap.
    pub depth: T,
    /// Unit normal out of the ground, world axes.
    pub normal_w: Vector3<T>,
}

impl<T: Scalar> Terrain<T> {
    /// A floor at height zero and nothing else.
    pub const FLAT: Self = Self {
        floor: T::ZERO,
        block: None,
    };

    /// The deepest contact of a sphere with floor and block.
    #[must_use]
    pub fn touch(&self, center_w: &Vector3<T>, radius: T) -> Touch<T> {
        let floor = Touch {
            depth: self.floor + radius - center_w.z,
            normal_w: Vector3::z(),
        };
        match &self.block {
            Some(block) => {
                let side = block.touch(center_w, radius);
                if side.depth > floor.depth {
                    side
                } else {
                    floor
                }
            }
            None => floor,
        }
    }
}

/// Steps of the search for the deepest point of a segment: each leaves 0.618 of the interval, 20 leave 7e-5 of it.
const SEARCH: u32 = 20;

impl<T: Scalar> Block<T> {
    /// Share of the way from one point to another at which a ball is deepest in the block. The distance to a solid without hollows is
    /// convex along a line, so the golden section finds it.
    #[must_use]
    pub fn deepest(&self, from_w: &Vector3<T>, to_w: &Vector3<T>) -> T {
        let depth = |share: T| {
            let point = from_w + (to_w - from_w) * share;
            self.touch(&point, T::ZERO).depth
        };
        let golden = T::of(0.618_033_988_749_894_9);
        let (mut low, mut high) = (T::ZERO, T::ONE);
        let mut left = high - golden * (high - low);
        let mut right = low + golden * (high - low);
        let (mut at_left, mut at_right) = (depth(left), depth(right));
        for _ in 0..SEARCH {
            if at_left > at_right {
                (high, right, at_right) = (right, left, at_left);
                left = high - golden * (high - low);
                at_left = depth(left);
            } else {
                (low, left, at_left) = (left, right, at_right);
                right = low + golden * (high - low);
                at_right = depth(right);
            }
        }
        (low + high) * T::HALF
    }

    /// Whether a ball around a point can touch it.
    pub(crate) fn is_near(&self, center_w: &Vector3<T>, radius: T) -> bool {
        let walls = self.lower.iter().zip(&self.upper);
        walls
            .zip(center_w.iter())
            .all(|((low, high), x)| *x > *low - radius && *x < *high + radius)
    }

    /// The contact of a sphere with the block: nearest point of the solid from outside, nearest face from
    /// inside.
    #[must_use]
    pub fn touch(&self, center_w: &Vector3<T>, radius: T) -> Touch<T> {
        let (lower, upper) = (Vector3::from(self.lower), Vector3::from(self.upper));
        let nearest = center_w.zip_zip_map(&lower, &upper, math::clamp);
        let away = center_w - nearest;
        let distance = math::sqrt(away.norm_squared());
        if distance > T::of(1e-9) {
            return Touch {
                depth: radius - distance,
                normal_w: away / distance,
            };
        }
        let mut best = Touch {
            depth: T::INFINITY,
            normal_w: Vector3::z(),
        };
        for (axis, ((x, l), u)) in center_w
            .iter()
            .zip(lower.iter())
            .zip(upper.iter())
            .enumerate()
        {
            for (inside, sign) in [(*u - *x, T::ONE), (*x - *l, -T::ONE)] {
                if inside + radius < best.depth {
                    let mut normal_w = Vector3::zeros();
                    if let Some(n) = normal_w.get_mut(axis) {
                        *n = sign;
                    }
                    best = Touch {
                        depth: inside + radius,
                        normal_w,
                    };
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::{Block, Terrain};
    use nalgebra::Vector3;

    const BOX: Terrain<f64> = Terrain {
        floor: 0.0,
        block: Some(Block {
            lower: [-1.0, -1.0, 0.0],
            upper: [1.0, 1.0, 0.5],
        }),
    };

    /// A rod over the block's edge is deepest at the edge, not at its ends.
    #[test]
    fn a_rod_over_an_edge_touches_between_its_ends() {
        let block = BOX.block.unwrap_or(Block {
            lower: [0.0; 3],
            upper: [0.0; 3],
        });
        let (from, to) = (Vector3::new(0.8, 0.0, 0.59), Vector3::new(1.2, 0.0, 0.39));
        let share = block.deepest(&from, &to);
        let middle = from + (to - from) * share;
        let depth = block.touch(&middle, 0.0).depth;
        assert!(depth > block.touch(&from, 0.0).depth && depth > block.touch(&to, 0.0).depth);
        assert!(
            (share - 0.5).abs() < 0.1 && (0.0..0.01).contains(&depth),
            "{share} {depth}"
        );
    }

    #[test]
    fn floor_top_side_and_edge() {
        let floor = BOX.touch(&Vector3::new(3.0, 0.0, 0.01), 0.02);
        assert!((floor.depth - 0.01).abs() < 1e-12 && floor.normal_w == Vector3::z());
        let top = BOX.touch(&Vector3::new(0.0, 0.0, 0.51), 0.02);
        assert!((top.depth - 0.01).abs() < 1e-12 && top.normal_w == Vector3::z());
        let side = BOX.touch(&Vector3::new(1.015, 0.0, 0.3), 0.02);
        assert!((side.depth - 0.005).abs() < 1e-12 && side.normal_w == Vector3::x());
        let edge = BOX.touch(&Vector3::new(1.01, 0.0, 0.51), 0.02);
        let slant = Vector3::new(1.0, 0.0, 1.0).normalize();
        assert!((edge.depth - (0.02 - 0.01 * so3::math::sqrt(2.0))).abs() < 1e-12);
        assert!((edge.normal_w - slant).norm() < 1e-9);
        let inside = BOX.touch(&Vector3::new(0.0, 0.0, 0.495), 0.02);
        assert!((inside.depth - 0.025).abs() < 1e-12 && inside.normal_w == Vector3::z());
    }
}
