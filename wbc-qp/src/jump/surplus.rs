//! What moves a robot beside its program.

use so3::Scalar;

/// Observes R rates ẋ for what accelerates them beyond what a program has reached, d.
///
/// A robot that is heavier than its model, whose centre of mass is elsewhere or whose motors give less than they are asked for does not
/// accelerate as its program says, and laws without an integral end elsewhere: 1 cm times the weight is a moment m under which Ḣ = −K H
/// turns the robot for ever, with H = m/K. With x̂ the rate as it should be, a what the program has reached, and L a gain,
///
/// ```text
/// dx̂/dt = a + d + 2 L (ẋ − x̂),  dd/dt = L² (ẋ − x̂)
/// ```
///
/// which finds a constant d with both poles at −L. What motors or contacts did not allow is no surplus, since it is not in a.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surplus<T, const R: usize> {
    /// x̂.
    rates: [T; R],
    /// a.
    reached: [T; R],
    /// d.
    found: [T; R],
    /// Whether a program has had an answer.
    begun: bool,
}

impl<T: Scalar, const R: usize> Surplus<T, R> {
    /// Of a program without an answer yet.
    pub(super) const NONE: Self = Self {
        rates: [T::ZERO; R],
        reached: [T::ZERO; R],
        found: [T::ZERO; R],
        begun: false,
    };

    /// d, when the rates are these a time `dt` after the last tick; zero before the first answer. Where a number is not finite, all is
    /// forgotten.
    pub(super) fn observe(&mut self, rates: &[T; R], gain: T, dt: T) -> [T; R] {
        if !self.begun {
            self.rates = *rates;
            return self.found;
        }
        let states = self.rates.iter_mut().zip(&mut self.found);
        let told = rates.iter().zip(&self.reached);
        for ((expected, found), (rate, reached)) in states.zip(told) {
            *expected += (*reached + *found) * dt;
            let error = *rate - *expected;
            *expected += T::TWO * gain * dt * error;
            *found += gain * gain * dt * error;
        }
        let mut numbers = self.rates.iter().chain(&self.found);
        if !numbers.all(|x| x.is_finite_number()) {
            *self = Self::NONE;
        }
        self.found
    }

    /// The program has reached these accelerations.
    pub(super) const fn reached(&mut self, reached: &[T; R]) {
        (self.reached, self.begun) = (*reached, true);
    }
}

#[cfg(test)]
mod tests {
    use super::Surplus;

    /// A constant surplus is found as by two poles at −L, whatever the program asks for: d (1 − (1 + L t) e^(−L t)).
    #[test]
    fn a_constant_surplus_is_found_with_two_poles_at_the_gain() {
        let (gain, dt, truth) = (20.0, 1e-5, [0.7, -2.0]);
        let mut surplus = Surplus::<f64, 2>::NONE;
        let mut rates = [0.3, -0.1];
        assert_eq!(surplus.observe(&rates, gain, dt), [0.0; 2]);
        for k in 0..20_000 {
            let t = dt * f64::from(k);
            let asked = [so3::math::sin(30.0 * t), 3.0];
            surplus.reached(&asked);
            for (rate, (asked, more)) in rates.iter_mut().zip(asked.iter().zip(truth)) {
                *rate += (asked + more) * dt;
            }
            let found = surplus.observe(&rates, gain, dt);
            let after = gain * (t + dt);
            let share = 1.0 - (1.0 + after) * so3::math::exp(-after);
            for (found, truth) in found.iter().zip(truth) {
                assert!((found - truth * share).abs() < 1e-3, "{found} at {t}");
            }
        }
    }

    /// With a gain of zero nothing is found.
    #[test]
    fn nothing_is_found_without_a_gain() {
        let mut surplus = Surplus::<f64, 1>::NONE;
        for rate in [0.0, 3.0, -1.0] {
            assert_eq!(surplus.observe(&[rate], 0.0, 1e-3), [0.0]);
            surplus.reached(&[1.0]);
        }
    }

    /// A number that is not finite is forgotten, with all that was found.
    #[test]
    fn what_is_not_finite_is_forgotten() {
        for (rate, reached) in [(f64::NAN, 0.0), (0.0, f64::INFINITY)] {
            let mut surplus = Surplus::<f64, 1>::NONE;
            for (rate, found) in [(0.0, false), (1.0, true)] {
                let [more] = surplus.observe(&[rate], 10.0, 1e-3);
                assert_eq!(more != 0.0, found);
                surplus.reached(&[0.0]);
            }
            surplus.reached(&[reached]);
            assert_eq!(surplus.observe(&[rate], 10.0, 1e-3), [0.0]);
            // It begins anew.
            assert_eq!(surplus.observe(&[2.0], 10.0, 1e-3), [0.0]);
            surplus.reached(&[1.0]);
            let [more] = surplus.observe(&[2.0 + 1e-3], 10.0, 1e-3);
            assert!(more.abs() < 1e-12, "{more}");
        }
    }
}
