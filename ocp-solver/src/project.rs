//! The quadratic of one stage, least over its controls, with and without equalities.
//!
//! Without equalities this is the Riccati step `L D Lᵀ = Q_uu`. With them the controls are first
//! *whitened*, `u = L⁻ᵀ S⁻¹ w` with `S = √|D|`, so that their block becomes `Σ = diag(±1)`. Then the
//! dependent controls `w_d = −(K x + Z w_f + k)` of [`crate::eliminate`] are put in: with
//! `q_d ← q_d − Σ_d k`,
//!
//! ```text
//! S_x = Q_dx − ½ Σ_d K,   Q_xx −= Kᵀ S_x + S_xᵀ K,   q_x −= Kᵀ q_d + Q_xd k
//! Q_fx −= Zᵀ (Q_dx − Σ_d K),   Q_ff = Σ_f + Zᵀ Σ_d Z,   q_f −= Zᵀ q_d
//! ```
//!
//! and the rest is a Riccati step in `w_f`. Whitening is what makes this safe in an interior point: a control at its
//! bound, or a direction of the next state that only such a control can correct, has a weight of
//! 1e10 and more, and eliminating in the plain controls would subtract such numbers from each other.

use crate::eliminate::{Elimination, entry};
use crate::kernel::{add_outer_products, add_scaled, factor, largest, solve_lower, solve_upper};
use so3::Scalar;
use so3::math::{abs, max, sqrt};

/// `½ xᵀ Q_xx x + uᵀ Q_ux x + ½ uᵀ Q_uu u + q_xᵀ x + q_uᵀ u`, columns per control in `xu`.
#[derive(Clone, Copy)]
pub(crate) struct Quadratic<T, const NX: usize, const NU: usize> {
    pub(crate) xx: [[T; NX]; NX],
    pub(crate) x: [T; NX],
    pub(crate) xu: [[T; NX]; NU],
    pub(crate) uu: [[T; NU]; NU],
    pub(crate) u: [[T; 1]; NU],
}

/// The control that is least for every state: row `i` of `gain`, and `feedforward`.
pub(crate) struct Law<T, const NX: usize, const NU: usize> {
    pub(crate) gain: [[T; NX]; NU],
    pub(crate) feedforward: [[T; 1]; NU],
}

/// Coordinates `w` of the controls in which their cost is `½ wᵀ diag(sign) w`: `u = L⁻ᵀ S⁻¹ w`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitening<T, const NU: usize> {
    /// Columns of `L` below the diagonal.
    lower: [[T; NU]; NU],
    /// Diagonal of `S⁻¹`.
    pub(crate) scale: [T; NU],
    sign: [T; NU],
}

impl<T: Scalar, const NU: usize> Whitening<T, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            lower: [[T::ZERO; NU]; NU],
            scale: [T::ONE; NU],
            sign: [T::ONE; NU],
        }
    }

    /// From the leading `n` × `n` block of the symmetric `uu`, which may be indefinite or singular.
    ///
    /// A pivot that is nothing but rounding is taken as zero where nothing couples to it, and is otherwise
    /// replaced by a small one, which changes the Hessian by as little.
    #[inline(always)]
    fn of(mut uu: [[T; NU]; NU], n: usize) -> Self {
        let mut out = Self::new();
        let mut diagonal = [T::ZERO; NU];
        for (j, (value, column)) in diagonal.iter_mut().zip(&uu).enumerate().take(n) {
            *value = abs(column[j]);
        }
        let noise = T::of(32.0) * T::EPSILON;
        let lowest = noise * largest(&diagonal);
        for j in 0..NU {
            if j >= n {
                break;
            }
            let mut column = uu[j];
            let mut pivot = column[j];
            if abs(pivot) <= noise * diagonal[j] {
                let mut coupling = T::ZERO;
                for value in column.iter().take(n).skip(j + 1) {
                    coupling = max(coupling, abs(*value));
                }
                pivot = if coupling > lowest {
                    sqrt(T::EPSILON) * coupling
                } else {
                    T::ZERO
                };
            }
            let inverse = if pivot == T::ZERO {
                T::ZERO
            } else {
                T::ONE / pivot
            };
            for k in (j + 1)..NU {
                if k >= n {
                    break;
                }
                let weight = column[k] * inverse;
                if weight != T::ZERO {
                    add_scaled(&mut uu[k], -weight, &column);
                }
            }
            for value in &mut column {
                *value *= inverse;
            }
            // The scale of a control without curvature of its own stays within reason of the others'.
            let square = max(abs(pivot), max(noise * diagonal[j], T::EPSILON));
            out.lower[j] = column;
            out.scale[j] = T::ONE / sqrt(square);
            out.sign[j] = pivot / square;
        }
        out
    }

    /// A gradient in the first `n` controls, in the coordinates `w`: `S⁻¹ L⁻¹ g`.
    #[inline(always)]
    pub(crate) fn gradient(&self, g: &mut [T; NU], n: usize) {
        for j in 0..NU {
            if j >= n {
                break;
            }
            let value = g[j];
            for (g, l) in g.iter_mut().zip(&self.lower[j]).take(n).skip(j + 1) {
                *g -= value * *l;
            }
            g[j] = value * self.scale[j];
        }
    }
}

impl<T: Scalar, const NX: usize, const NU: usize> Quadratic<T, NX, NU> {
    /// Least over the first `n` controls: `xx` and `x` become the quadratic of the state that is left.
    ///
    /// `None` if there is no minimum: the block of the controls is not positive definite.
    #[inline(always)]
    pub(crate) fn minimise(&mut self, n: usize) -> Option<Law<T, NX, NU>> {
        let mut inverse = [T::ZERO; NU];
        if !factor(&mut self.uu, &mut inverse, n, T::ZERO) {
            return None;
        }
        solve_lower(&self.uu, &mut self.xu, n);
        solve_lower(&self.uu, &mut self.u, n);
        let mut law = Law {
            gain: self.xu,
            feedforward: self.u,
        };
        let rows = law.gain.iter_mut().zip(&mut law.feedforward);
        for (((gain, y), inverse), z) in rows.zip(&inverse).zip(&self.xu).take(n) {
            for value in gain.iter_mut() {
                *value *= -*inverse;
            }
            y[0] *= -*inverse;
            add_scaled(&mut self.x, y[0], z);
        }
        add_outer_products(&mut self.xx, &law.gain, &self.xu, n);
        solve_upper(&self.uu, &mut law.gain, n);
        solve_upper(&self.uu, &mut law.feedforward, n);
        Some(law)
    }

    /// Turns to whitened coordinates of the first `n` controls; `uu` is not meaningful afterwards.
    #[inline(always)]
    pub(crate) fn whiten(&mut self, n: usize) -> Whitening<T, NU> {
        let whitening = Whitening::of(self.uu, n);
        solve_lower(&whitening.lower, &mut self.xu, n);
        solve_lower(&whitening.lower, &mut self.u, n);
        let rows = self.xu.iter_mut().zip(&mut self.u);
        for ((xu, u), scale) in rows.zip(&whitening.scale).take(n) {
            for value in xu.iter_mut() {
                *value *= *scale;
            }
            u[0] *= *scale;
        }
        whitening
    }

    /// As [`Self::minimise`], in whitened coordinates and under the pivot rows; the law is one for the
    /// controls themselves.
    #[inline(always)]
    pub(crate) fn minimise_under(
        &mut self,
        rows: &Elimination<T, NX, NU>,
        whitening: &Whitening<T, NU>,
        n: usize,
    ) -> Option<Law<T, NX, NU>> {
        let mut free = Free::new();
        self.project(rows, &whitening.sign, &mut free);
        let inner = Quadratic {
            xx: self.xx,
            x: self.x,
            xu: free.xu,
            uu: free.uu,
            u: free.u,
        };
        let (mut inner, count) = (inner, free.count);
        let reduced = inner.minimise(count)?;
        (self.xx, self.x) = (inner.xx, inner.x);

        let mut law = Law {
            gain: [[T::ZERO; NX]; NU],
            feedforward: [[T::ZERO; 1]; NU],
        };
        let found = reduced.gain.iter().zip(&reduced.feedforward);
        for ((gain, y), j) in found.zip(&free.order).take(count) {
            let j = usize::from(*j);
            if let (Some(row), Some(value)) = (law.gain.get_mut(j), law.feedforward.get_mut(j)) {
                (*row, *value) = (*gain, *y);
            }
        }
        for (column, i) in rows.pivots() {
            let (Some(x), Some(z), Some(k)) = (rows.x.get(i), rows.u.get(i), rows.constant.get(i))
            else {
                continue;
            };
            let (mut row, mut value) = (x.map(|value| -value), -*k);
            let found = reduced.gain.iter().zip(&reduced.feedforward);
            for ((gain, y), j) in found.zip(&free.order).take(count) {
                let z = entry(z, *j);
                if z != T::ZERO {
                    add_scaled(&mut row, -z, gain);
                    value -= z * y[0];
                }
            }
            if let (Some(to), Some(to_value)) =
                (law.gain.get_mut(column), law.feedforward.get_mut(column))
            {
                (*to, to_value[0]) = (row, value);
            }
        }
        let rows = law.gain.iter_mut().zip(&mut law.feedforward);
        for ((row, value), scale) in rows.zip(&whitening.scale).take(n) {
            for entry in row.iter_mut() {
                *entry *= *scale;
            }
            value[0] *= *scale;
        }
        solve_upper(&whitening.lower, &mut law.gain, n);
        solve_upper(&whitening.lower, &mut law.feedforward, n);
        Some(law)
    }

    /// Puts the dependent controls in and gathers what is left of the free ones.
    #[inline(never)]
    fn project(
        &mut self,
        rows: &Elimination<T, NX, NU>,
        sign: &[T; NU],
        free: &mut Free<T, NX, NU>,
    ) {
        // Per pivot: −K, S_x, and Q_dx − Σ_d K.
        let (mut minus, mut s) = ([[T::ZERO; NX]; NU], [[T::ZERO; NX]; NU]);
        let mut shifted = [[T::ZERO; NX]; NU];
        let mut count = 0usize;
        for (column, i) in rows.pivots() {
            let (Some(q_xd), Some(q_d), Some(k)) = (
                self.xu.get(column),
                self.u.get_mut(column),
                rows.constant.get(i),
            ) else {
                continue;
            };
            add_scaled(&mut self.x, -*k, q_xd);
            let sign = entry(sign, column as u16);
            q_d[0] -= sign * *k;
            if let (Some(x), Some(minus), Some(s), Some(shifted)) = (
                rows.x.get(i),
                minus.get_mut(i),
                s.get_mut(i),
                shifted.get_mut(i),
            ) {
                *minus = x.map(|value| -value);
                (*s, *shifted) = (*q_xd, *q_xd);
                add_scaled(s, T::HALF * sign, minus);
                add_scaled(shifted, sign, minus);
                add_scaled(&mut self.x, q_d[0], minus);
            }
            count = i.saturating_add(1);
        }
        add_outer_products(&mut self.xx, &minus, &s, count);
        add_outer_products(&mut self.xx, &s, &minus, count);
        for f in (0..NU).filter(|f| rows.remains(*f)) {
            let Some(slot) = free.order.get_mut(free.count) else {
                break;
            };
            *slot = f as u16;
            free.count = free.count.saturating_add(1);
        }
        let targets = free.xu.iter_mut().zip(&mut free.uu).zip(&mut free.u);
        for (a, ((((xu, uu), u), f), _)) in targets.zip(&free.order).zip(0..free.count).enumerate()
        {
            let f = usize::from(*f);
            let (Some(own), Some(g), Some(own_sign)) = (self.xu.get(f), self.u.get(f), sign.get(f))
            else {
                continue;
            };
            (*xu, *u) = (*own, *g);
            if let Some(value) = uu.get_mut(a) {
                *value = *own_sign;
            }
            for (column, i) in rows.pivots() {
                let (Some(z), Some(shifted), Some(q_d)) =
                    (rows.u.get(i), shifted.get(i), self.u.get(column))
                else {
                    continue;
                };
                let weight = entry(z, f as u16);
                if weight == T::ZERO {
                    continue;
                }
                add_scaled(xu, -weight, shifted);
                u[0] -= weight * q_d[0];
                let weight = weight * entry(sign, column as u16);
                for (value, other) in uu.iter_mut().zip(&free.order).take(free.count) {
                    *value += weight * entry(z, *other);
                }
            }
        }
    }
}

/// The free controls of a projected quadratic, in front.
struct Free<T, const NX: usize, const NU: usize> {
    count: usize,
    order: [u16; NU],
    xu: [[T; NX]; NU],
    uu: [[T; NU]; NU],
    u: [[T; 1]; NU],
}

impl<T: Scalar, const NX: usize, const NU: usize> Free<T, NX, NU> {
    const fn new() -> Self {
        Self {
            count: 0,
            order: [0; NU],
            xu: [[T::ZERO; NX]; NU],
            uu: [[T::ZERO; NU]; NU],
            u: [[T::ZERO; 1]; NU],
        }
    }
}
