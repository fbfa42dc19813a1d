//! Friction of the feet, linear in their forces: sides of a pyramid within Coulomb's cone.

use so3::Scalar;
use so3::math::{cos, sqrt};

/// Sides of a friction pyramid, and how steep they are.
///
/// Four sides, as in paper A, reach √2 times their coefficient in the corners, which a round cone of that coefficient does
/// not give. Four more cut the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<T> {
    /// Across the axes: |f_x|, |f_y| ≤ axes f_z.
    pub axes: T,
    /// Across the diagonals, if there are eight sides: |f_x| + |f_y| ≤ √2 diagonals f_z.
    pub diagonals: Option<T>,
    /// Normal force at which the sides meet, N: with more than zero f_z above is f_z less this, a margin in newtons, which
    /// is what forces differ by between the middle of an interval and its ends.
    pub apex: T,
}

impl<T: Scalar> Friction<T> {
    /// Four sides, across the axes.
    #[must_use]
    pub const fn pyramid(axes: T) -> Self {
        Self {
            axes,
            diagonals: None,
            apex: T::ZERO,
        }
    }

    /// Four sides across the axes, and four more where their corners would leave the round cone |(f_x, f_y)| ≤ cone f_z: all
    /// edges of the pyramid then lie on the cone. Axes steeper than those of the regular octagon on the cone are made those.
    #[must_use]
    pub fn within_cone(axes: T, cone: T) -> Self {
        let steepest = cone * cos(T::of(core::f64::consts::FRAC_PI_8));
        let axes = if axes <= steepest { axes } else { steepest };
        let corner = axes * T::of(core::f64::consts::SQRT_2);
        if corner <= cone {
            return Self::pyramid(axes);
        }
        let across = sqrt(cone * cone - axes * axes);
        Self {
            axes,
            diagonals: Some((axes + across) * T::of(core::f64::consts::FRAC_1_SQRT_2)),
            apex: T::ZERO,
        }
    }

    /// Number of sides.
    #[must_use]
    pub const fn sides(&self) -> usize {
        if self.diagonals.is_some() { 8 } else { 4 }
    }

    /// Rows of a foot in contact: [`Self::sides`] and the normal force.
    pub(crate) const fn rows(&self) -> usize {
        self.sides().saturating_add(1)
    }

    /// Gradients of these rows in the force: sides, which must not be negative, and last the normal force.
    pub(crate) fn gradients(&self) -> impl Iterator<Item = [T; 3]> + use<T> {
        let (o, i, mu) = (T::ZERO, T::ONE, self.axes);
        let straight = [[-i, o, mu], [i, o, mu], [o, -i, mu], [o, i, mu]];
        let s = T::of(core::f64::consts::FRAC_1_SQRT_2);
        let oblique = self
            .diagonals
            .map(|mu| [[-s, -s, mu], [s, -s, mu], [-s, s, mu], [s, s, mu]]);
        let oblique = oblique.into_iter().flatten();
        straight.into_iter().chain(oblique).chain([[o, o, i]])
    }
}

#[cfg(test)]
mod tests {
    use super::Friction;
    use so3::math::{sin_cos, sqrt};

    /// Largest |(f_x, f_y)| / f_z that the sides allow in a direction.
    fn reach(friction: &Friction<f64>, angle: f64) -> f64 {
        let (y, x) = sin_cos(angle);
        let mut least = f64::INFINITY;
        for [by_x, by_y, by_z] in friction.gradients().take(friction.sides()) {
            let toward = -(by_x * x + by_y * y);
            if toward > 1e-9 {
                least = least.min(by_z / toward);
            }
        }
        least
    }

    #[test]
    fn edges_lie_on_the_cone_and_nothing_beyond() {
        for (axes, cone) in [(0.45, 0.57), (0.45, 0.5), (0.6, 0.6), (0.9, 0.5)] {
            let friction = Friction::within_cone(axes, cone);
            assert_eq!(friction.sides(), 8);
            let mut largest = 0.0;
            for i in 0..36_000 {
                largest = f64::max(largest, reach(&friction, f64::from(i) * 1e-3));
            }
            assert!(
                largest <= cone + 1e-12 && largest > cone - 1e-4,
                "{largest} {cone}"
            );
            assert!(reach(&friction, 0.0) <= axes + 1e-12);
        }
        // What is steeper than the regular octagon becomes the regular octagon.
        let Friction {
            axes, diagonals, ..
        } = Friction::within_cone(0.9f64, 0.5);
        assert!((axes - diagonals.unwrap_or(0.0)).abs() < 1e-12);
    }

    #[test]
    fn a_pyramid_that_fits_stays_a_pyramid() {
        let friction = Friction::within_cone(0.4, 0.57);
        assert_eq!(friction, Friction::pyramid(0.4));
        assert!((reach(&friction, core::f64::consts::FRAC_PI_4) - 0.4 * sqrt(2.0)).abs() < 1e-12);
    }
}
