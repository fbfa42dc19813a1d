//! How derivatives at the midpoint of an interval become derivatives in state and control.
//!
//! The midpoint ([`crate::midpoint`]) is linear in them, so whatever is differentiated in (qm, vm, q̈, F) is brought to
//! (q, q̇; q̈, F) by one fixed map; the part of three coordinates that turn a base on SO(3) is that of [`crate::rotation`].

use crate::robot::{BASE, TURN};
use crate::rotation::{Turn, set_triple, triple};
use crate::state::{Layout, Units};
use nalgebra::Vector3;
use ocp_solver::Derivatives;
use rbd_core::second_order::{Gradient, Hessian};
use so3::Scalar;

/// The part of a gradient that turns the base: in the angles, their rates and their accelerations.
#[inline(always)]
pub(crate) fn turning<T: Scalar, const N: usize, const FEET: usize>(
    g: &Gradient<T, N, FEET>,
) -> [Vector3<T>; 3] {
    [&g.q, &g.v, &g.a].map(|row| triple(row, TURN))
}

/// y += factor x.
#[inline(always)]
pub(crate) fn add_scaled<T: Scalar, const K: usize>(y: &mut [T; K], factor: T, x: &[T; K]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}

/// The map from midpoint to state and control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map<T: Scalar> {
    units: Units<T>,
    /// ½ dt and ¼ dt².
    first: T,
    second: T,
    layout: Layout,
    /// Of a base on SO(3).
    turn: Option<Turn<T>>,
}

impl<T: Scalar> Map<T> {
    pub(crate) fn new(dt: T, layout: Layout, turn: Option<Turn<T>>) -> Self {
        let first = dt * T::HALF;
        Self {
            units: Units::new(),
            first,
            second: first * first,
            layout,
            turn,
        }
    }

    pub(crate) fn turn(&self) -> Option<&Turn<T>> {
        self.turn.as_ref()
    }

    /// Writes `scale` times a gradient as a gradient in the state and in the control.
    #[inline(always)]
    pub(crate) fn gradient<const N: usize, const FEET: usize, const NX: usize, const NU: usize>(
        &self,
        scale: T,
        g: &Gradient<T, N, FEET>,
        x: &mut [T; NX],
        u: &mut [T; NU],
    ) {
        let by_v = scale * self.units.speed;
        let by_a = scale * self.units.acceleration;
        let (of_q, of_v) = x.split_at_mut(N.min(NX));
        for (slot, q) in of_q.iter_mut().zip(&g.q) {
            *slot = scale * *q;
        }
        for (slot, (q, v)) in of_v.iter_mut().zip(g.q.iter().zip(&g.v)) {
            *slot = by_v * (self.first * *q + *v);
        }
        for i in 0..N {
            if let Some(slot) = self.layout.acceleration(i).and_then(|j| u.get_mut(j)) {
                *slot = by_a * (self.second * g.q[i] + self.first * g.v[i] + g.a[i]);
            }
        }
        self.turning(scale, g, x, u);
        self.forces(scale, g, u);
    }

    /// Writes the part of the coordinates that turn a base on SO(3).
    #[inline(always)]
    fn turning<const N: usize, const FEET: usize, const NX: usize, const NU: usize>(
        &self,
        scale: T,
        g: &Gradient<T, N, FEET>,
        x: &mut [T; NX],
        u: &mut [T; NU],
    ) {
        if let Some(turn) = &self.turn {
            let [theta, omega, alpha] = turn.gradient(&turning(g));
            set_triple(x, TURN, &(theta * scale));
            let speeds = N.saturating_add(TURN);
            set_triple(x, speeds, &(omega * (scale * self.units.speed)));
            set_triple(u, TURN, &(alpha * (scale * self.units.acceleration)));
        }
    }

    /// As [`Self::gradient`], where the gradient is zero except at the coordinates `support`; other entries are
    /// left alone.
    #[inline(always)]
    pub(crate) fn sparse<const N: usize, const FEET: usize, const NX: usize, const NU: usize>(
        &self,
        scale: T,
        g: &Gradient<T, N, FEET>,
        support: impl Iterator<Item = usize>,
        x: &mut [T; NX],
        u: &mut [T; NU],
    ) {
        let by_v = scale * self.units.speed;
        let by_a = scale * self.units.acceleration;
        for i in support {
            let (q, v, a) = (g.q[i], g.v[i], g.a[i]);
            if let Some(slot) = x.get_mut(i) {
                *slot = scale * q;
            }
            if let Some(slot) = x.get_mut(N.saturating_add(i)) {
                *slot = by_v * (self.first * q + v);
            }
            if let Some(slot) = self.layout.acceleration(i).and_then(|j| u.get_mut(j)) {
                *slot = by_a * (self.second * q + self.first * v + a);
            }
        }
        self.turning(scale, g, x, u);
        self.forces(scale, g, u);
    }

    /// Writes the part of the contact forces.
    #[inline(always)]
    fn forces<const N: usize, const FEET: usize, const NU: usize>(
        &self,
        scale: T,
        g: &Gradient<T, N, FEET>,
        u: &mut [T; NU],
    ) {
        let by_force = scale * self.units.force;
        let (_, forces) = u.split_at_mut(BASE.min(NU));
        let (triples, _) = forces.as_chunks_mut::<3>();
        for (slots, foot) in triples.iter_mut().zip(&g.force).take(self.layout.feet) {
            for (slot, value) in slots.iter_mut().zip(foot) {
                *slot = by_force * *value;
            }
        }
    }

    /// Writes a Hessian as the Hessian in the state and in the control.
    #[inline(never)]
    pub(crate) fn hessian<
        const N: usize,
        const FEET: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        h: &Hessian<T, N, FEET>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let (first, second, layout) = (self.first, self.second, self.layout);
        // Rows of qm, vm and q̈ over all three, the missing halves from symmetry.
        let (qv, qa, va) = (transposed(&h.vq), transposed(&h.aq), transposed(&h.av));
        let by_v = self.units.speed;
        let by_a = self.units.acceleration;
        // Rows of qm, vm and q̈ of coordinate i.
        let rows = |i: usize| {
            let row = |q: &[[T; N]; N], v: &[[T; N]; N], a: &[[T; N]; N]| Gradient::<T, N, 0> {
                q: q[i],
                v: v[i],
                a: a[i],
                force: [],
            };
            [
                row(&h.qq, &qv, &qa),
                row(&h.vq, &h.vv, &va),
                row(&h.aq, &h.av, &h.aa),
            ]
        };
        for i in 0..N {
            let [row_q, row_v, row_a] = match &self.turn {
                Some(turn) if (TURN..BASE).contains(&i) => {
                    let mut node = [Gradient::ZERO; 3];
                    for k in TURN..BASE {
                        for (r, row) in rows(k).iter().enumerate() {
                            for (c, sum) in node.iter_mut().enumerate() {
                                sum.add(turn.entry((r, k - TURN), (c, i - TURN)), row);
                            }
                        }
                    }
                    node
                }
                _ => {
                    let [row_q, mut row_v, mut row_a] = rows(i);
                    row_a.add(first, &row_v);
                    row_a.add(second, &row_q);
                    row_v.add(first, &row_q);
                    [row_q, row_v, row_a]
                }
            };
            let mut unused = [T::ZERO; NU];
            if let Some(x) = d.hessian_xx.get_mut(i) {
                self.gradient(T::ONE, &row_q, x, &mut unused);
            }
            if let Some(x) = d.hessian_xx.get_mut(N.saturating_add(i)) {
                self.gradient(by_v, &row_v, x, &mut unused);
            }
            if let Some(j) = layout.acceleration(i)
                && let (Some(x), Some(u)) = (d.hessian_xu.get_mut(j), d.hessian_uu.get_mut(j))
            {
                self.gradient(by_a, &row_a, x, u);
            }
        }
        self.force_hessian(h, d);
    }

    /// Writes the columns of the contact forces of a Hessian.
    #[inline(always)]
    fn force_hessian<
        const N: usize,
        const FEET: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        h: &Hessian<T, N, FEET>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let layout = self.layout;
        for (f, rows) in h.force.iter().enumerate().take(layout.feet) {
            for (c, row) in rows.iter().enumerate() {
                let j = Layout::force(f).saturating_add(c);
                let (Some(x), Some(u)) = (d.hessian_xu.get_mut(j), d.hessian_uu.get_mut(j)) else {
                    continue;
                };
                self.gradient(self.units.force, row, x, u);
                let of_force = *u;
                for i in 0..N {
                    if let Some(a) = layout.acceleration(i)
                        && let (Some(column), Some(value)) =
                            (d.hessian_uu.get_mut(a), of_force.get(a))
                        && let Some(slot) = column.get_mut(j)
                    {
                        *slot = *value;
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn transposed<T: Scalar, const N: usize>(m: &[[T; N]; N]) -> [[T; N]; N] {
    let mut out = [[T::ZERO; N]; N];
    for (j, row) in m.iter().enumerate() {
        for (column, value) in out.iter_mut().zip(row) {
            if let Some(slot) = column.get_mut(j) {
                *slot = *value;
            }
        }
    }
    out
}
