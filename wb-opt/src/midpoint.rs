//! The midpoint of an interval, where dynamics and contacts hold (paper A eq. (5)), and how derivatives there become
//! derivatives in state and control.
//!
//! ```text
//! qm = q + ½ dt q̇ + ¼ dt² q̈,   vm = q̇ + ½ dt q̈
//! ```
//!
//! is linear, so whatever is differentiated in (qm, vm, q̈, F) is brought to (q, q̇; q̈, F) by one fixed map.

use crate::problem::Problem;
use crate::robot::BASE;
use crate::state::{Layout, State, Units};
use crate::sweep::{Contacts, PointMotion, Sweep};
use nalgebra::Vector3;
use ocp_solver::Derivatives;
use so3::Scalar;

/// Motion at the middle of an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Midpoint<T: Scalar, const N: usize, const FEET: usize> {
    pub(crate) q: [T; N],
    pub(crate) v: [T; N],
    pub(crate) a: [T; N],
    /// Forces on the feet in contact, world axes, N.
    pub(crate) forces: [Vector3<T>; FEET],
    pub(crate) layout: Layout,
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    pub(crate) fn layout(&self, k: usize) -> Layout {
        let feet = self.contacts(k).iter().filter(|on| **on).count();
        let joints = if self.is_landing(k) {
            0
        } else {
            N.saturating_sub(BASE)
        };
        Layout { feet, joints }
    }

    /// Physical accelerations and forces of interval `k`, and the motion at its middle.
    #[inline(always)]
    pub(crate) fn midpoint<const NU: usize>(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
    ) -> Midpoint<T, N, FEET> {
        let units = Units::new();
        let layout = self.layout(k);
        let half = self.dt(k) * T::HALF;
        let mut mid = Midpoint {
            q: state.q,
            v: state.v,
            a: [T::ZERO; N],
            forces: [Vector3::zeros(); FEET],
            layout,
        };
        for (i, a) in mid.a.iter_mut().enumerate() {
            if let Some(u) = layout.acceleration(i).and_then(|u| control.get(u)) {
                *a = *u * units.acceleration;
            }
        }
        let moving = mid.q.iter_mut().zip(&mut mid.v).zip(&mid.a);
        for ((q, v), a) in moving {
            *q += half * (*v + half * *a);
            *v += half * *a;
        }
        let (_, forces) = control.split_at(BASE.min(NU));
        let (triples, _) = forces.as_chunks::<3>();
        for (force, u) in mid.forces.iter_mut().zip(triples).take(layout.feet) {
            *force = Vector3::from(*u) * units.force;
        }
        mid
    }

    /// Motions of the feet in contact during interval `k`, in order, and the forces on them.
    #[inline(always)]
    pub(crate) fn contact_motions(
        &self,
        k: usize,
        sweep: &Sweep<'_, T, N>,
        mid: &Midpoint<T, N, FEET>,
    ) -> Contacts<T, FEET> {
        let still = PointMotion {
            link: 0,
            pos: Vector3::zeros(),
            arm: Vector3::zeros(),
            velocity: Vector3::zeros(),
            lifted: Vector3::zeros(),
        };
        let mut contacts = Contacts {
            points: [still; FEET],
            forces: mid.forces,
            count: mid.layout.feet,
        };
        let on = self.contacts(k);
        let standing = self.feet.iter().zip(&on).filter(|(_, on)| **on);
        for (slot, (foot, _)) in contacts.points.iter_mut().zip(standing) {
            *slot = sweep.point(&foot.point);
            slot.arm.z = -foot.radius;
        }
        contacts
    }
}

/// A gradient in (qm, vm, q̈) and in the contact forces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gradient<T, const N: usize, const FEET: usize> {
    pub(crate) q: [T; N],
    pub(crate) v: [T; N],
    pub(crate) a: [T; N],
    pub(crate) force: [[T; 3]; FEET],
}

impl<T: Scalar, const N: usize, const FEET: usize> Gradient<T, N, FEET> {
    pub(crate) const fn zero() -> Self {
        Self {
            q: [T::ZERO; N],
            v: [T::ZERO; N],
            a: [T::ZERO; N],
            force: [[T::ZERO; 3]; FEET],
        }
    }

    /// Adds `factor` times another.
    #[inline(always)]
    pub(crate) fn add(&mut self, factor: T, o: &Self) {
        add_scaled(&mut self.q, factor, &o.q);
        add_scaled(&mut self.v, factor, &o.v);
        add_scaled(&mut self.a, factor, &o.a);
        for (mine, other) in self.force.iter_mut().zip(&o.force) {
            add_scaled(mine, factor, other);
        }
    }
}

/// Second derivatives in (qm, vm, q̈) and the contact forces, by rows; `vq` has the rows of vm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hessian<T, const N: usize, const FEET: usize> {
    pub(crate) qq: [[T; N]; N],
    pub(crate) vq: [[T; N]; N],
    pub(crate) vv: [[T; N]; N],
    pub(crate) aq: [[T; N]; N],
    pub(crate) av: [[T; N]; N],
    pub(crate) aa: [[T; N]; N],
    pub(crate) force: [[Gradient<T, N, FEET>; 3]; FEET],
}

impl<T: Scalar, const N: usize, const FEET: usize> Hessian<T, N, FEET> {
    pub(crate) const fn zero() -> Self {
        let none = [[T::ZERO; N]; N];
        Self {
            qq: none,
            vq: none,
            vv: none,
            aq: none,
            av: none,
            aa: none,
            force: [[Gradient::zero(); 3]; FEET],
        }
    }

    /// Adds `weight` g gᵀ; `support` lists the coordinates in which g is not zero, `feet` the forces.
    #[inline(always)]
    pub(crate) fn add_outer(
        &mut self,
        weight: T,
        g: &Gradient<T, N, FEET>,
        support: impl Iterator<Item = usize>,
    ) {
        for i in support {
            let (q, v, a) = (weight * g.q[i], weight * g.v[i], weight * g.a[i]);
            add_scaled(&mut self.qq[i], q, &g.q);
            add_scaled(&mut self.vq[i], v, &g.q);
            add_scaled(&mut self.vv[i], v, &g.v);
            add_scaled(&mut self.aq[i], a, &g.q);
            add_scaled(&mut self.av[i], a, &g.v);
            add_scaled(&mut self.aa[i], a, &g.a);
        }
        for (foot, rows) in g.force.iter().zip(&mut self.force) {
            if foot.iter().all(|x| *x == T::ZERO) {
                continue;
            }
            for (entry, row) in foot.iter().zip(rows) {
                let f = weight * *entry;
                add_scaled(&mut row.q, f, &g.q);
                add_scaled(&mut row.v, f, &g.v);
                add_scaled(&mut row.a, f, &g.a);
                for (out, other) in row.force.iter_mut().zip(&g.force) {
                    add_scaled(out, f, other);
                }
            }
        }
    }
}

#[inline(always)]
pub(crate) fn add_scaled<T: Scalar, const K: usize>(y: &mut [T; K], factor: T, x: &[T; K]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}

/// The map from midpoint to state and control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map<T> {
    units: Units<T>,
    /// ½ dt and ¼ dt².
    first: T,
    second: T,
    layout: Layout,
}

impl<T: Scalar> Map<T> {
    pub(crate) fn new(dt: T, layout: Layout) -> Self {
        let first = dt * T::HALF;
        Self {
            units: Units::new(),
            first,
            second: first * first,
            layout,
        }
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
        self.forces(scale, g, u);
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
        for i in 0..N {
            let row_q = Gradient::<T, N, 0> {
                q: h.qq[i],
                v: qv[i],
                a: qa[i],
                force: [],
            };
            let mut row_v = Gradient::<T, N, 0> {
                q: h.vq[i],
                v: h.vv[i],
                a: va[i],
                force: [],
            };
            let mut row_a = Gradient::<T, N, 0> {
                q: h.aq[i],
                v: h.av[i],
                a: h.aa[i],
                force: [],
            };
            row_a.add(first, &row_v);
            row_a.add(second, &row_q);
            row_v.add(first, &row_q);
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
