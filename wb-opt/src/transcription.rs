//! The whole-body problem as an optimal-control problem for `ocp-solver`, with the cost of paper A eq. (6).

use crate::differentiate::Interval;
use crate::drive::Line;
use crate::map::Map;
use crate::midpoint::Midpoint;
use crate::problem::Problem;
use crate::robot::{BASE, Point, TURN};
use crate::rotation::{Step, set_block, set_triple, triple};
use crate::state::{Layout, State, Units};
use crate::stretch::{Stretch, Turning};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{Derivatives, Dims, Evaluated, Problem as Ocp, Values};
use rbd_core::second_order::{Contacts, Gradient, Sweep};
use so3::{Scalar, hat};

/// A node: its index, state, control, and the next state unless it is the last.
pub(crate) type Node<'a, T, const N: usize, const NU: usize> =
    (usize, &'a State<T, N>, &'a [T; NU], Option<&'a State<T, N>>);

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Points whose height over the ground is a row of interval `k`, in the order of the rows.
    pub(crate) fn points_over_ground(&self, k: usize) -> impl Iterator<Item = &Point<T>> {
        let swing = self.feet.iter().zip(self.contacts(k));
        let swing = swing.filter(|(_, on)| !*on).map(|(foot, _)| &foot.point);
        self.clearances.iter().map(|c| &c.point).chain(swing)
    }

    /// Cost of interval `k` with given efforts.
    fn interval_cost(&self, k: usize, mid: &Midpoint<T, N, FEET>, effort: &[T; N]) -> T {
        let distance = self.reference.get(k).map_or(T::ZERO, |reference| {
            reference.distance_squared(&mid.q, &mid.rot_wc)
        });
        let efforts = effort.iter().skip(BASE).copied();
        let weights = self.interval_weights(k);
        weights.position * distance + weights.effort * efforts.fold(T::ZERO, |sum, x| sum + x * x)
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
            push(
                self.over_ground(&sweep.place(point.link, &point.offset_l))
                    .height
                    / units.position,
            );
        }
        if mid.layout.joints > 0 {
            for q in mid.q.iter().skip(BASE) {
                push(*q);
            }
            for v in mid.v.iter().skip(BASE) {
                push(*v / units.speed);
            }
            for pair in self.apart {
                push(pair.near(sweep).value / units.position);
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
        self.moved(state, step.iter().copied())
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
            let goal = &self.goal;
            values.cost = self.weights.goal * goal.distance_squared(&state.q, &state.rot_wc);
            self.end(state).iter().for_each(|row| push(*row));
            return;
        };
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let mut sweep = Sweep::zero(&self.robot.bodies);
        mid.set(&mut sweep);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut effort = [T::ZERO; N];
        sweep.effort(&mid.a, &contacts, &mut effort);
        self.add_friction(&mid.v, &mut effort);
        values.cost = self.interval_cost(k, &mid, &effort);

        let [of_q, of_v] = self.gap(k, state, &mid, next);
        let of_v = of_v.iter().map(|x| *x / units.speed);
        for (gap, value) in values.gap.iter_mut().zip(of_q.into_iter().chain(of_v)) {
            *gap = value;
        }

        if self.groups(k).landing > 0 {
            state.q.iter().skip(BASE).for_each(|q| push(*q));
            let speeds = state.v.iter().skip(BASE);
            speeds.for_each(|v| push(*v / units.speed));
        }
        for force in mid.forces.iter().take(contacts.count) {
            for side in self.friction.gradients() {
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
        self.differentiate_with((k, state, control, next), None, at, d);
    }
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// The derivatives of a node; `free` is the coordinate of the duration of its phase and its share of an interval's length, if the
    /// duration is free.
    pub(crate) fn differentiate_with<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        (k, state, control, next): Node<'_, T, N, NU>,
        free: Option<(usize, T)>,
        at: Evaluated<'_, T, NX, NI>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let Some(next) = next else {
            self.differentiate_end(state, at.row_multipliers, d);
            return;
        };
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let map = Map::new(self.dt(k), mid.layout, self.turn(k, &mid));
        let stretch =
            free.map(|(column, rate)| Stretch::new(column, rate, self.dt(k), &mid, map.turn()));
        self.differentiate_linear(k, &mid, d);
        let mut sweep = Sweep::zero(&self.robot.bodies);
        mid.set(&mut sweep);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut interval = Interval {
            problem: self,
            k,
            mid: &mid,
            sweep: &sweep,
            contacts: &contacts,
            map,
            row: self.groups(k).first_mixed(),
            turning: [Vector3::zeros(); 3],
            stretch,
            whole: Gradient::ZERO,
        };
        interval.differentiate(at.row_multipliers, d);
        let (map, turning) = (interval.map, interval.turning);
        let Some(turn) = map.turn() else {
            if let Some(stretch) = &stretch {
                stretch.gap(at.dynamics_multiplier, None, d);
            }
            return;
        };
        let step = Step::new(turn.omega() * self.dt(k));
        let next_from_start = next.rot_wc.matrix().tr_mul(state.rot_wc.matrix());
        let next_from_end = next_from_start * step.exp;
        let turning = Turning {
            turn,
            step: &step,
            next_from_end: &next_from_end,
            reach: &next_from_end.tr_mul(&triple(at.dynamics_multiplier, TURN)),
            gradient: &turning,
        };
        self.differentiate_turn(k, &next_from_start, &turning, d);
        if let Some(stretch) = &stretch {
            stretch.gap(at.dynamics_multiplier, Some(turning), d);
        }
    }

    /// A state moved by a step in the solver's units.
    #[inline(always)]
    pub(crate) fn moved(
        &self,
        state: &State<T, N>,
        mut steps: impl Iterator<Item = T>,
    ) -> State<T, N> {
        let speed = Units::<T>::new().speed;
        let mut out = *state;
        for (q, step) in out.q.iter_mut().zip(steps.by_ref()) {
            *q += step;
        }
        for (v, step) in out.v.iter_mut().zip(steps) {
            *v += speed * step;
        }
        if self.robot.turns_freely() {
            // The angles are zero but for the step.
            out.rot_wc = state.rot_wc * so3::exp(&triple(&out.q, TURN));
            set_triple(&mut out.q, TURN, &Vector3::zeros());
        }
        out
    }

    /// Rows of the last node: coordinates of the base; on SO(3) sine times axis of the angle from the goal.
    fn end(&self, state: &State<T, N>) -> [T; BASE] {
        let mut rows: [T; BASE] =
            core::array::from_fn(|i| state.q.get(i).copied().unwrap_or(T::ZERO));
        if self.robot.turns_freely() {
            set_triple(&mut rows, TURN, &so3::vee(&self.goal.seen(&state.rot_wc)));
        }
        rows
    }

    /// The last node: distance to the goal.
    fn differentiate_end<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        state: &State<T, N>,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let two = T::TWO * self.weights.goal;
        let ends = state.q.iter().zip(&self.goal.q);
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
        if self.robot.turns_freely() {
            // With E = Rgᵀ R: the cost is 3 − tr E, the rows vee((E − Eᵀ)/2); both linear in R Exp(θ).
            let e = self.goal.seen(&state.rot_wc);
            let bent = |m: &Matrix3<T>| {
                Matrix3::from_diagonal_element(m.trace()) - (m + m.transpose()) * T::HALF
            };
            let multiplier = triple(y, TURN);
            let hessian = bent(&e) * self.weights.goal + bent(&(hat(&multiplier) * e)) * T::HALF;
            set_block(&mut d.hessian_xx, TURN, TURN, &hessian);
            set_triple(&mut d.cost_x, TURN, &(so3::vee(&e) * two));
            let by_turn = (Matrix3::from_diagonal_element(e.trace()) - e.transpose()) * T::HALF;
            // Rows are gradients: the transpose of a column-major block.
            set_block(&mut d.rows_x, TURN, TURN, &by_turn.transpose());
        }
    }

    /// The gap of a rotation, and what bends because rotations do.
    fn differentiate_turn<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        k: usize,
        next_from_start: &Matrix3<T>,
        turning: &Turning<'_, T>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let units = Units::<T>::new();
        let dt = self.dt(k);
        let (step, next_from_end) = (turning.step, turning.next_from_end);
        // Seen from the next node, where the gap is a step: exact up to the gap's square.
        let by_speed = next_from_end * step.jacobian * dt;
        let speeds = N.saturating_add(TURN);
        set_block(&mut d.dynamics_x, TURN, TURN, next_from_start);
        set_block(&mut d.dynamics_x, TURN, speeds, &(by_speed * units.speed));
        let by_control = by_speed * (dt * T::HALF * units.acceleration);
        set_block(&mut d.dynamics_u, TURN, TURN, &by_control);
        turning
            .turn
            .add_curvature(turning.gradient, (step, turning.reach), N, d);
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
        let map = Map::new(dt, mid.layout, None);
        let mut limit = |row: usize, unit: T, gradient: &Gradient<T, N, 0>, joint: usize| {
            if let (Some(x), Some(u)) = (d.rows_x.get_mut(row), d.rows_u.get_mut(row)) {
                map.sparse(T::ONE / unit, gradient, core::iter::once(joint), x, u);
            }
        };
        for i in 0..groups.limited {
            let joint = BASE.saturating_add(i);
            let row = groups.first_limit().saturating_add(i);
            let (mut position, mut speed) = (Gradient::ZERO, Gradient::ZERO);
            (position.q[joint], speed.v[joint]) = (T::ONE, T::ONE);
            limit(row, T::ONE, &position, joint);
            limit(
                row.saturating_add(groups.limited),
                units.speed,
                &speed,
                joint,
            );
        }
        let mut rows = d.rows_u.iter_mut().skip(groups.landing);
        for foot in 0..groups.feet {
            for side in self.friction.gradients() {
                if let Some(row) = rows.next() {
                    set_triple(row, Layout::force(foot), &Vector3::from(side));
                }
            }
        }
    }
}
