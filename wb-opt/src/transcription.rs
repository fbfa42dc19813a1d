//! The whole-body problem as an optimal-control problem for `ocp-solver`, with the cost of paper A eq. (6).

use crate::differentiate::Interval;
use crate::drive::Line;
use crate::midpoint::{Gradient, Map, Midpoint};
use crate::problem::Problem;
use crate::robot::{BASE, Point};
use crate::state::{State, Units};
use crate::sweep::{Contacts, Sweep};
use nalgebra::Vector3;
use ocp_solver::{Derivatives, Dims, Evaluated, Problem as Ocp, Values};
use so3::Scalar;

/// Sides of the friction pyramid and the normal force, over the force of a foot in its own unit.
fn pyramid<T: Scalar>(friction: T) -> [[T; 3]; 5] {
    let (o, i, mu) = (T::ZERO, T::ONE, friction);
    [[-i, o, mu], [i, o, mu], [o, -i, mu], [o, i, mu], [o, o, i]]
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Points whose height over the ground is a row of interval `k`, in the order of the rows.
    pub(crate) fn points_over_ground(&self, k: usize) -> impl Iterator<Item = &Point<T>> {
        let swing = self.feet.iter().zip(self.contacts(k));
        let swing = swing.filter(|(_, on)| !*on).map(|(foot, _)| &foot.point);
        self.clearances.iter().map(|c| &c.point).chain(swing)
    }

    /// Cost of interval `k` with given efforts.
    fn interval_cost(&self, k: usize, mid: &Midpoint<T, N, FEET>, effort: &[T; N]) -> T {
        let reference = self.reference.get(k).unwrap_or(&mid.q);
        let square = |sum: T, x: T| sum + x * x;
        let distance = mid.q.iter().zip(reference).map(|(q, r)| *q - *r);
        let efforts = effort.iter().skip(BASE).copied();
        self.weights.position * distance.fold(T::ZERO, square)
            + self.weights.effort * efforts.fold(T::ZERO, square)
    }

    /// Values of the mixed rows of interval `k`.
    fn mixed_rows(
        &self,
        k: usize,
        mid: &Midpoint<T, N, FEET>,
        sweep: &Sweep<'_, T, N>,
        contacts: &Contacts<T, FEET>,
        effort: &[T; N],
        mut push: impl FnMut(T),
    ) {
        let units = Units::new();
        for (i, value) in effort.iter().enumerate().take(BASE) {
            push(*value / units.effort(i));
        }
        for (point, _) in contacts.active() {
            for value in &sweep.slip_rate(point) {
                push(*value / units.foot_acceleration);
            }
        }
        for value in effort.iter().skip(BASE) {
            push(*value / units.moment);
        }
        if self.groups(k).lines > 0 {
            for offset in self.ends(k) {
                let speeds = mid.v.iter().zip(&mid.a).map(|(v, a)| *v + offset * *a);
                let drives = effort.iter().zip(speeds).zip(&self.robot.motors);
                for ((effort, v), motor) in drives.skip(BASE) {
                    push((*effort + Line::of(motor.as_ref()).slope * v) / units.moment);
                }
            }
        }
        for (point, _) in contacts.active() {
            for value in &point.pos {
                push(*value / units.position);
            }
        }
        for point in self.points_over_ground(k) {
            push(self.over_ground(&sweep.place(point)).height / units.position);
        }
        if mid.layout.joints > 0 {
            for q in mid.q.iter().skip(BASE) {
                push(*q);
            }
            for v in mid.v.iter().skip(BASE) {
                push(*v / units.speed);
            }
        }
    }
}

impl<T, const N: usize, const FEET: usize, const NX: usize, const NU: usize, const NI: usize>
    Ocp<T, NX, NU, NI> for Problem<'_, T, N, FEET>
where
    T: Scalar,
{
    type State = State<T, N>;

    fn intervals(&self) -> usize {
        Problem::intervals(self)
    }

    fn dims(&self, k: usize) -> Dims {
        self.row_dims(k)
    }

    fn bounds(&self, k: usize, lower: &mut [T; NI], upper: &mut [T; NI]) {
        self.row_bounds(k, lower, upper);
    }

    fn is_free_at_start(&self, _: usize) -> bool {
        false
    }

    #[inline(always)]
    fn retract(
        &self,
        _: usize,
        state: &State<T, N>,
        step: &[T; NX],
        _: Option<(&State<T, N>, &[T; NU])>,
    ) -> State<T, N> {
        let speed = Units::<T>::new().speed;
        let mut out = *state;
        let mut steps = step.iter();
        for (q, step) in out.q.iter_mut().zip(steps.by_ref()) {
            *q += *step;
        }
        for (v, step) in out.v.iter_mut().zip(steps) {
            *v += speed * *step;
        }
        out
    }

    fn evaluate(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
        next: Option<&State<T, N>>,
        values: &mut Values<T, NX, NI>,
    ) {
        let mut rows = values.rows.iter_mut();
        let mut push = |value: T| {
            if let Some(row) = rows.next() {
                *row = value;
            }
        };
        let units = Units::new();
        let Some(next) = next else {
            let ends = state.q.iter().zip(&self.goal);
            values.cost = self.weights.goal
                * ends.fold(T::ZERO, |sum, (q, goal)| sum + (*q - *goal) * (*q - *goal));
            state.q.iter().take(BASE).for_each(|q| push(*q));
            return;
        };
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let sweep = Sweep::new(&self.robot.bodies, &mid.q, &mid.v, &mid.a);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut effort = [T::ZERO; N];
        sweep.effort(&mid.a, &contacts, &mut effort);
        self.add_friction(&mid.v, &mut effort);
        values.cost = self.interval_cost(k, &mid, &effort);

        let dt = self.dt(k);
        let of_q = state.q.iter().zip(&mid.v).zip(&next.q);
        let of_q = of_q.map(|((q, v), to)| *q + dt * *v - *to);
        let of_v = state.v.iter().zip(&mid.a).zip(&next.v);
        let of_v = of_v.map(|((v, a), to)| (*v + dt * *a - *to) / units.speed);
        for (gap, value) in values.gap.iter_mut().zip(of_q.chain(of_v)) {
            *gap = value;
        }

        if self.groups(k).landing > 0 {
            state.q.iter().skip(BASE).for_each(|q| push(*q));
            let speeds = state.v.iter().skip(BASE);
            speeds.for_each(|v| push(*v / units.speed));
        }
        for force in mid.forces.iter().take(contacts.count) {
            for side in pyramid(self.friction) {
                push(Vector3::from(side).dot(force) / units.force);
            }
        }
        self.mixed_rows(k, &mid, &sweep, &contacts, &effort, push);
    }

    fn differentiate(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
        next: Option<&State<T, N>>,
        at: Evaluated<'_, T, NX, NI>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        if next.is_none() {
            self.differentiate_end(state, d);
            return;
        }
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let map = Map::new(self.dt(k), mid.layout);
        self.differentiate_linear(k, &mid, d);
        let sweep = Sweep::new(&self.robot.bodies, &mid.q, &mid.v, &mid.a);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut interval = Interval {
            problem: self,
            k,
            mid: &mid,
            sweep: &sweep,
            contacts: &contacts,
            map,
            row: self.groups(k).first_mixed(),
        };
        interval.differentiate(at.row_multipliers, d);
    }
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// The last node: distance to the goal.
    fn differentiate_end<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        state: &State<T, N>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let two = T::TWO * self.weights.goal;
        let ends = state.q.iter().zip(&self.goal);
        let slots = d.cost_x.iter_mut().zip(&mut d.hessian_xx);
        for (i, ((g, h), (q, goal))) in slots.zip(ends).enumerate() {
            *g = two * (*q - *goal);
            if let Some(diagonal) = h.get_mut(i) {
                *diagonal = two;
            }
        }
        for (i, row) in d.rows_x.iter_mut().enumerate().take(BASE) {
            if let Some(slot) = row.get_mut(i) {
                *slot = T::ONE;
            }
        }
    }

    /// What does not depend on the point: dynamics, landing rows, friction rows, joint positions and speeds.
    fn differentiate_linear<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        k: usize,
        mid: &Midpoint<T, N, FEET>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let units = Units::new();
        let dt = self.dt(k);
        let set = |column: Option<&mut [T; NX]>, row: usize, value: T| {
            if let Some(slot) = column.and_then(|column| column.get_mut(row)) {
                *slot = value;
            }
        };
        for i in 0..N {
            let speed = N.saturating_add(i);
            set(d.dynamics_x.get_mut(i), i, T::ONE);
            set(d.dynamics_x.get_mut(speed), i, dt * units.speed);
            set(d.dynamics_x.get_mut(speed), speed, T::ONE);
            if let Some(u) = mid.layout.acceleration(i) {
                let by_a = units.acceleration * dt;
                set(d.dynamics_u.get_mut(u), i, by_a * dt * T::HALF);
                set(d.dynamics_u.get_mut(u), speed, by_a / units.speed);
            }
        }
        let groups = self.groups(k);
        if groups.landing > 0 {
            for i in 0..groups.joints {
                let (q, v) = (
                    BASE.saturating_add(i),
                    N.saturating_add(BASE).saturating_add(i),
                );
                set(d.rows_x.get_mut(i), q, T::ONE);
                set(d.rows_x.get_mut(groups.joints.saturating_add(i)), v, T::ONE);
            }
        }
        let map = Map::new(dt, mid.layout);
        let mut limit = |row: usize, unit: T, gradient: &Gradient<T, N, 0>, joint: usize| {
            if let (Some(x), Some(u)) = (d.rows_x.get_mut(row), d.rows_u.get_mut(row)) {
                map.sparse(T::ONE / unit, gradient, core::iter::once(joint), x, u);
            }
        };
        for i in 0..groups.limited {
            let joint = BASE.saturating_add(i);
            let row = groups.first_limit().saturating_add(i);
            let (mut position, mut speed) = (Gradient::zero(), Gradient::zero());
            (position.q[joint], speed.v[joint]) = (T::ONE, T::ONE);
            limit(row, T::ONE, &position, joint);
            limit(
                row.saturating_add(groups.limited),
                units.speed,
                &speed,
                joint,
            );
        }
        let sides = pyramid(self.friction);
        let rows = d.rows_u.iter_mut().skip(groups.landing);
        for (i, row) in rows
            .enumerate()
            .take(groups.feet.saturating_mul(sides.len()))
        {
            let first = crate::state::Layout::force(i / sides.len());
            let slots = row.iter_mut().skip(first);
            for (slot, value) in slots.zip(sides.get(i % sides.len()).into_iter().flatten()) {
                *slot = *value;
            }
        }
    }
}
