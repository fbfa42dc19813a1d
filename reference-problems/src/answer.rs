//! What comes of solving a problem.

use ocp_solver::{Solution, Status};
use serde_json::Value;

/// What comes of solving a problem once.
#[derive(Clone, Debug)]
pub struct Answer {
    /// How the solve ended.
    pub status: Status,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Barriers that the solver tried after the first.
    pub restarts: usize,
    /// Wall time of guess and solve, without the memory that they need, ms.
    pub wall_ms: f64,
    /// Cost of the solution, of the problem as stated and not of the solver's.
    pub cost: f64,
    /// Largest violation of a constraint, in the constraint's units.
    pub max_violation: f64,
    /// Largest vertical force of a foot, N, and torque of a joint, N m, on the whole body.
    pub peaks: Option<[f64; 2]>,
    /// Durations of the phases, s.
    pub durations: Vec<f64>,
    /// The solution in the layout of the reference checkers.
    pub solution: Value,
}

impl Answer {
    /// Of a solve, before anything was judged.
    pub(crate) fn new(outcome: &Solution<f64>, wall_ms: f64) -> Self {
        Self {
            status: outcome.status,
            iterations: outcome.iterations,
            restarts: outcome.restarts,
            wall_ms,
            cost: f64::NAN,
            max_violation: f64::NAN,
            peaks: None,
            durations: Vec::new(),
            solution: Value::Null,
        }
    }
}
