//! Constraint rows of problem (2): reach, clearance, friction, forces and goal, paper A eq. (2a), and durations, eq. (2d).
//!
//! Order at a node, state rows first: reach of the feet in contact (3 rows each), clearance of the eight
//! corners; then, at node 0, the durations and their sum, or, at the last node, goal position,
//! goal rotation and its trace. Control rows follow: per foot four sides of the friction pyramid and
//! the normal force.

use crate::dynamics::force_unit;
use crate::problem::{Foot, Problem};
use crate::rotation::{hat, vee, vee_derivative};
use crate::state::{POSITION, ROTATION, State, TIMES, add_block, put};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{Derivatives, Dims, Values};
use so3::Scalar;
use so3::math::sin_cos;

/// Rows a node can have at most: the least `NI` for a number of feet and phases.
#[must_use]
pub const fn row_capacity(feet: usize, phases: usize) -> usize {
    let middle = 8 + 8 * feet;
    let start = phases + 1 + 5 * feet;
    let end = 8 + 7;
    let most = if middle > start { middle } else { start };
    if most > end { most } else { end }
}

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// Feet in contact over interval `k`; none at the last node.
    #[inline(always)]
    pub(crate) fn contacts(&self, k: usize) -> impl Iterator<Item = &Foot<T>> {
        let on = if k < self.intervals() {
            self.phase_of(k)
        } else {
            None
        };
        let flags = on.map_or([false; FEET], |(_, phase)| phase.contacts);
        self.feet
            .iter()
            .zip(flags)
            .filter(|(_, on)| *on)
            .map(|(foot, _)| foot)
    }

    pub(crate) fn row_dims(&self, k: usize) -> Dims {
        let feet = self.contacts(k).count();
        let reach = if k == 0 { 0 } else { feet.saturating_mul(3) };
        let clearance = if k == 0 { 0 } else { 8 };
        let special = if k == 0 {
            self.phase_count.saturating_add(1)
        } else if k == self.intervals() {
            7
        } else {
            0
        };
        Dims {
            controls: feet.saturating_mul(3),
            state_rows: reach + clearance + special,
            control_rows: feet.saturating_mul(5),
            mixed_rows: 0,
        }
    }

    pub(crate) fn row_bounds<const NI: usize>(
        &self,
        k: usize,
        lower: &mut [T; NI],
        upper: &mut [T; NI],
    ) {
        let mut rows = lower.iter_mut().zip(upper.iter_mut());
        let mut push = |l: T, h: T| {
            if let Some((lower, upper)) = rows.next() {
                (*lower, *upper) = (l, h);
            }
        };
        if k > 0 {
            for foot in self.contacts(k) {
                for ((l, h), centre) in self
                    .reach_lower
                    .iter()
                    .zip(&self.reach_upper)
                    .zip(&foot.nominal_b)
                {
                    push(*l + *centre, *h + *centre);
                }
            }
            for _ in 0..8 {
                push(self.clearance, T::INFINITY);
            }
        }
        if k == 0 {
            for phase in self.used_phases() {
                push(phase.min_duration, phase.max_duration);
            }
            push(self.min_total, self.max_total);
        }
        if k == self.intervals() {
            for goal in &self.goal_w {
                push(*goal, *goal);
            }
            for _ in 0..3 {
                push(T::ZERO, T::ZERO);
            }
            push(self.min_final_trace, T::INFINITY);
        }
        let unit = force_unit(self);
        for _ in self.contacts(k) {
            for _ in 0..4 {
                push(T::ZERO, T::INFINITY);
            }
            push(T::ZERO, self.max_force / unit);
        }
    }

    /// Final rotation error `Rgᵀ R`.
    fn final_error(&self, rot: &Matrix3<T>) -> Matrix3<T> {
        let (sin, cos) = sin_cos(self.angle);
        crate::rotation::about_axis(&self.axis, sin, cos).transpose() * rot
    }

    #[inline(always)]
    pub(crate) fn row_values<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        control: &[T; NU],
        values: &mut Values<T, NX, NI>,
    ) {
        let mut rows = values.rows.iter_mut();
        let mut push = |value: T| {
            if let Some(row) = rows.next() {
                *row = value;
            }
        };
        if k > 0 {
            let body_from_world = state.rot_wb.transpose();
            for foot in self.contacts(k) {
                let seen = body_from_world * (foot.pos_wf - state.pos_w);
                seen.iter().for_each(|value| push(*value));
            }
            for corner in &self.corners {
                let point = state.pos_w + state.rot_wb * corner;
                push(point.z - self.ground(&point));
            }
        }
        if k == 0 {
            let mut sum = T::ZERO;
            for duration in state.durations.iter().take(self.phase_count) {
                push(*duration);
                sum += *duration;
            }
            push(sum);
        }
        if k == self.intervals() {
            state.pos_w.iter().for_each(|value| push(*value));
            let error = self.final_error(&state.rot_wb);
            vee(&error).iter().for_each(|value| push(*value));
            push(error.trace());
        }
        let (triples, _) = control.as_chunks::<3>();
        for (_, [x, y, z]) in self.contacts(k).zip(triples) {
            let limit = self.friction * *z;
            for value in [limit - *x, limit + *x, limit - *y, limit + *y, *z] {
                push(value);
            }
        }
    }

    /// Gradients of the rows, and `Σ y ∇²c` added to the Hessian.
    #[inline(always)]
    pub(crate) fn differentiate_rows<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        values: &Values<T, NX, NI>,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let mut at = 0usize;
        if k > 0 {
            for foot in self.contacts(k) {
                differentiate_reach(state, foot, at, y, d);
                at += 3;
            }
            for corner in &self.corners {
                self.differentiate_clearance(state, corner, at, values, y, d);
                at += 1;
            }
        }
        if k == 0 {
            for i in 0..self.phase_count.min(PHASES) {
                if let Some(row) = d.rows_x.get_mut(at + i) {
                    row[TIMES + i] = T::ONE;
                }
                if let Some(row) = d.rows_x.get_mut(at + self.phase_count) {
                    row[TIMES + i] = T::ONE;
                }
            }
            at += self.phase_count + 1;
        }
        if k == self.intervals() {
            self.differentiate_goal(state, at, d);
            at += 7;
        }
        for (slot, _) in self.contacts(k).enumerate() {
            self.differentiate_friction(slot, at, d);
            at += 5;
        }
    }

    /// The row from `at` on of the height of a corner over the ground.
    #[inline(always)]
    fn differentiate_clearance<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        state: &State<T, PHASES>,
        corner: &Vector3<T>,
        at: usize,
        values: &Values<T, NX, NI>,
        y: &[T; NI],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let (Some(row), Some(value), Some(y)) =
            (d.rows_x.get_mut(at), values.rows.get(at), y.get(at))
        else {
            return;
        };
        let body_from_world = state.rot_wb.transpose();
        let mut normal = Vector3::new(T::ZERO, T::ZERO, T::ONE);
        if let Some(edge) = self.edge.filter(|edge| edge.drop != T::ZERO) {
            // The ground's tanh is known from the row value: no second evaluation.
            let height = state.pos_w.z + (state.rot_wb * corner).z - *value;
            let t = -T::TWO * height / edge.drop - T::ONE;
            let slope = edge.drop * T::HALF * (T::ONE - t * t) * edge.sign / edge.width;
            let axis = edge.axis.min(1);
            normal[axis] = slope;
            // The ground's curvature over the edge, along the way that the corner takes across it.
            let bent = T::TWO * t * slope * edge.sign / edge.width;
            let turned = corner.cross(&body_from_world.column(axis).into_owned());
            add_curvature(&mut d.hessian_xx, axis, &turned, -bent * *y);
        }
        let normal_b = body_from_world * normal;
        put(row, POSITION, &normal);
        put(row, ROTATION, &corner.cross(&normal_b));
        bend(&mut d.hessian_xx, &(normal_b * *y), corner);
    }

    /// The rows from `at` on of the goal's position, rotation and trace.
    #[inline(always)]
    fn differentiate_goal<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        state: &State<T, PHASES>,
        at: usize,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let error = self.final_error(&state.rot_wb);
        let by_rotation = vee_derivative(&error);
        for i in 0..3 {
            if let Some(row) = d.rows_x.get_mut(at + i) {
                row[POSITION + i] = T::ONE;
            }
            if let Some(row) = d.rows_x.get_mut(at + 3 + i) {
                put(row, ROTATION, &by_rotation.row(i).transpose());
            }
        }
        if let Some(row) = d.rows_x.get_mut(at + 6) {
            put(row, ROTATION, &(vee(&error) * -T::TWO));
        }
    }

    /// The rows from `at` on of the friction pyramid of the foot whose force is the `slot`-th of the control.
    #[inline(always)]
    fn differentiate_friction<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        slot: usize,
        at: usize,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let mu = self.friction;
        let sides = [
            [-T::ONE, T::ZERO, mu],
            [T::ONE, T::ZERO, mu],
            [T::ZERO, -T::ONE, mu],
            [T::ZERO, T::ONE, mu],
            [T::ZERO, T::ZERO, T::ONE],
        ];
        for (row, side) in d.rows_u.iter_mut().skip(at).zip(&sides) {
            for (entry, value) in row.iter_mut().skip(3 * slot).zip(side) {
                *entry = *value;
            }
        }
    }
}

/// The rows from `at` on of where a foot is seen from the body.
#[inline(always)]
fn differentiate_reach<
    T: Scalar,
    const PHASES: usize,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    state: &State<T, PHASES>,
    foot: &Foot<T>,
    at: usize,
    y: &[T; NI],
    d: &mut Derivatives<T, NX, NU, NI>,
) {
    let body_from_world = state.rot_wb.transpose();
    let seen = body_from_world * (foot.pos_wf - state.pos_w);
    let turned = hat(&seen);
    for i in 0..3 {
        let Some(row) = d.rows_x.get_mut(at + i) else {
            return;
        };
        put(row, POSITION, &(-body_from_world.row(i).transpose()));
        put(row, ROTATION, &turned.row(i).transpose());
    }
    let part = |i: usize| y.get(at + i).copied().unwrap_or(T::ZERO);
    let y = Vector3::new(part(0), part(1), part(2));
    bend(&mut d.hessian_xx, &y, &seen);
    let mixed = -(hat(&y) * body_from_world);
    add_block(&mut d.hessian_xx, ROTATION, POSITION, &mixed);
    add_block(&mut d.hessian_xx, POSITION, ROTATION, &mixed.transpose());
}

/// Adds `weight w wᵀ` for the direction `w` of a world axis and a rotation.
#[inline(always)]
fn add_curvature<T: Scalar, const NX: usize>(
    h: &mut [[T; NX]; NX],
    axis: usize,
    turned: &Vector3<T>,
    weight: T,
) {
    if weight == T::ZERO {
        return;
    }
    h[POSITION + axis][POSITION + axis] += weight;
    for i in 0..3 {
        let mixed = weight * turned[i];
        h[POSITION + axis][ROTATION + i] += mixed;
        h[ROTATION + i][POSITION + axis] += mixed;
        for j in 0..3 {
            h[ROTATION + j][ROTATION + i] += mixed * turned[j];
        }
    }
}

/// Adds the rotation Hessian of `yᵀ Exp(−θ) c` (equal to that of `yᵀ Exp(θ) c`):
/// `½ (y cᵀ + c yᵀ) − (y·c) I`.
#[inline(always)]
fn bend<T: Scalar, const NX: usize>(h: &mut [[T; NX]; NX], y: &Vector3<T>, c: &Vector3<T>) {
    let outer = (y * c.transpose() + c * y.transpose()) * T::HALF;
    add_block(
        h,
        ROTATION,
        ROTATION,
        &(outer - Matrix3::from_diagonal_element(y.dot(c))),
    );
}
