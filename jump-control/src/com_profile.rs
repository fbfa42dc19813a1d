//! The height of the centre of mass during the push-off, paper B, III-A.
//!
//! A normalised curve takes the speed from 0 to 1 m/s in 1 s; a jump stretches it to the take-off speed v and the duration T:
//! ż(t) = v v̂(t/T). The paper shows its curve but gives no formula. Ours is the two-term family
//!
//! v̂(x) = (1 + β) xⁿ − β xⁿ⁺ᵐ,
//!
//! with v̂(0) = 0, v̂(1) = 1, final slope n − m β and area (1 + β)/(n + 1) − β/(n + m + 1). T follows in one of the paper's
//! two ways: from the displacement, T = d / (v · area), or from a final acceleration of −g, T = −v · slope / g, which makes the
//! acceleration continuous at take-off and asks for a curve that slows down at its end.

use so3::{Scalar, math};

/// A normalised speed curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<T> {
    /// n ≥ 2, so that the push-off starts without a jump in force.
    pub exponent: u32,
    /// m ≥ 1.
    pub extra: u32,
    /// β.
    pub beta: T,
}

impl<T: Scalar> Curve<T> {
    /// 6 x⁵ − 5 x⁶: speed grows to the end, acceleration fades to zero. Area 2/7: 11 cm at 0.89 m/s take 0.43 s, the
    /// paper's take-off time.
    #[must_use]
    pub fn rising() -> Self {
        Self {
            exponent: 5,
            extra: 1,
            beta: T::of(5.0),
        }
    }

    /// Slows down before its end so that, at 0.89 m/s in 0.43 s, the final acceleration is −g: both ways of the
    /// paper agree at its own figures. Its largest speed is a tenth above the take-off speed, which costs joint speed.
    #[must_use]
    pub fn ballistic() -> Self {
        Self {
            exponent: 5,
            extra: 7,
            beta: T::of(1.391),
        }
    }

    /// v̂(x).
    #[must_use]
    pub fn speed(&self, x: T) -> T {
        let low = math::powi(x, self.exponent);
        low * (T::ONE + self.beta - self.beta * math::powi(x, self.extra))
    }

    /// dv̂/dx.
    #[must_use]
    pub fn slope(&self, x: T) -> T {
        let (n, all) = (self.exponent, self.exponent + self.extra);
        let first = (T::ONE + self.beta) * T::of(f64::from(n)) * math::powi(x, n - 1);
        first - self.beta * T::of(f64::from(all)) * math::powi(x, all - 1)
    }

    /// ∫₀ˣ v̂.
    #[must_use]
    pub fn area(&self, x: T) -> T {
        let (n, all) = (self.exponent + 1, self.exponent + self.extra + 1);
        (T::ONE + self.beta) * math::powi(x, n) / T::of(f64::from(n))
            - self.beta * math::powi(x, all) / T::of(f64::from(all))
    }
}

/// Where the centre of mass shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComPoint<T> {
    /// Height over the start, m.
    pub rise: T,
    /// Vertical speed, m/s.
    pub speed: T,
    /// Vertical acceleration, m/s².
    pub acceleration: T,
}

/// A curve stretched to a jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComProfile<T> {
    curve: Curve<T>,
    /// Take-off speed v, m/s.
    pub speed: T,
    /// Duration T of the push-off, s.
    pub duration: T,
    gravity: T,
}

/// Speed at take-off that carries the centre of mass `height` higher, √(2 g h): paper B, II-D.
#[must_use]
pub fn takeoff_speed<T: Scalar>(height: T, gravity: T) -> T {
    math::sqrt(T::TWO * gravity * height)
}

impl<T: Scalar> ComProfile<T> {
    /// The duration follows from the displacement of the push-off, m: what the paper chose. `None` unless speed, displacement
    /// and area are positive.
    #[must_use]
    pub fn by_displacement(curve: Curve<T>, speed: T, displacement: T, gravity: T) -> Option<Self> {
        Self::new(
            curve,
            speed,
            displacement / (speed * curve.area(T::ONE)),
            gravity,
        )
    }

    /// The duration follows from a final acceleration of −g. `None` unless speed is positive and the curve slows down at its
    /// end.
    #[must_use]
    pub fn by_final_acceleration(curve: Curve<T>, speed: T, gravity: T) -> Option<Self> {
        Self::new(
            curve,
            speed,
            -speed * curve.slope(T::ONE) / gravity,
            gravity,
        )
    }

    fn new(curve: Curve<T>, speed: T, duration: T, gravity: T) -> Option<Self> {
        let usable = |x: T| x > T::ZERO && x.is_finite_number();
        (usable(speed) && usable(duration)).then_some(Self {
            curve,
            speed,
            duration,
            gravity,
        })
    }

    /// The reference at a time since the start of the push-off: at rest before it, in free flight after its end.
    #[must_use]
    pub fn at(&self, time: T) -> ComPoint<T> {
        let x = math::clamp(time / self.duration, T::ZERO, T::ONE);
        let rise = self.speed * self.duration * self.curve.area(x);
        let late = time - self.duration;
        if late > T::ZERO {
            let fallen = self.gravity * late;
            return ComPoint {
                rise: rise + (self.speed - fallen * T::HALF) * late,
                speed: self.speed - fallen,
                acceleration: -self.gravity,
            };
        }
        ComPoint {
            rise,
            speed: self.speed * self.curve.speed(x),
            acceleration: self.speed / self.duration * self.curve.slope(x),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{ComProfile, Curve, takeoff_speed};

    const G: f64 = 9.81;

    #[test]
    fn the_figures_of_the_paper() {
        let v: f64 = takeoff_speed(0.04, G);
        assert!((v - 0.89).abs() < 0.005);
        let p = ComProfile::by_displacement(Curve::rising(), v, 0.11, G).unwrap();
        assert!((p.duration - 0.43).abs() < 0.005, "{}", p.duration);
        let q = ComProfile::by_final_acceleration(Curve::ballistic(), v, G).unwrap();
        assert!((q.duration - 0.43).abs() < 0.005, "{}", q.duration);
        assert!((q.at(q.duration).rise - 0.11).abs() < 0.003);
        assert!((q.at(q.duration).acceleration + G).abs() < 1e-9);
        assert_eq!(
            ComProfile::by_final_acceleration(Curve::rising(), v, G),
            None
        );
        assert_eq!(
            ComProfile::by_displacement(Curve::rising(), v, f64::NAN, G),
            None
        );
    }

    #[test]
    fn rise_speed_and_acceleration_are_derivatives_of_each_other() {
        for curve in [Curve::rising(), Curve::ballistic()] {
            let p = ComProfile::by_displacement(curve, 0.9, 0.1, G).unwrap();
            assert!((p.at(p.duration).rise - 0.1).abs() < 1e-12);
            assert!((p.at(p.duration).speed - 0.9).abs() < 1e-12);
            for i in 1..80 {
                let (t, h) = (p.duration * f64::from(i) / 60.0 + 1e-4, 1e-5);
                let (a, b, c) = (p.at(t - h), p.at(t), p.at(t + h));
                assert!(((c.rise - a.rise) / (2.0 * h) - b.speed).abs() < 1e-6);
                assert!(((c.speed - a.speed) / (2.0 * h) - b.acceleration).abs() < 1e-4);
            }
            assert_eq!(p.at(-1.0).speed, 0.0);
        }
    }
}
