//! How the length of an interval moves its middle: derivatives in the duration T of a phase, dt = T / intervals.
//!
//! With half the length h = ½ dt, the middle of [`crate::midpoint`] moves by
//!
//! ```text
//! ∂qm/∂dt = ½ (vm + ½ dt q̈),   ∂vm/∂dt = ½ q̈
//! ```
//!
//! and a base on SO(3) as [`Turn::by_half`] says. Products of dt with rates and accelerations bend the Lagrangian besides.

use crate::map::{Map, add_scaled};
use crate::midpoint::Midpoint;
use crate::robot::{BASE, TURN};
use crate::rotation::{Step, Turn, set_triple};
use crate::state::{Layout, Units};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::Derivatives;
use rbd_core::second_order::{Gradient, Hessian};
use so3::Scalar;

/// An interval that the duration of its phase stretches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch<T, const N: usize> {
    /// Coordinate of the duration among those of the state.
    pub(crate) column: usize,
    /// ∂dt/∂T.
    pub(crate) rate: T,
    dt: T,
    /// ∂(qm, vm, q̈)/∂T.
    by: Gradient<T, N, 0>,
    /// ∂(q, q̇)/∂T at the end of the interval; on SO(3) the turn's part is left to [`Turn`].
    end_v: [T; N],
    end_a: [T; N],
    layout: Layout,
    turns: bool,
}

impl<T: Scalar, const N: usize> Stretch<T, N> {
    /// The interval of length `dt` that changes by `rate` per duration.
    pub(crate) fn new<const FEET: usize>(
        column: usize,
        rate: T,
        dt: T,
        mid: &Midpoint<T, N, FEET>,
        turn: Option<&Turn<T>>,
    ) -> Self {
        let mut by = Gradient::ZERO;
        let (mut end_v, mut end_a) = ([T::ZERO; N], mid.a);
        for (i, end_v) in end_v.iter_mut().enumerate() {
            *end_v = mid.v[i] + dt * T::HALF * mid.a[i];
            by.q[i] = rate * T::HALF * *end_v;
            by.v[i] = rate * T::HALF * mid.a[i];
        }
        if let Some(turn) = turn {
            let [q, v, a] = turn.by_half();
            let half = rate * T::HALF;
            set_triple(&mut by.q, TURN, &(q * half));
            set_triple(&mut by.v, TURN, &(v * half));
            set_triple(&mut by.a, TURN, &(a * half));
            set_triple(&mut end_a, TURN, turn.alpha());
        }
        Self {
            column,
            rate,
            dt,
            by,
            end_v,
            end_a,
            layout: mid.layout,
            turns: turn.is_some(),
        }
    }

    /// Derivative in T of a function with this gradient at the middle.
    #[inline(always)]
    pub(crate) fn along<const FEET: usize>(&self, g: &Gradient<T, N, FEET>) -> T {
        let dot =
            |x: &[T; N], y: &[T; N]| x.iter().zip(y).fold(T::ZERO, |sum, (x, y)| sum + *x * *y);
        dot(&self.by.q, &g.q) + dot(&self.by.v, &g.v) + dot(&self.by.a, &g.a)
    }

    /// Coordinates that do not turn a base on SO(3).
    fn straight(&self) -> impl Iterator<Item = usize> + use<T, N> {
        let turns = self.turns;
        (0..N).filter(move |i| !(turns && (TURN..BASE).contains(i)))
    }

    /// Writes the second derivatives in T and everything else: `h` and `g` are the Lagrangian's at the middle, the gap left
    /// aside, `explicit` its derivatives in q̈ and dt where rows have dt themselves.
    pub(crate) fn bend<const FEET: usize, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        (h, g): (&Hessian<T, N, FEET>, &Gradient<T, N, FEET>),
        explicit: &[T; N],
        map: &Map<T>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let units = Units::<T>::new();
        let mut row = Gradient::<T, N, FEET>::ZERO;
        for i in 0..N {
            let (q, v, a) = (self.by.q[i], self.by.v[i], self.by.a[i]);
            add_scaled(&mut row.q, q, &h.qq[i]);
            add_scaled(&mut row.q, v, &h.vq[i]);
            add_scaled(&mut row.q, a, &h.aq[i]);
            add_scaled(&mut row.v, v, &h.vv[i]);
            add_scaled(&mut row.v, a, &h.av[i]);
            add_scaled(&mut row.a, a, &h.aa[i]);
            for j in 0..N {
                row.v[j] += q * h.vq[j][i];
                row.a[j] += q * h.aq[j][i] + v * h.av[j][i];
            }
        }
        for (slots, rows) in row.force.iter_mut().zip(&h.force) {
            for (slot, of_force) in slots.iter_mut().zip(rows) {
                *slot = self.along(of_force);
            }
        }
        let mut itself = self.along(&row);
        let (mut x, mut u) = ([T::ZERO; NX], [T::ZERO; NU]);
        map.gradient(T::ONE, &row, &mut x, &mut u);
        let half = self.rate * T::HALF;
        for i in self.straight() {
            itself += half * self.rate * self.end_a[i] * g.q[i];
            if let Some(slot) = x.get_mut(N.saturating_add(i)) {
                *slot += half * units.speed * g.q[i];
            }
            let on_a = half * (self.dt * g.q[i] + g.v[i]);
            self.push(&mut u, i, on_a + explicit[i]);
        }
        self.clear(d);
        self.add(&x, &u, itself, d);
    }

    /// Writes the gap's derivative in T and adds its second derivatives, with the multiplier of the gap. On SO(3): `turn`, the
    /// whole interval's step, the next rotation seen from where that leads, the multiplier there, and the Lagrangian's
    /// gradient in (a, ȧ, ä).
    pub(crate) fn gap<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        multiplier: &[T; NX],
        turning: Option<Turning<'_, T>>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let units = Units::<T>::new();
        let (mut x, mut u, mut itself) = ([T::ZERO; NX], [T::ZERO; NU], T::ZERO);
        let mut first = [T::ZERO; NX];
        let (of_q, of_v) = multiplier.split_at(N.min(NX));
        let rates = of_v.iter().zip(&self.end_a).enumerate().take(N);
        for (i, (y, a)) in rates {
            self.push(&mut u, i, *y / units.speed * self.rate);
            if let Some(slot) = first.get_mut(N.saturating_add(i)) {
                *slot = self.rate * *a / units.speed;
            }
        }
        for i in self.straight() {
            let y = of_q.get(i).copied().unwrap_or(T::ZERO);
            if let Some(slot) = first.get_mut(i) {
                *slot = self.rate * self.end_v[i];
            }
            if let Some(slot) = x.get_mut(N.saturating_add(i)) {
                *slot = y * units.speed * self.rate;
            }
            self.push(&mut u, i, y * self.dt * self.rate);
            itself += y * self.end_a[i] * self.rate * self.rate;
        }
        if let Some(Turning {
            turn,
            step,
            next_from_end,
            reach,
            gradient,
        }) = turning
        {
            let moved = next_from_end * (step.jacobian * (turn.end_omega() * self.rate));
            set_triple(&mut first, TURN, &moved);
            let half = self.rate * T::HALF;
            let ([theta, omega, alpha], twice) = turn.half_curvature(gradient, (step, reach));
            let speeds = N.saturating_add(TURN);
            add_triple(&mut x, TURN, &(theta * half));
            add_triple(&mut x, speeds, &(omega * (half * units.speed)));
            for (i, value) in (TURN..BASE).zip(&alpha) {
                self.push(&mut u, i, half * *value);
            }
            itself += half * half * twice;
        }
        if let Some(column) = d.dynamics_x.get_mut(self.column) {
            *column = first;
            // The duration itself stays.
            if let Some(slot) = column.get_mut(self.column) {
                *slot = T::ONE;
            }
        }
        self.add(&x, &u, itself, d);
    }

    /// Adds to the entry of a coordinate's acceleration.
    #[inline(always)]
    fn push<const NU: usize>(&self, u: &mut [T; NU], i: usize, value: T) {
        let slot = self.layout.acceleration(i).and_then(|j| u.get_mut(j));
        if let Some(slot) = slot {
            *slot += value * Units::<T>::new().acceleration;
        }
    }

    /// Clears the row and column of T in the Hessian.
    fn clear<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        if let Some(column) = d.hessian_xx.get_mut(self.column) {
            *column = [T::ZERO; NX];
        }
        for column in d.hessian_xx.iter_mut().chain(&mut d.hessian_xu) {
            if let Some(slot) = column.get_mut(self.column) {
                *slot = T::ZERO;
            }
        }
    }

    /// Adds to the row and column of T in the Hessian.
    fn add<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        x: &[T; NX],
        u: &[T; NU],
        itself: T,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        if let Some(column) = d.hessian_xx.get_mut(self.column) {
            add_scaled(column, T::ONE, x);
        }
        let columns = d
            .hessian_xx
            .iter_mut()
            .zip(x)
            .chain(d.hessian_xu.iter_mut().zip(u));
        for (column, value) in columns {
            if let Some(slot) = column.get_mut(self.column) {
                *slot += *value;
            }
        }
        let slot = d.hessian_xx.get_mut(self.column);
        if let Some(slot) = slot.and_then(|column| column.get_mut(self.column)) {
            *slot += itself;
        }
    }
}

/// How a base on SO(3) turns over the interval.
pub(crate) struct Turning<'a, T: Scalar> {
    pub(crate) turn: &'a Turn<T>,
    /// The whole interval's.
    pub(crate) step: &'a Step<T>,
    /// Where the interval leads, seen from the next node.
    pub(crate) next_from_end: &'a Matrix3<T>,
    /// The multiplier of the rotation's gap, in base axes at the end.
    pub(crate) reach: &'a Vector3<T>,
    /// Gradient of the Lagrangian in (a, ȧ, ä).
    pub(crate) gradient: &'a [Vector3<T>; 3],
}

/// Adds to three coordinates from `at` on.
fn add_triple<T: Scalar>(x: &mut [T], at: usize, v: &Vector3<T>) {
    for (slot, value) in x.iter_mut().skip(at).zip(v) {
        *slot += *value;
    }
}
