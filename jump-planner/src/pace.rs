//! Whether a solver that still violates its rows will meet them in time.

use so3::math::log;

/// Iterations over which the pace is taken, and before which twice nothing is said.
const WINDOW: usize = 20;
/// Violation, in the solver's units, from which on the last few iterations need no forecast.
const NEAR: f64 = 0.05;

/// The violations of an attempt so far.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    violations: Vec<f64>,
    /// Whether the rows were met once, which answers the question: a smaller µ drives the iterates away from them for a while, but not
    /// from the motion that was found.
    arrived: bool,
}

impl Pace {
    /// Counts an iterate; whether its violation, which falls about geometrically, has been near zero or will be within `patience`
    /// iterations in all.
    pub(crate) fn keeps_up(&mut self, violation: f64, patience: usize) -> bool {
        self.violations.push(violation);
        self.arrived |= violation <= NEAR;
        let done = self.violations.len();
        let Some(before) = done.checked_sub(WINDOW + 1) else {
            return true;
        };
        let (then, now) = (self.violations[before], violation);
        if done <= 2 * WINDOW || self.arrived {
            return true;
        }
        let per_iteration = log(then / now) / WINDOW as f64;
        // Not <=: no pace at all is NaN or never.
        let left = log(now / NEAR) / per_iteration;
        per_iteration > 0.0 && done as f64 + left <= patience as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use so3::math::exp;

    /// How many iterates pass before the pace is too slow, of those given.
    fn lasts(violations: impl Iterator<Item = f64>) -> usize {
        let mut pace = Pace::default();
        violations.take_while(|v| pace.keeps_up(*v, 150)).count()
    }

    #[test]
    fn slow_attempts_end_early_and_others_do_not() {
        let falling = |per: f64| (0..150).map(move |k| 10.0 * exp(-per * f64::from(k)));
        assert_eq!(lasts(falling(0.04)), 150);
        assert_eq!(lasts(falling(0.02)), 40);
        assert_eq!(lasts(core::iter::repeat_n(1.0, 150)), 40);
        // Hard for long, then fast.
        assert_eq!(
            lasts((0..150).map(|k| if k < 100 { 0.04 } else { 1e-9 })),
            150
        );
        // There once, and driven away by a smaller µ.
        assert_eq!(
            lasts((0..150).map(|k| if k == 31 { 1e-3 } else { 5.0 })),
            150
        );
        assert_eq!(lasts(core::iter::repeat_n(f64::NAN, 150)), 40);
    }
}
