//! The rows that bind the force on one foot.
//!
//! At most three independent rows n_k f = d_k hold. Their normals are kept orthogonalised, n_k = q_k + Σ_{j<k} r_jk q_j, so that the force
//! that meets them is f = Σ c_k q_k + P x for any x, P = I − Σ q_k q_kᵀ/|q_k|², and nothing is inverted but |q_k|².

use nalgebra::Vector3;
use so3::Scalar;

use crate::wrench::{Arm, Square};

/// Most rows that can hold independently.
pub(crate) const MOST: usize = 3;

/// One row that holds.
#[derive(Clone, Copy, Debug)]
struct Active<T: Scalar> {
    /// Its number, as [`crate::limits::Limits`] counts.
    row: usize,
    q: Vector3<T>,
    /// 1/|q|².
    inverse: T,
    /// r_jk of the rows before.
    shares: [T; MOST],
    /// q_kᵀf where the row holds: c_k |q_k|².
    height: T,
    /// Multiplier, ≥ 0.
    multiplier: T,
}

impl<T: Scalar> Active<T> {
    const NONE: Self = Self {
        row: 0,
        q: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        inverse: T::ZERO,
        shares: [T::ZERO; MOST],
        height: T::ZERO,
        multiplier: T::ZERO,
    };
}

/// The rows that hold on one foot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face<T: Scalar> {
    active: [Active<T>; MOST],
    len: usize,
}

/// A row in the coordinates of a face: n = `rest` + Σ `shares` q.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Split<T: Scalar> {
    pub(crate) shares: [T; MOST],
    pub(crate) rest: Vector3<T>,
}

impl<T: Scalar> Split<T> {
    /// Whether there is more left of the row `normal` than round-off.
    pub(crate) fn is_independent(&self, normal: &Vector3<T>) -> bool {
        self.rest.norm_squared() > normal.norm_squared() * T::EPSILON
    }
}

impl<T: Scalar> Face<T> {
    pub(crate) const FREE: Self = Self {
        active: [Active::NONE; MOST],
        len: 0,
    };

    #[inline(always)]
    fn rows(&self) -> impl Iterator<Item = &Active<T>> {
        self.active.get(..self.len).unwrap_or(&[]).iter()
    }

    /// Whether no further row can hold independently.
    pub(crate) const fn is_full(&self) -> bool {
        self.len == MOST
    }

    pub(crate) const fn len(&self) -> usize {
        self.len
    }

    /// Position and value of the least multiplier.
    pub(crate) fn least(&self) -> Option<(usize, T)> {
        let mut least: Option<(usize, T)> = None;
        for (k, active) in self.rows().enumerate() {
            if least.is_none_or(|(_, value)| active.multiplier < value) {
                least = Some((k, active.multiplier));
            }
        }
        least
    }

    /// Takes the last row back; returns its multiplier.
    pub(crate) fn pop(&mut self) -> T {
        let last = self.rows().last().map(|active| active.multiplier);
        self.len = self.len.saturating_sub(1);
        last.unwrap_or_default()
    }

    /// A row in these coordinates.
    #[inline]
    pub(crate) fn split(&self, normal: &Vector3<T>) -> Split<T> {
        let (mut shares, mut rest) = ([T::ZERO; MOST], *normal);
        for (share, active) in shares.iter_mut().zip(self.rows()) {
            *share = active.q.dot(&rest) * active.inverse;
            rest -= active.q * *share;
        }
        Split { shares, rest }
    }

    /// Appends a row of right-hand side `d` that is independent of the others.
    pub(crate) fn push(&mut self, row: usize, d: T, split: &Split<T>, multiplier: T) {
        let inverse = T::ONE / split.rest.norm_squared();
        let mut known = T::ZERO;
        for (share, active) in split.shares.iter().zip(self.rows()) {
            known += *share * active.height;
        }
        if let Some(slot) = self.active.get_mut(self.len) {
            *slot = Active {
                row,
                q: split.rest,
                inverse,
                shares: split.shares,
                height: d - known,
                multiplier,
            };
            self.len += 1;
        }
    }

    /// Numbers and multipliers of the rows but the one at `k`.
    pub(crate) fn without(&self, k: usize) -> impl Iterator<Item = (usize, T)> {
        let rest = self.rows().enumerate().filter(move |(i, _)| *i != k);
        rest.map(|(_, active)| (active.row, active.multiplier))
    }

    /// Σ c_k q_k: the smallest force that meets the rows.
    #[inline]
    pub(crate) fn point(&self) -> Vector3<T> {
        let mut point = Vector3::zeros();
        for active in self.rows() {
            point += active.q * (active.height * active.inverse);
        }
        point
    }

    /// P x.
    #[inline]
    pub(crate) fn free(&self, x: &Vector3<T>) -> Vector3<T> {
        let [a, b, _] = &self.active;
        match self.len {
            0 => *x,
            1 => {
                // Twice, because x may be much larger than what remains of it.
                let across = |x: &Vector3<T>| a.q * (a.q.dot(x) * a.inverse);
                let once = x - across(x);
                once - across(&once)
            }
            2 => {
                let along = a.q.cross(&b.q);
                along * (along.dot(x) * a.inverse * b.inverse)
            }
            _ => Vector3::zeros(),
        }
    }

    /// Adds B P Bᵀ.
    #[inline]
    pub(crate) fn add_to(&self, arm: &Arm<T>, k: &mut Square<T>) {
        let [a, b, _] = &self.active;
        match self.len {
            0 => k.add_arm(arm),
            1 => {
                k.add_arm(arm);
                k.add_square(-a.inverse, &arm.wrench(&a.q));
            }
            2 => k.add_square(a.inverse * b.inverse, &arm.wrench(&a.q.cross(&b.q))),
            _ => {}
        }
    }

    /// λ with Σ λ_k n_k = the part of `x` across the face.
    #[inline]
    pub(crate) fn combination(&self, x: &Vector3<T>) -> [T; MOST] {
        let mut e = [T::ZERO; MOST];
        for (e, active) in e.iter_mut().zip(self.rows()) {
            *e = active.q.dot(x) * active.inverse;
        }
        let [_, b, c] = &self.active;
        if self.len > 2 {
            e[1] -= c.shares[1] * e[2];
            e[0] -= c.shares[0] * e[2];
        }
        if self.len > 1 {
            e[0] -= b.shares[0] * e[1];
        }
        e
    }

    /// Sets the multipliers of a stationary force: Σ λ_k n_k = pull − f.
    pub(crate) fn balance(&mut self, pull: &Vector3<T>, force: &Vector3<T>) {
        let values = self.combination(&(pull - force));
        for (active, value) in self.active.iter_mut().zip(values) {
            active.multiplier = value;
        }
    }

    /// The step at which the first of the first `among` multipliers reaches zero, and which.
    pub(crate) fn blocking(&self, rates: &[T; MOST], among: usize) -> Option<(usize, T)> {
        let mut first: Option<(usize, T)> = None;
        for (k, (active, rate)) in self.rows().zip(rates).enumerate().take(among) {
            if *rate < T::ZERO {
                let step = so3::math::max(active.multiplier, T::ZERO) / -*rate;
                if first.is_none_or(|(_, least)| step < least) {
                    first = Some((k, step));
                }
            }
        }
        first
    }

    /// λ ← λ + t · rates.
    pub(crate) fn advance(&mut self, t: T, rates: &[T; MOST]) {
        for (active, rate) in self.active.iter_mut().zip(rates).take(self.len) {
            active.multiplier += t * *rate;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Face, MOST};
    use nalgebra::Vector3;
    use proptest::array::uniform3;
    use proptest::prelude::{Just, prop_assert, prop_oneof, proptest};

    proptest! {
        /// As far as the blocking step all multipliers stay above zero and the one that blocks reaches it; where none falls, none blocks, however
        /// far the step is.
        #[test]
        fn the_first_multiplier_that_falls_to_zero_blocks(
            multipliers in uniform3(prop_oneof![1 => Just(0.0), 3 => 0.0..10.0_f64]),
            rates in uniform3(prop_oneof![1 => Just(0.0), 3 => -1.0..1.0_f64]), len in 0..=MOST, among in 0..=MOST,
        ) {
            let mut face = Face::FREE;
            for (k, multiplier) in multipliers.iter().take(len).enumerate() {
                let split = face.split(&Vector3::ith(k, 1.0));
                face.push(k, 0.0, &split, *multiplier);
            }
            let count = len.min(among);
            let falls = rates.iter().take(count).any(|rate| *rate < 0.0);
            let Some((k, step)) = face.blocking(&rates, among) else {
                prop_assert!(!falls);
                return Ok(());
            };
            prop_assert!(falls && k < count && step >= 0.0, "{k} {step}");
            face.advance(step, &rates);
            for (i, after) in face.without(usize::MAX).take(count) {
                prop_assert!(after >= -1e-12 * step, "{i} {after}");
                if i == k {
                    prop_assert!(after <= 1e-12 * step, "{after}");
                }
            }
        }
    }
}
