//! The Kalman filter over the IMU's point and the feet.
//!
//! State: position p and velocity v of the IMU's point, and positions s₁ … s_F of the feet, all in world axes. The process
//! is ṗ = v, v̇ = a with white noise, ṡ = what rolling says with white noise; every measurement is a state or a
//! difference of two states. Noise is the same along all axes, so the three axes share one covariance of
//! `S` = F + 2 rows, and a measurement of a vector is one scalar update of that covariance.

use nalgebra::Vector3;
use so3::{Scalar, math};

/// Rows of the position and of the velocity; feet follow.
pub(crate) const POSITION: usize = 0;
pub(crate) const VELOCITY: usize = 1;
pub(crate) const FEET: usize = 2;

/// Mean and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Filter<T: Scalar, const S: usize> {
    pub(crate) mean: [Vector3<T>; S],
    covariance: [[T; S]; S],
}

impl<T: Scalar, const S: usize> Filter<T, S> {
    /// Everything known to within `deviation`.
    pub(crate) fn new(mean: [Vector3<T>; S], deviation: T) -> Self {
        let mut covariance = [[T::ZERO; S]; S];
        for (i, row) in covariance.iter_mut().enumerate() {
            if let Some(x) = row.get_mut(i) {
                *x = deviation * deviation;
            }
        }
        Self { mean, covariance }
    }

    pub(crate) fn get(&self, row: usize) -> Vector3<T> {
        self.mean.get(row).copied().unwrap_or_else(Vector3::zeros)
    }

    /// Variance of a state along one axis.
    pub(crate) fn variance(&self, row: usize) -> T {
        self.covariance
            .get(row)
            .and_then(|r| r.get(row))
            .copied()
            .unwrap_or(T::ZERO)
    }

    /// Ballistics over `dt` with acceleration `a`; `accelerometer` is its standard deviation.
    pub(crate) fn predict(&mut self, a: &Vector3<T>, accelerometer: T, dt: T) {
        let v = self.get(VELOCITY);
        if let Some(p) = self.mean.get_mut(POSITION) {
            *p += (v + a * (T::HALF * dt)) * dt;
        }
        if let Some(v) = self.mean.get_mut(VELOCITY) {
            *v += a * dt;
        }
        // F P Fᵀ with F = 1 + dt e_p e_vᵀ: first the row, then the column.
        let moved = self
            .covariance
            .get(VELOCITY)
            .copied()
            .unwrap_or([T::ZERO; S]);
        if let Some(row) = self.covariance.get_mut(POSITION) {
            for (x, y) in row.iter_mut().zip(moved) {
                *x += y * dt;
            }
        }
        for row in &mut self.covariance {
            let y = row.get(VELOCITY).copied().unwrap_or(T::ZERO);
            if let Some(x) = row.get_mut(POSITION) {
                *x += y * dt;
            }
        }
        // The error of a is held over the step.
        let step = accelerometer * dt;
        self.add(VELOCITY, VELOCITY, step * step);
    }

    /// Moves a state by `shift`, with random-walk variance.
    pub(crate) fn walk(&mut self, row: usize, shift: &Vector3<T>, variance: T) {
        if let Some(x) = self.mean.get_mut(row) {
            *x += shift;
        }
        self.add(row, row, variance);
    }

    /// Makes state `row` anew: position plus `offset`, known to within `variance`.
    pub(crate) fn anchor(&mut self, row: usize, offset: &Vector3<T>, variance: T) {
        let at = self.get(POSITION) + offset;
        if let Some(x) = self.mean.get_mut(row) {
            *x = at;
        }
        let mut copied = self
            .covariance
            .get(POSITION)
            .copied()
            .unwrap_or([T::ZERO; S]);
        if let Some(x) = copied.get_mut(row) {
            *x = self
                .covariance
                .get(POSITION)
                .and_then(|r| r.get(POSITION))
                .copied()
                .unwrap_or(T::ZERO)
                + variance;
        }
        for (other, x) in self.covariance.iter_mut().zip(copied) {
            if let Some(slot) = other.get_mut(row) {
                *slot = x;
            }
        }
        if let Some(slot) = self.covariance.get_mut(row) {
            *slot = copied;
        }
    }

    /// Takes the measurement `value` of mean[plus] − mean[minus], or of mean[plus] alone.
    pub(crate) fn measure(
        &mut self,
        plus: usize,
        minus: Option<usize>,
        value: &Vector3<T>,
        variance: T,
    ) {
        let pick = |row: &[T; S]| {
            let at = |i: usize| row.get(i).copied().unwrap_or(T::ZERO);
            at(plus) - minus.map_or(T::ZERO, at)
        };
        let ph = self.covariance.each_ref().map(pick);
        let s = pick(&ph) + variance;
        if s <= T::ZERO || s.is_nan_number() {
            return;
        }
        let innovation =
            value - self.get(plus) + minus.map_or_else(Vector3::zeros, |i| self.get(i));
        for (x, k) in self.mean.iter_mut().zip(&ph) {
            *x += innovation * (*k / s);
        }
        for (row, k) in self.covariance.iter_mut().zip(&ph) {
            for (x, l) in row.iter_mut().zip(&ph) {
                *x -= *k * *l / s;
            }
        }
        for i in 0..S {
            // Round-off must not make a variance negative.
            if let Some(x) = self.covariance.get_mut(i).and_then(|row| row.get_mut(i)) {
                *x = math::max(*x, T::EPSILON);
            }
        }
    }

    fn add(&mut self, row: usize, column: usize, variance: T) {
        if let Some(x) = self.covariance.get_mut(row).and_then(|r| r.get_mut(column)) {
            *x += variance;
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        let mut numbers = self.mean.iter().flat_map(|x| x.iter());
        numbers.all(|x| x.is_finite_number())
            && self
                .covariance
                .iter()
                .flatten()
                .all(|x| x.is_finite_number())
    }
}

#[cfg(test)]
mod tests {
    use super::{FEET, Filter, POSITION, VELOCITY};
    use nalgebra::{Matrix3, RowVector3, Vector3};
    use proptest::prelude::*;

    /// The textbook filter with matrices, one axis, one foot.
    #[test]
    fn scalar_updates_are_the_textbook_kalman_filter() {
        let mut ours = Filter::<f64, 3>::new([Vector3::zeros(); 3], 0.5);
        let (mut x, mut p) = (Vector3::zeros(), Matrix3::identity() * 0.25);
        let (dt, a, deviation) = (0.01, 2.0, 0.7);
        let f = Matrix3::new(1.0, dt, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        for i in 0..50 {
            ours.predict(&Vector3::new(a, 0.0, 0.0), deviation, dt);
            ours.walk(FEET, &Vector3::zeros(), 1e-4);
            x = f * x + Vector3::new(0.5 * a * dt * dt, a * dt, 0.0);
            let step: f64 = deviation * dt;
            p = f * p * f.transpose()
                + Matrix3::from_diagonal(&Vector3::new(0.0, step * step, 1e-4));
            let (h, value, variance, plus, minus) = if i % 2 == 0 {
                (RowVector3::new(0.0, 1.0, 0.0), 0.3, 0.01, VELOCITY, None)
            } else {
                let h = RowVector3::new(-1.0, 0.0, 1.0);
                (h, 0.1, 0.02, FEET, Some(POSITION))
            };
            ours.measure(plus, minus, &Vector3::new(value, 0.0, 0.0), variance);
            let s = (h * p * h.transpose())[0] + variance;
            let k = p * h.transpose() / s;
            x += k * (value - (h * x)[0]);
            p -= k * h * p;
            for row in 0..3 {
                assert!((ours.mean[row].x - x[row]).abs() < 1e-12);
                for column in 0..3 {
                    let error = ours.covariance[row][column] - p[(row, column)];
                    assert!(error.abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_new_anchor_is_as_uncertain_as_the_position_and_moves_with_it() {
        let mut filter = Filter::<f64, 4>::new([Vector3::zeros(); 4], 0.5);
        filter.anchor(FEET, &Vector3::new(0.0, 0.0, -0.3), 1e-4);
        assert_eq!(filter.get(FEET).z, -0.3);
        // Learning the position shifts the anchor by as much.
        filter.measure(POSITION, None, &Vector3::new(1.0, 0.0, 0.0), 1e-6);
        assert!((filter.get(FEET).x - filter.get(POSITION).x).abs() < 1e-12);
        assert!(filter.get(POSITION).x > 0.99);
    }

    /// What may be measured: a state alone, or two apart.
    fn measurement() -> impl Strategy<Value = (usize, Option<usize>, [f64; 3], f64)> {
        let pairs = prop_oneof![
            Just((POSITION, None)),
            Just((VELOCITY, None)),
            Just((FEET, Some(POSITION))),
            Just((FEET + 1, Some(POSITION))),
        ];
        (pairs, prop::array::uniform3(-1.0..1.0_f64), 1e-4..1.0_f64)
            .prop_map(|((plus, minus), value, variance)| (plus, minus, value, variance))
    }

    /// Some time into a flight over two feet.
    fn filter() -> impl Strategy<Value = Filter<f64, 4>> {
        let number = -2.0..2.0_f64;
        let means = prop::array::uniform4(prop::array::uniform3(number.clone()));
        let a = prop::array::uniform3(number);
        (means, 0.05..2.0_f64, a, 1..20_u32).prop_map(|(means, deviation, a, steps)| {
            let mut filter = Filter::new(means.map(Vector3::from), deviation);
            for _ in 0..steps {
                filter.predict(&Vector3::from(a), 0.7, 0.01);
                filter.walk(FEET, &Vector3::zeros(), 1e-4);
            }
            filter
        })
    }

    proptest! {
        /// The order in which an instant's measurements come does not matter.
        #[test]
        fn measurements_commute(start in filter(), a in measurement(), b in measurement()) {
            let mut ends = [start, start];
            for (filter, order) in ends.iter_mut().zip([[a, b], [b, a]]) {
                for (plus, minus, value, variance) in order {
                    filter.measure(plus, minus, &Vector3::from(value), variance);
                }
            }
            for row in 0..4 {
                prop_assert!((ends[0].mean[row] - ends[1].mean[row]).amax() < 1e-9);
                for column in 0..4 {
                    let [p, q] = ends.map(|filter| filter.covariance[row][column]);
                    prop_assert!((p - q).abs() < 1e-9, "{} {}", p, q);
                }
            }
        }

        /// A measurement never makes anything less certain, and leaves the covariance symmetric with products inside Schwarz's bound.
        #[test]
        fn measurements_never_harm(start in filter(), (plus, minus, value, variance) in measurement()) {
            let mut after = start;
            after.measure(plus, minus, &Vector3::from(value), variance);
            let (p, q) = (start.covariance, after.covariance);
            for i in 0..4 {
                prop_assert!(q[i][i] <= p[i][i] * (1.0 + 1e-12) && q[i][i] > 0.0);
                for j in 0..4 {
                    prop_assert!((q[i][j] - q[j][i]).abs() < 1e-12);
                    prop_assert!(q[i][j] * q[i][j] <= q[i][i] * q[j][j] * (1.0 + 1e-9));
                }
            }
        }

        /// In a world turned about any axis the same happens, turned.
        #[test]
        fn axes_do_not_matter(
            start in filter(), (plus, minus, value, variance) in measurement(), turn in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let turn = so3::exp(&Vector3::from(turn));
            let (mut here, mut there) = (start, start);
            there.mean = there.mean.map(|x| turn * x);
            here.measure(plus, minus, &Vector3::from(value), variance);
            there.measure(plus, minus, &(turn * Vector3::from(value)), variance);
            for (a, b) in here.mean.iter().zip(&there.mean) {
                prop_assert!((turn * a - b).amax() < 1e-12);
            }
            prop_assert_eq!(here.covariance, there.covariance);
        }
    }
}
