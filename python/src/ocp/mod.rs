//! Optimal-control problems of the user's own. The solver's sizes are known when it is built; here a problem is padded to the next of a few.

mod asked;
mod differences;

use core::ops::ControlFlow;
use std::sync::Mutex;

use numpy::PyUntypedArrayMethods;
use ocp_solver::{Settings, Solution, Solver, Stage};
use pyo3::types::PyAnyMethods;
use pyo3::{Bound, Py, PyAny, PyErr, PyResult, Python, pyclass, pyfunction, pymethods};

use crate::arrays::{Numbers, Table, matrix, numbers, table};
use crate::errors::{bad, failed};
use asked::{Asked, Bounds};

/// Solves an optimal-control problem of your own on nodes 0 to N, by the interior-point method of the planner:
///
/// minimise the sum of cost_k(x_k, u_k) subject to x_{k+1} = next_k(x_k, u_k) and lower_k <= rows_k(x_k, u_k) <= upper_k.
///
/// `evaluate(k, x, u)` says all three for a batch of points: x has shape (b, nx), u (b, nu), zeros at node N; it returns (cost, next, rows)
/// of shapes (b,), (b, nx) and (b, m_k). At node N next, and where there are no rows rows, are not looked at. `x`, shape (N + 1, nx), and
/// `u`, shape (N, nu), are the guess; x[0] is the start, of which the coordinates in `free` may change: a free duration is a state
/// that stays constant, free at the start. `bounds(k)` returns lower and upper bounds of the rows of node k; equal ones are equalities.
///
/// Made for trying: derivatives are central differences, some 2 (nx + nu)² points per node and iteration in one call of evaluate, so that
/// evaluate takes nearly all of the time: 0.1 ms a node and iteration for two states. In Rust a problem has its own. Costs and rows must be
/// smooth and of size 1. At most 16 states, 8 controls and 32 rows. `progress(iteration, cost, violation)` is called after every iteration;
/// what it or evaluate raises, and Ctrl-C, ends the solve and is raised here.
///
/// Outcomes are a status, not an exception. Raises BadInput for shapes that do not fit, by name.
#[pyfunction]
#[pyo3(signature = (evaluate, x, u, bounds = None, *, free = Vec::new(), max_iterations = 600, progress = None))]
#[allow(
    clippy::too_many_arguments,
    reason = "an optimal-control problem has so many parts, and Python names its arguments"
)]
pub(crate) fn solve_ocp(
    py: Python<'_>,
    evaluate: Bound<'_, PyAny>,
    x: Numbers<'_>,
    u: Numbers<'_>,
    bounds: Option<Bound<'_, PyAny>>,
    free: Vec<usize>,
    max_iterations: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<OcpSolution> {
    let guess = Guess::read(&x, &u)?;
    let [nx, nu] = guess.sizes;
    let nodes = guess.x.len() / nx;
    if let Some(wrong) = free.iter().find(|i| **i >= nx) {
        return Err(bad(format!(
            "free: there is no coordinate {wrong} of {nx} in a state"
        )));
    }
    let bounds = (0..nodes).map(|k| read_bounds(bounds.as_ref(), k));
    let asked = Asked {
        evaluate: evaluate.unbind(),
        sizes: guess.sizes,
        bounds: bounds.collect::<PyResult<_>>()?,
        free: (0..nx).map(|i| free.contains(&i)).collect(),
        error: Mutex::new(None),
    };
    let rows = asked.bounds.iter().map(|[lower, _]| lower.len());
    let rows = rows.max().unwrap_or(0);
    let mut settings = Settings::new();
    settings.max_iterations = max_iterations;
    let observe = |iteration: usize, cost: f64, violation: f64| {
        py.check_signals()?;
        if let Some(progress) = &progress {
            progress.call1(py, (iteration, cost, violation))?;
        }
        Ok(())
    };
    match (nx, nu, rows) {
        (..=4, ..=2, ..=8) => solve::<4, 2, 8>(&asked, &guess, settings, observe),
        (..=8, ..=4, ..=16) => solve::<8, 4, 16>(&asked, &guess, settings, observe),
        (..=16, ..=8, ..=32) => solve::<16, 8, 32>(&asked, &guess, settings, observe),
        _ => Err(bad(format!(
            "x, u, bounds: at most 16 states, 8 controls and 32 rows are solved, not {nx}, {nu} and {rows}"
        ))),
    }
}

/// Bounds of the rows of node `k`; none where the user has none.
fn read_bounds(bounds: Option<&Bound<'_, PyAny>>, k: usize) -> PyResult<Bounds> {
    let Some(bounds) = bounds else {
        return Ok([Vec::new(), Vec::new()]);
    };
    let (lower, upper): (Numbers<'_>, Numbers<'_>) = bounds.call1((k,))?.extract()?;
    let count = lower.len();
    Ok([
        numbers(&format!("lower bounds of node {k}"), &lower, count)?,
        numbers(&format!("upper bounds of node {k}"), &upper, count)?,
    ])
}

/// Where the search begins, node by node.
struct Guess {
    sizes: [usize; 2],
    x: Vec<f64>,
    u: Vec<f64>,
}

impl Guess {
    fn read(x: &Numbers<'_>, u: &Numbers<'_>) -> PyResult<Self> {
        let &[nodes, nx] = x.shape() else {
            return Err(bad("x: must have shape (N + 1, nx)"));
        };
        let &[intervals, nu] = u.shape() else {
            return Err(bad("u: must have shape (N, nu)"));
        };
        if nodes < 2 || nx == 0 {
            return Err(bad("x: must have at least two nodes of one number"));
        }
        if intervals + 1 != nodes {
            return Err(bad(format!(
                "u: must have shape ({}, nu), one row less than x, not ({intervals}, {nu})",
                nodes - 1
            )));
        }
        Ok(Self {
            sizes: [nx, nu],
            x: matrix("x", x, [nodes, nx])?,
            u: matrix("u", u, [intervals, nu])?,
        })
    }
}

/// Solves among the states, controls and rows of a larger problem.
fn solve<const NX: usize, const NU: usize, const NI: usize>(
    asked: &Asked,
    guess: &Guess,
    settings: Settings<f64>,
    mut observe: impl FnMut(usize, f64, f64) -> PyResult<()>,
) -> PyResult<OcpSolution> {
    let [nx, nu] = guess.sizes;
    let padded = |x: &[f64]| core::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0));
    let states = guess.x.chunks_exact(nx);
    let mut stages: Vec<Stage<f64, [f64; NX], NX, NU, NI>> =
        states.map(|x| Stage::new(padded(x))).collect();
    for (k, stage) in stages.iter_mut().enumerate() {
        let from = (k * nu).min(guess.u.len());
        let to = (from + nu).min(guess.u.len());
        for (to, from) in stage.control.iter_mut().zip(&guess.u[from..to]) {
            *to = *from;
        }
    }
    let mut stopped: Option<PyErr> = None;
    let outcome = Solver::new(settings).solve(asked, &mut stages, |p| {
        let told = match asked.take_error() {
            Some(error) => Err(error),
            None => observe(p.iteration, p.cost, p.residual.primal),
        };
        match told {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                stopped = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    if let Some(error) = stopped.or_else(|| asked.take_error()) {
        return Err(error);
    }
    let first = |x: &[f64], count: usize| x[..count].to_vec();
    Ok(OcpSolution {
        outcome: outcome.map_err(failed)?,
        sizes: guess.sizes,
        x: stages.iter().map(|stage| first(&stage.state, nx)).collect(),
        u: stages[..stages.len() - 1]
            .iter()
            .map(|stage| first(&stage.control, nu))
            .collect(),
    })
}

/// The outcome of an optimal-control problem.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct OcpSolution {
    outcome: Solution<f64>,
    sizes: [usize; 2],
    x: Vec<Vec<f64>>,
    u: Vec<Vec<f64>>,
}

#[pymethods]
impl OcpSolution {
    /// "Solved", or why not: "IterationLimit", "LocallyInfeasible", "Stalled", "Indefinite" or "NotFinite".
    #[getter]
    fn status(&self) -> String {
        format!("{:?}", self.outcome.status)
    }

    /// States, shape (N + 1, nx).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        table(py, self.sizes[0], &self.x)
    }

    /// Controls, shape (N, nu).
    #[getter]
    fn u<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        table(py, self.sizes[1], &self.u)
    }

    /// Sum of the costs.
    #[getter]
    fn cost(&self) -> f64 {
        self.outcome.cost
    }

    /// Iterations, over all attempts.
    #[getter]
    fn iterations(&self) -> usize {
        self.outcome.iterations
    }

    /// Largest violation of a row's bounds or of the dynamics.
    #[getter]
    fn violation(&self) -> f64 {
        self.outcome.violation
    }

    fn __repr__(&self) -> String {
        format!(
            "OcpSolution({:?}, cost {:.6e}, {} iterations)",
            self.outcome.status, self.outcome.cost, self.outcome.iterations
        )
    }
}
