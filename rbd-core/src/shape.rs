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
