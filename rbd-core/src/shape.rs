//! Shapes of a robot's links: balls swept along a segment.

use nalgebra::Vector3;
use so3::Scalar;

use crate::hardware::{Contact, ContactShape};
use crate::model::Link;

/// A ball swept from one point to another, fixed to a link: a capsule, or a ball where both points are one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<T> {
    /// The link it is fixed to.
    pub link: Link,
    /// One end of the ball's way in the link's frame, m.
    pub from: [T; 3],
    /// The other end, m.
    pub to: [T; 3],
    /// Radius of the ball, m.
    pub radius: T,
    /// What its forces count for: a foot, a shank, the trunk.
    pub owner: usize,
}

impl<T: Scalar> Shape<T> {
    /// A ball.
    #[must_use]
    pub const fn ball(link: Link, center: [T; 3], radius: T, owner: usize) -> Self {
        Self {
            link,
            from: center,
            to: center,
            radius,
            owner,
        }
    }

    /// A robot's contact as a ball; `None` for other shapes.
    #[must_use]
    pub fn of(contact: &Contact<T>, owner: usize) -> Option<Self> {
        match contact.shape {
            ContactShape::Sphere { radius } => Some(Self::ball(
                contact.frame.link,
                contact.frame.offset,
                radius,
                owner,
            )),
            ContactShape::Rectangle { .. } => None,
        }
    }

    /// A robot's rectangular sole as four balls inside its corners that touch the sole's plane from above, in the order
    /// (x⁻, y⁻), (x⁻, y⁺), (x⁺, y⁻), (x⁺, y⁺), which count for `owner` and the three after it; `None` for other shapes. Several points
    /// of friction resist a turn about the normal, so a sole needs no torsional friction of its own.
    #[must_use]
    pub fn corners(contact: &Contact<T>, radius: T, owner: usize) -> Option<[Self; 4]> {
        let ContactShape::Rectangle {
            x: [xl, xh],
            y: [yl, yh],
        } = contact.shape
        else {
            return None;
        };
        let (xl, xh, yl, yh) = (xl + radius, xh - radius, yl + radius, yh - radius);
        let placement = contact.frame.placement();
        let corner = |x: T, y: T, owner: usize| {
            let center = placement.point(&Vector3::new(x, y, radius)).into();
            Self::ball(contact.frame.link, center, radius, owner)
        };
        Some([
            corner(xl, yl, owner),
            corner(xl, yh, owner + 1),
            corner(xh, yl, owner + 2),
            corner(xh, yh, owner + 3),
        ])
    }

    /// Whether it is a ball.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        self.from == self.to
    }
}

impl Shape<f64> {
    /// The same shape in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Shape<f32> {
        let [a, b] = [self.from, self.to];
        Shape {
            link: self.link,
            from: [a[0] as f32, a[1] as f32, a[2] as f32],
            to: [b[0] as f32, b[1] as f32, b[2] as f32],
            radius: self.radius as f32,
            owner: self.owner,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    use super::{Contact, ContactShape, Link, Shape, Vector3};
    use crate::model::Frame;

    proptest! {
        /// The four balls of a sole touch its plane from above and two of its edges each from inside, in their order.
        #[test]
        fn balls_in_the_corners_of_a_sole_touch_its_plane_and_its_edges(
            x in -0.1..0.1_f64, y in -0.1..0.1_f64, size in [0.1..0.3_f64, 0.1..0.3_f64], radius in 1e-3..0.04_f64,
            offset in prop::array::uniform3(-1.0..1.0_f64), turn in prop::array::uniform3(-1.5..1.5_f64),
        ) {
            let rotation = Rotation3::from_scaled_axis(turn.into());
            let r = rotation.matrix();
            let (x, y) = ([x, x + size[0]], [y, y + size[1]]);
            let sole = Contact {
                name: "sole",
                frame: Frame {
                    link: Link::Joint(3),
                    offset,
                    rotation: core::array::from_fn(|i| core::array::from_fn(|j| r[(i, j)])),
                },
                shape: ContactShape::Rectangle { x, y },
            };
            let balls = Shape::corners(&sole, radius, 7);
            let balls = balls.as_ref().map_or(&[][..], |balls| balls);
            prop_assert_eq!(balls.len(), 4);
            for (i, ball) in balls.iter().enumerate() {
                prop_assert!(ball.is_ball());
                prop_assert_eq!((ball.link, ball.radius, ball.owner), (Link::Joint(3), radius, 7 + i));
                let center = rotation.inverse() * (Vector3::from(ball.from) - Vector3::from(offset));
                let (from_x, from_y) = ((center.x - x[i / 2]).abs(), (center.y - y[i % 2]).abs());
                for distance in [from_x, from_y, center.z] {
                    prop_assert!((distance - radius).abs() < 1e-14, "{i}: {distance}");
                }
                let inside = |c: f64, edges: [f64; 2]| edges[0] < c && c < edges[1];
                prop_assert!(inside(center.x, x) && inside(center.y, y));
            }
            // A foot that is a ball has no corners, and a sole is no ball.
            prop_assert_eq!(Shape::of(&sole, 0), None);
            let foot = Contact { shape: ContactShape::Sphere { radius }, ..sole };
            prop_assert_eq!(Shape::corners(&foot, radius, 0), None);
            prop_assert_eq!(Shape::of(&foot, 5), Some(Shape::ball(Link::Joint(3), offset, radius, 5)));
        }
    }
}
