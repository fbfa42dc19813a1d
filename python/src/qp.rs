//! Dense quadratic programs. The solver's sizes are known when it is built; here a program is padded to the next of a few.

use dense_qp::{Problem, Settings, Solution, Workspace, solve};
use pyo3::{PyResult, Python, pyclass, pyfunction, pymethods};

use crate::arrays::{List, Numbers, list, matrix, numbers};
use crate::errors::bad;

/// A program of some size.
struct Program {
    hessian: Vec<f64>,
    gradient: Vec<f64>,
    rows: Vec<f64>,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// Limits of `count` rows or variables; none where they are not given.
fn limits(name: &str, x: Option<&Numbers<'_>>, count: usize, none: f64) -> PyResult<Vec<f64>> {
    x.map_or_else(|| Ok(vec![none; count]), |x| numbers(name, x, count))
}

impl Program {
    /// Solves it among the variables and rows of a larger one. Variables that are not there are fixed at 0, rows that are not there are
    /// zero without limits: both are out of the search.
    fn solve<const N: usize, const M: usize>(&self, settings: &Settings<f64>) -> PyResult<Answer> {
        let (n, m) = (self.gradient.len(), self.row_lower.len());
        let mut hessian = Box::new([[0.0; N]; N]);
        for (i, row) in hessian.iter_mut().enumerate() {
            match self.hessian.chunks(n.max(1)).nth(i) {
                Some(given) => fill(row, given),
                None => row[i] = 1.0,
            }
        }
        let mut rows = Box::new([[0.0; N]; M]);
        for (row, given) in rows.iter_mut().zip(self.rows.chunks(n.max(1))) {
            fill(row, given);
        }
        let padded = |x: &[f64], rest: f64| {
            let mut out = [rest; M];
            fill(&mut out, x);
            out
        };
        let [row_lower, row_upper] = [
            padded(&self.row_lower, f64::NEG_INFINITY),
            padded(&self.row_upper, f64::INFINITY),
        ];
        let [mut gradient, mut lower, mut upper] = [[0.0; N]; 3];
        fill(&mut gradient, &self.gradient);
        fill(&mut lower, &self.lower);
        fill(&mut upper, &self.upper);
        let problem = Problem::new(&hessian, &gradient, &rows, &row_lower, &row_upper)
            .with_bounds(&lower, &upper);
        let mut workspace = Box::new(Workspace::new());
        let found = solve(&problem, settings, &mut workspace).map_err(bad)?;
        Ok(Answer::of(&found, [n, m], problem.cost(found.x)))
    }
}

/// Writes the numbers that are given over the first ones.
fn fill(to: &mut [f64], from: &[f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

/// Minimises x' H x / 2 + g' x subject to row_lower <= A x <= row_upper and lower <= x <= upper.
///
/// `hessian` H, shape (n, n), is symmetric and positive semidefinite where equalities leave room; `gradient` g, shape (n,); `rows` A, shape
/// (m, n). Limits may be infinite and are none where they are not given; equal limits are an equality.
///
/// The solver of the workspace, with its own tolerances: `feasibility` is a distance from a row, `optimality` relative to the terms of the
/// gradient. Its sizes are fixed when it is built: a program is padded to 8, 16, 32 or 64 variables and twice as many rows, and costs
/// what the padded one does. At most 64 variables and 128 rows. `max_iterations` caps rows that enter or leave, where it is given.
///
/// Infeasible and unbounded programs are a status, not an exception. Raises BadInput for numbers that no solver could use, by name.
#[pyfunction]
#[pyo3(signature = (hessian, gradient, rows = None, row_lower = None, row_upper = None, lower = None, upper = None, *, feasibility = 1e-9, optimality = 1e-10, max_iterations = None))]
#[allow(
    clippy::too_many_arguments,
    reason = "a quadratic program has so many parts, and Python names its arguments"
)]
pub(crate) fn solve_qp(
    hessian: Numbers<'_>,
    gradient: Numbers<'_>,
    rows: Option<Numbers<'_>>,
    row_lower: Option<Numbers<'_>>,
    row_upper: Option<Numbers<'_>>,
    lower: Option<Numbers<'_>>,
    upper: Option<Numbers<'_>>,
    feasibility: f64,
    optimality: f64,
    max_iterations: Option<u32>,
) -> PyResult<QpSolution> {
    let n = gradient.as_array().len();
    let m = rows.as_ref().map_or(0, |rows| {
        rows.as_array().shape().first().copied().unwrap_or(0)
    });
    let free = f64::INFINITY;
    let program = Program {
        hessian: matrix("hessian", &hessian, [n, n])?,
        gradient: numbers("gradient", &gradient, n)?,
        rows: rows.map_or_else(|| Ok(Vec::new()), |rows| matrix("rows", &rows, [m, n]))?,
        row_lower: limits("row_lower", row_lower.as_ref(), m, -free)?,
        row_upper: limits("row_upper", row_upper.as_ref(), m, free)?,
        lower: limits("lower", lower.as_ref(), n, -free)?,
        upper: limits("upper", upper.as_ref(), n, free)?,
    };
    let settings = Settings {
        feasibility,
        optimality,
        max_iterations: max_iterations.unwrap_or(u32::MAX),
        ..Settings::default()
    };
    let answer = match (n, m) {
        (0, _) => return Err(bad("gradient: must have at least one number")),
        (..=8, ..=16) => program.solve::<8, 16>(&settings),
        (..=16, ..=32) => program.solve::<16, 32>(&settings),
        (..=32, ..=64) => program.solve::<32, 64>(&settings),
        (..=64, ..=128) => program.solve::<64, 128>(&settings),
        _ => Err(bad(format!(
            "gradient, rows: at most 64 variables and 128 rows are solved, not {n} and {m}"
        ))),
    };
    answer.map(QpSolution)
}

/// What came of it, without what was padded.
struct Answer {
    status: String,
    x: Vec<f64>,
    row_multipliers: Vec<f64>,
    bound_multipliers: Vec<f64>,
    ray: Option<Vec<f64>>,
    cost: f64,
    iterations: u32,
    residual: [f64; 3],
}

impl Answer {
    fn of<const N: usize, const M: usize>(
        found: &Solution<'_, f64, N, M>,
        [n, m]: [usize; 2],
        cost: f64,
    ) -> Self {
        let first = |x: &[f64], count: usize| x.iter().take(count).copied().collect::<Vec<_>>();
        let residual = &found.residual;
        Self {
            status: format!("{:?}", found.status),
            x: first(found.x, n),
            row_multipliers: first(found.row_multipliers, m),
            bound_multipliers: first(found.bound_multipliers, n),
            ray: found.ray().map(|ray| first(ray, n)),
            cost,
            iterations: found.iterations,
            residual: [
                residual.stationarity,
                residual.primal,
                residual.complementarity,
            ],
        }
    }
}

/// The outcome of a quadratic program.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct QpSolution(Answer);

#[pymethods]
impl QpSolution {
    /// "Solved", "Limit", "Infeasible", "Unbounded" or "Numerical".
    ///
    /// "Solved" has been checked against the conditions of optimality; with "Infeasible" the multipliers are the proof.
    #[getter]
    fn status(&self) -> &str {
        &self.0.status
    }

    /// The minimiser, or the best iterate, shape (n,).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.x)
    }

    /// Multipliers y of the rows, shape (m,): positive at the upper limit, negative at the lower, H x + g + A' y + z = 0.
    #[getter]
    fn row_multipliers<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.row_multipliers)
    }

    /// Multipliers z of the bounds, shape (n,), with the same signs.
    #[getter]
    fn bound_multipliers<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.bound_multipliers)
    }

    /// For "Unbounded" the direction in which the cost falls without end, shape (n,).
    #[getter]
    fn ray<'py>(&self, py: Python<'py>) -> Option<List<'py>> {
        self.0.ray.as_ref().map(|ray| list(py, ray))
    }

    /// x' H x / 2 + g' x.
    #[getter]
    fn cost(&self) -> f64 {
        self.0.cost
    }

    /// Rows that entered or left the active set, and corrections of the point.
    #[getter]
    fn iterations(&self) -> u32 {
        self.0.iterations
    }

    /// Largest violations of stationarity, of the limits, and of complementarity.
    #[getter]
    fn residual(&self) -> (f64, f64, f64) {
        let [stationarity, primal, complementarity] = self.0.residual;
        (stationarity, primal, complementarity)
    }

    fn __repr__(&self) -> String {
        format!("QpSolution({:?}, cost {:.6e})", self.0.status, self.0.cost)
    }
}
