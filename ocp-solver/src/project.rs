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
use crate::kernel::{
    add_outer_products, add_scaled, factor, largest, solve_lower, solve_upper, transpose,
};
use crate::linearised::Quadratic;
use crate::stage::Riccati;
use so3::Scalar;
use so3::math::{abs, max, sqrt};

/// Of `½ xᵀ Q_xx x + uᵀ Q_ux x + ½ uᵀ Q_uu u + q_xᵀ x + q_uᵀ u`, the quadratic of a stage, what is not kept with the stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfControls<T, const NX: usize, const NU: usize> {
    /// Columns per control.
    pub(crate) xu: [[T; NX]; NU],
    pub(crate) uu: [[T; NU]; NU],
    pub(crate) u: [[T; 1]; NU],
}

/// Scratch of one stage, shared by all of them: its quadratic, and what the elimination needs.
pub(crate) struct Work<T, const NX: usize, const NU: usize> {
    pub(crate) q: OfControls<T, NX, NU>,
    pub(crate) elimination: Elimination<T, NX, NU>,
    /// Diagonal of the whitened `Q_uu`: ±1.
    sign: [T; NU],
    /// Per pivot: −K, S_x, and Q_dx − Σ_d K.
    minus: [[T; NX]; NU],
    s: [[T; NX]; NU],
    shifted: [[T; NX]; NU],
    /// What is left of the free controls, in front, and which they are.
    free: Free<T, NX, NU>,
    reduced: Law<T, NX, NU>,
}

/// The control that is least for every state: row `i` of `gain`, and `feedforward`.
pub(crate) struct Law<T, const NX: usize, const NU: usize> {
    pub(crate) gain: [[T; NX]; NU],
    pub(crate) feedforward: [[T; 1]; NU],
}

struct Free<T, const NX: usize, const NU: usize> {
    count: usize,
    order: [u16; NU],
    xu: [[T; NX]; NU],
    uu: [[T; NU]; NU],
    u: [[T; 1]; NU],
}

/// Coordinates `w` of the controls in which their cost is `½ wᵀ diag(±1) w`: `u = L⁻ᵀ S⁻¹ w`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitening<T, const NU: usize> {
    /// Columns of `L` below the diagonal.
    lower: [[T; NU]; NU],
    /// Diagonal of `S⁻¹`.
    pub(crate) scale: [T; NU],
}

impl<T: Scalar, const NU: usize> Whitening<T, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            lower: [[T::ZERO; NU]; NU],
            scale: [T::ZERO; NU],
        }
    }

    /// From the leading `n` × `n` block of the symmetric `uu`, which may be indefinite or singular and is used up.
    ///
    /// A pivot that is nothing but rounding is taken as zero where nothing couples to it, and is otherwise
    /// replaced by a small one, which changes the Hessian by as little.
    #[inline(always)]
    fn set(&mut self, uu: &mut [[T; NU]; NU], sign: &mut [T; NU], n: usize) {
        let mut diagonal = [T::ZERO; NU];
        for (j, (value, column)) in diagonal.iter_mut().zip(uu.iter()).enumerate().take(n) {
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
            self.lower[j] = column;
            self.scale[j] = T::ONE / sqrt(square);
            sign[j] = pivot / square;
        }
    }

    /// Gradients in the first `n` controls, in the coordinates `w`: `S⁻¹ L⁻¹ g` of each.
    #[inline(always)]
    pub(crate) fn gradients<const M: usize>(&self, g: &mut [[T; NU]; M], n: usize) {
        let mut rows = transpose(g);
        solve_lower(&self.lower, &mut rows, n);
        for (row, scale) in rows.iter_mut().zip(&self.scale).take(n) {
            for value in row {
                *value *= *scale;
            }
        }
        *g = transpose(&rows);
    }
}

/// Riccati step over the first `n` controls: `xx` and `x` become the quadratic of the state that is left,
/// `xu`, `uu` and `u` are used up.
///
/// Returns false if there is no minimum: the block of the controls is not positive definite.
#[inline(always)]
#[must_use]
pub(crate) fn minimise<T: Scalar, const NX: usize, const NU: usize>(
    (xx, x): (&mut [[T; NX]; NX], &mut [T; NX]),
    xu: &mut [[T; NX]; NU],
    uu: &mut [[T; NU]; NU],
    u: &mut [[T; 1]; NU],
    n: usize,
    (gain, feedforward): (&mut [[T; NX]; NU], &mut [[T; 1]; NU]),
) -> bool {
    let mut inverse = [T::ZERO; NU];
    if !factor(uu, &mut inverse, n, T::ZERO) {
        return false;
    }
    solve_lower(uu, xu, n);
    solve_lower(uu, u, n);
    let rows = gain.iter_mut().zip(feedforward.iter_mut());
    for (((gain, y), inverse), (z, u)) in rows.zip(&inverse).zip(xu.iter().zip(u.iter())).take(n) {
        *gain = z.map(|value| -value * *inverse);
        y[0] = -u[0] * *inverse;
        add_scaled(x, y[0], z);
    }
    add_outer_products(xx, gain, xu, n);
    solve_upper(uu, gain, n);
    solve_upper(uu, feedforward, n);
    true
}

impl<T: Scalar, const NX: usize, const NU: usize> OfControls<T, NX, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            xu: [[T::ZERO; NX]; NU],
            uu: [[T::ZERO; NU]; NU],
            u: [[T::ZERO; 1]; NU],
        }
    }

    /// The quadratic of a stage: what is kept with it, and the rest.
    #[inline(always)]
    pub(crate) const fn with<'a>(
        &'a mut self,
        kept: &'a mut Riccati<T, NX, NU>,
    ) -> Quadratic<'a, T, NX, NU> {
        Quadratic {
            xx: &mut kept.hessian,
            xu: &mut self.xu,
            uu: &mut self.uu,
            x: &mut kept.gradient,
            u: &mut self.u,
        }
    }
}

impl<T: Scalar, const NX: usize, const NU: usize> Work<T, NX, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            q: OfControls::new(),
            elimination: Elimination::new(),
            sign: [T::ONE; NU],
            minus: [[T::ZERO; NX]; NU],
            s: [[T::ZERO; NX]; NU],
            shifted: [[T::ZERO; NX]; NU],
            free: Free {
                count: 0,
                order: [0; NU],
                xu: [[T::ZERO; NX]; NU],
                uu: [[T::ZERO; NU]; NU],
                u: [[T::ZERO; 1]; NU],
            },
            reduced: Law {
                gain: [[T::ZERO; NX]; NU],
                feedforward: [[T::ZERO; 1]; NU],
            },
        }
    }

    /// Turns to whitened coordinates of the first `n` controls.
    #[inline(always)]
    pub(crate) fn whiten(&mut self, n: usize, whitening: &mut Whitening<T, NU>) {
        whitening.set(&mut self.q.uu, &mut self.sign, n);
        solve_lower(&whitening.lower, &mut self.q.xu, n);
        solve_lower(&whitening.lower, &mut self.q.u, n);
        let rows = self.q.xu.iter_mut().zip(&mut self.q.u);
        for ((xu, u), scale) in rows.zip(&whitening.scale).take(n) {
            for value in xu.iter_mut() {
                *value *= *scale;
            }
            u[0] *= *scale;
        }
    }

    /// As [`minimise`], in whitened coordinates and under the pivot rows; the law is one for the controls
    /// themselves.
    #[inline(always)]
    #[must_use]
    pub(crate) fn minimise_under(
        &mut self,
        (xx, x): (&mut [[T; NX]; NX], &mut [T; NX]),
        whitening: &Whitening<T, NU>,
        n: usize,
        (gain, feedforward): (&mut [[T; NX]; NU], &mut [[T; 1]; NU]),
    ) -> bool {
        self.project((xx, x));
        let Self {
            free,
            reduced,
            elimination,
            ..
        } = self;
        let count = free.count;
        let law = (&mut reduced.gain, &mut reduced.feedforward);
        if !minimise((xx, x), &mut free.xu, &mut free.uu, &mut free.u, count, law) {
            return false;
        }
        let found = reduced.gain.iter().zip(&reduced.feedforward);
        for ((row, y), j) in found.zip(&free.order).take(count) {
            let j = usize::from(*j);
            if let (Some(to), Some(value)) = (gain.get_mut(j), feedforward.get_mut(j)) {
                *to = *row;
                *value = *y;
            }
        }
        for (column, i) in elimination.pivots() {
            let rows = &*elimination;
            let (Some(minus), Some(z), Some(k)) =
                (self.minus.get(i), rows.u.get(i), rows.constant.get(i))
            else {
                continue;
            };
            let (mut row, mut value) = (*minus, -*k);
            let found = reduced.gain.iter().zip(&reduced.feedforward);
            for ((gain, y), j) in found.zip(&free.order).take(count) {
                let z = entry(z, *j);
                if z != T::ZERO {
                    add_scaled(&mut row, -z, gain);
                    value -= z * y[0];
                }
            }
            if let (Some(to), Some(to_value)) = (gain.get_mut(column), feedforward.get_mut(column))
            {
                (*to, to_value[0]) = (row, value);
            }
        }
        let rows = gain.iter_mut().zip(feedforward.iter_mut());
        for ((row, value), scale) in rows.zip(&whitening.scale).take(n) {
            for entry in row.iter_mut() {
                *entry *= *scale;
            }
            value[0] *= *scale;
        }
        solve_upper(&whitening.lower, gain, n);
        solve_upper(&whitening.lower, feedforward, n);
        true
    }

    /// Puts the dependent controls in and gathers what is left of the free ones.
    #[inline(never)]
    fn project(&mut self, (xx, x): (&mut [[T; NX]; NX], &mut [T; NX])) {
        let (rows, sign) = (&self.elimination, &self.sign);
        let mut count = 0usize;
        for (column, i) in rows.pivots() {
            let (Some(q_xd), Some(q_d), Some(k)) = (
                self.q.xu.get(column),
                self.q.u.get_mut(column),
                rows.constant.get(i),
            ) else {
                continue;
            };
            add_scaled(x, -*k, q_xd);
            let sign = entry(sign, column as u16);
            q_d[0] -= sign * *k;
            if let (Some(own), Some(minus), Some(s), Some(shifted)) = (
                rows.x.get(i),
                self.minus.get_mut(i),
                self.s.get_mut(i),
                self.shifted.get_mut(i),
            ) {
                *minus = own.map(|value| -value);
                *s = *q_xd;
                *shifted = *q_xd;
                add_scaled(s, T::HALF * sign, minus);
                add_scaled(shifted, sign, minus);
                add_scaled(x, q_d[0], minus);
            }
            count = i.saturating_add(1);
        }
        add_outer_products(xx, &self.minus, &self.s, count);
        add_outer_products(xx, &self.s, &self.minus, count);
        let free = &mut self.free;
        free.count = 0;
        for f in (0..NU).filter(|f| rows.remains(*f)) {
            let Some(slot) = free.order.get_mut(free.count) else {
                break;
            };
            *slot = f as u16;
            free.count = free.count.saturating_add(1);
        }
        let targets = free.xu.iter_mut().zip(&mut free.uu).zip(&mut free.u);
        for (a, (((xu, uu), u), f)) in targets.zip(&free.order).enumerate().take(free.count) {
            let f = usize::from(*f);
            let (Some(own), Some(g), Some(own_sign)) =
                (self.q.xu.get(f), self.q.u.get(f), sign.get(f))
            else {
                continue;
            };
            *xu = *own;
            *u = *g;
            *uu = [T::ZERO; NU];
            if let Some(value) = uu.get_mut(a) {
                *value = *own_sign;
            }
            for (column, i) in rows.pivots() {
                let (Some(z), Some(shifted), Some(q_d)) =
                    (rows.u.get(i), self.shifted.get(i), self.q.u.get(column))
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
