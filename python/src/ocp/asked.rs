//! A user's problem: what it says at a batch of points, and its derivatives by differences.

use std::sync::{Mutex, PoisonError};

use numpy::PyArray1;
use numpy::PyArrayMethods;
use ocp_solver::{Derivatives, Dims, Evaluated, Problem, Values};
use pyo3::types::{PyAnyMethods, PyTuple};
use pyo3::{Bound, Py, PyAny, PyErr, PyResult, Python};

use super::differences::{Told, derive};
use crate::arrays::{Numbers, matrix, numbers};
use crate::errors::bad;

/// Lower and upper bounds of the rows of a node.
pub(super) type Bounds = [Vec<f64>; 2];

/// The user's problem.
pub(super) struct Asked {
    /// evaluate(k, x, u) for a batch of points.
    pub(super) evaluate: Py<PyAny>,
    /// Numbers of a state and of a control.
    pub(super) sizes: [usize; 2],
    /// Of every node.
    pub(super) bounds: Vec<Bounds>,
    /// Which coordinates of the first state may be changed.
    pub(super) free: Vec<bool>,
    /// The first error of the user's function: what comes after it does not count.
    pub(super) error: Mutex<Option<PyErr>>,
}

impl Asked {
    /// Whether node `k` is the last.
    const fn is_last(&self, k: usize) -> bool {
        k + 1 >= self.bounds.len()
    }

    /// Controls of node `k`.
    pub(super) const fn controls(&self, k: usize) -> usize {
        if self.is_last(k) { 0 } else { self.sizes[1] }
    }

    fn rows(&self, k: usize) -> usize {
        self.bounds.get(k).map_or(0, |[lower, _]| lower.len())
    }

    /// What the user's function says at points: states, then controls, one after the other.
    fn ask(&self, py: Python<'_>, k: usize, points: &[Vec<f64>]) -> PyResult<Vec<Told>> {
        let (nx, nu) = (self.sizes[0], self.controls(k));
        let (count, m) = (points.len(), self.rows(k));
        let states = points.iter().flat_map(|point| &point[..nx]);
        let x = PyArray1::from_iter(py, states.copied()).reshape([count, nx])?;
        // At the last node there are none: the user's function sees zeros, so that it need not know.
        let none = vec![0.0; self.sizes[1] - nu];
        let controls = points
            .iter()
            .flat_map(|point| point[nx..].iter().chain(&none));
        let u = PyArray1::from_iter(py, controls.copied()).reshape([count, self.sizes[1]])?;
        let told = self.evaluate.bind(py).call1((k, x, u))?;
        let told = told.cast_into::<PyTuple>().map_err(|_| {
            bad(format!(
                "evaluate({k}, x, u): must return (cost, next, rows)"
            ))
        })?;
        let (cost, next, rows): (Numbers<'_>, Bound<'_, PyAny>, Bound<'_, PyAny>) =
            told.extract()?;
        let cost = numbers(&format!("cost of node {k}"), &cost, count)?;
        let table = |name: &str, x: &Bound<'_, PyAny>, columns: usize| {
            if columns == 0 {
                return Ok(Vec::new());
            }
            matrix(
                &format!("{name} of node {k}"),
                &x.extract()?,
                [count, columns],
            )
        };
        let next = table("next", &next, if self.is_last(k) { 0 } else { nx })?;
        let rows = table("rows", &rows, m)?;
        let of = |all: &[f64], i: usize| {
            let columns = all.len() / count;
            all[i * columns..(i + 1) * columns].to_vec()
        };
        let told = cost.into_iter().enumerate().map(|(i, cost)| Told {
            cost,
            next: of(&next, i),
            rows: of(&rows, i),
        });
        Ok(told.collect())
    }

    /// As [`Asked::ask`]; an error is kept, and there is no answer then.
    fn answer(&self, k: usize, points: &[Vec<f64>]) -> Option<Vec<Told>> {
        let told = Python::attach(|py| self.ask(py, k, points));
        told.map_err(|error| {
            let mut first = self.error.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert(error);
        })
        .ok()
    }

    /// Takes the first error of the user's function.
    pub(super) fn take_error(&self) -> Option<PyErr> {
        let mut first = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        first.take()
    }

    /// State and control as one point, without what was padded.
    fn point(&self, k: usize, state: &[f64], control: &[f64]) -> Vec<f64> {
        let state = state.iter().take(self.sizes[0]);
        let control = control.iter().take(self.controls(k));
        state.chain(control).copied().collect()
    }
}

/// Coordinates of the state that are not there stay where they are, and cost nothing.
impl<const NX: usize, const NU: usize, const NI: usize> Problem<f64, NX, NU, NI> for Asked {
    type State = [f64; NX];

    fn intervals(&self) -> usize {
        self.bounds.len() - 1
    }

    fn dims(&self, k: usize) -> Dims {
        let (controls, rows) = (self.controls(k), self.rows(k));
        let [state_rows, mixed_rows] = if controls == 0 { [rows, 0] } else { [0, rows] };
        Dims {
            controls,
            state_rows,
            control_rows: 0,
            mixed_rows,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; NI], upper: &mut [f64; NI]) {
        let Some([low, high]) = self.bounds.get(k) else {
            return;
        };
        for ((to, from), (up, top)) in lower.iter_mut().zip(low).zip(upper.iter_mut().zip(high)) {
            (*to, *up) = (*from, *top);
        }
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        self.free.get(i).copied().unwrap_or(false)
    }

    fn retract(
        &self,
        _: usize,
        state: &[f64; NX],
        step: &[f64; NX],
        _: Option<(&[f64; NX], &[f64; NU])>,
    ) -> [f64; NX] {
        core::array::from_fn(|i| state[i] + step[i])
    }

    fn evaluate(
        &self,
        k: usize,
        state: &[f64; NX],
        control: &[f64; NU],
        next: Option<&[f64; NX]>,
        values: &mut Values<f64, NX, NI>,
    ) {
        values.cost = f64::NAN;
        let told = self.answer(k, &[self.point(k, state, control)]);
        let Some(told) = told.as_deref().and_then(<[Told]>::first) else {
            return;
        };
        values.cost = told.cost;
        for (to, from) in values.rows.iter_mut().zip(&told.rows) {
            *to = *from;
        }
        if let Some(next) = next {
            for (i, gap) in values.gap.iter_mut().enumerate() {
                *gap = told.next.get(i).unwrap_or(&state[i]) - next[i];
            }
        }
    }

    fn differentiate(
        &self,
        k: usize,
        state: &[f64; NX],
        control: &[f64; NU],
        _: Option<&[f64; NX]>,
        at: Evaluated<'_, f64, NX, NI>,
        derivatives: &mut Derivatives<f64, NX, NU, NI>,
    ) {
        let (nx, d) = (self.sizes[0], derivatives);
        let point = self.point(k, state, control);
        let multipliers = (&at.dynamics_multiplier[..], &at.row_multipliers[..]);
        let found = derive(&point, multipliers, |points| self.answer(k, points));
        let Some(found) = found else {
            return;
        };
        for i in nx..NX {
            d.dynamics_x[i][i] = 1.0;
        }
        for (j, slope) in found.slopes.iter().enumerate() {
            let (cost, dynamics) = match j.checked_sub(nx) {
                None => (&mut d.cost_x[j], &mut d.dynamics_x[j]),
                Some(j) => (&mut d.cost_u[j], &mut d.dynamics_u[j]),
            };
            *cost = slope.cost;
            for (to, from) in dynamics.iter_mut().zip(&slope.next) {
                *to = *from;
            }
            for (i, from) in slope.rows.iter().enumerate() {
                match j.checked_sub(nx) {
                    None => d.rows_x[i][j] = *from,
                    Some(j) => d.rows_u[i][j] = *from,
                }
            }
        }
        for (i, row) in found.curvature.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                match (i.checked_sub(nx), j.checked_sub(nx)) {
                    (None, None) => d.hessian_xx[j][i] = *x,
                    (None, Some(j)) => d.hessian_xu[j][i] = *x,
                    (Some(i), Some(j)) => d.hessian_uu[j][i] = *x,
                    (Some(_), None) => {}
                }
            }
        }
    }
}
