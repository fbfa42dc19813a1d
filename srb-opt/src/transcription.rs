//! Problem (2) as an optimal-control problem for `ocp-solver`: costs, rows, and the state after an interval, paper A
//! eq. (2b).

use crate::dynamics::{Interval, force_unit};
use crate::problem::Problem;
use crate::rotation::{LogError, about_axis, exp};
use crate::state::{OMEGA, ROTATION, State, TIMES, add_block, put};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{Derivatives, Dims, Evaluated, Problem as Ocp, Values};
use so3::Scalar;

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// `I_b⁻¹`.
    #[inline(always)]
    pub(crate) fn inverse_inertia(&self) -> Matrix3<T> {
        crate::rotation::inverse(&self.inertia_b)
    }

    /// Rotation error `Rrefᵀ R`.
    #[inline(always)]
    fn tracking_error(&self, state: &State<T, PHASES>) -> Matrix3<T> {
        let (sin, cos) = state.reference;
        about_axis(&self.axis, sin, cos).transpose() * state.rot_wb
    }
}

impl<T, const FEET: usize, const PHASES: usize, const NX: usize, const NU: usize, const NI: usize>
    Ocp<T, NX, NU, NI> for Problem<T, FEET, PHASES>
where
    T: Scalar,
{
    type State = State<T, PHASES>;

    fn intervals(&self) -> usize {
        Problem::intervals(self)
    }

    fn dims(&self, k: usize) -> Dims {
        self.row_dims(k)
    }

    fn bounds(&self, k: usize, lower: &mut [T; NI], upper: &mut [T; NI]) {
        self.row_bounds(k, lower, upper);
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        i >= TIMES && i < TIMES.saturating_add(self.phase_count)
    }

    #[inline(always)]
    fn retract(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        step: &[T; NX],
        before: Option<(&State<T, PHASES>, &[T; NU])>,
    ) -> State<T, PHASES> {
        let mut out = state.moved(step);
        let turn = Vector3::new(step[ROTATION], step[ROTATION + 1], step[ROTATION + 2]);
        let wanted = state.rot_wb * exp(&turn);
        match before.zip(k.checked_sub(1).and_then(|k| self.phase_of(k))) {
            Some(((before, _), (phase, data))) => {
                let duration = before.durations.get(phase).copied().unwrap_or(T::ZERO);
                let dt = duration * (T::ONE / T::of(data.intervals.max(1) as f64));
                let turn = self.exponential.step(&(before.omega_b * dt));
                out.attach(&wanted, &(before.rot_wb * turn));
            }
            None => out.rot_wb = wanted,
        }
        out
    }

    #[inline(always)]
    fn evaluate(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        control: &[T; NU],
        next: Option<&State<T, PHASES>>,
        values: &mut Values<T, NX, NI>,
    ) {
        values.cost = T::ZERO;
        self.row_values(k, state, control, values);
        let Some(next) = next else { return };
        let Some(interval) = Interval::new(self, k, state, control) else {
            return;
        };
        interval.gap(state, next, &mut values.gap);
        let error = LogError::new(&self.tracking_error(state), self.log_epsilon).error;
        let unit = force_unit(self);
        let in_use = self.row_dims(k).controls;
        let force = control
            .iter()
            .take(in_use)
            .fold(T::ZERO, |sum, u| sum + *u * *u)
            * unit
            * unit;
        let weights = &self.weights;
        values.cost = weights.omega * state.omega_b.norm_squared()
            + weights.force * force
            + weights.rotation * error.norm_squared();
    }

    #[inline(always)]
    fn differentiate(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        control: &[T; NU],
        next: Option<&State<T, PHASES>>,
        at: Evaluated<'_, T, NX, NI>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        match (next, Interval::new(self, k, state, control)) {
            (Some(next), Some(interval)) => {
                interval.differentiate(self, state, next, at.dynamics_multiplier, d);
                let weights = &self.weights;
                let error = self.tracking_error(state);
                let log = LogError::new(&error, self.log_epsilon);
                let by_rotation = log.derivative(&error);
                let two = T::TWO * weights.rotation;
                put(
                    &mut d.cost_x,
                    ROTATION,
                    &(by_rotation.transpose() * log.error * two),
                );
                let curvature = log.curvature(&error, self.log_epsilon) * weights.rotation;
                add_block(&mut d.hessian_xx, ROTATION, ROTATION, &curvature);
                let two = T::TWO * weights.omega;
                put(&mut d.cost_x, OMEGA, &(state.omega_b * two));
                add_block(
                    &mut d.hessian_xx,
                    OMEGA,
                    OMEGA,
                    &Matrix3::from_diagonal_element(two),
                );
                let unit = force_unit(self);
                let two = T::TWO * weights.force * unit * unit;
                let in_use = self.row_dims(k).controls;
                for (i, ((g, h), u)) in d
                    .cost_u
                    .iter_mut()
                    .zip(&mut d.hessian_uu)
                    .zip(control)
                    .enumerate()
                    .take(in_use)
                {
                    *g = two * *u;
                    h[i] = two;
                }
            }
            _ => {
                for column in &mut d.hessian_xx {
                    *column = [T::ZERO; NX];
                }
            }
        }
        // Position and rotation blocks that the dynamics leave alone are rewritten here.
        self.differentiate_rows(k, state, at.values, at.row_multipliers, d);
    }
}
