//! Dense quadratic programs of the landing's size: 12 variables, 20 rows.

use dense_qp::{
    Problem, Settings, Solution, Status, Workspace, infeasibility, kkt_residual, solve, solve_warm,
};

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

const N: usize = 12;
const M: usize = 20;

/// x, status, iterations.
type Outcome<T> = ([T; N], T, T);

/// The data of a program.
struct Data<T> {
    hessian: [[T; N]; N],
    gradient: [T; N],
    rows: [[T; N]; M],
    row_limits: [[T; M]; 2],
    bounds: [[T; N]; 2],
}

impl<T: Real> Data<T> {
    fn random() -> Self {
        let mut stream = Stream::new(7);
        let factor: [[T; N]; N] = core::array::from_fn(|_| stream.array(1.0));
        let mut hessian = [[T::ZERO; N]; N];
        for (i, (row, a)) in hessian.iter_mut().zip(&factor).enumerate() {
            for (j, (x, b)) in row.iter_mut().zip(&factor).enumerate() {
                let dot = a.iter().zip(b).fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
                *x = if i == j { dot + T::HALF } else { dot };
            }
        }
        Self {
            hessian,
            gradient: stream.array(3.0),
            rows: core::array::from_fn(|_| stream.array(1.0)),
            row_limits: [[T::of(-0.3); M], [T::of(0.2); M]],
            bounds: [[-T::ONE; N], [T::ONE; N]],
        }
    }

    fn problem(&self) -> Problem<'_, T, N, M> {
        let [lower, upper] = &self.row_limits;
        let problem = Problem::new(&self.hessian, &self.gradient, &self.rows, lower, upper);
        problem.with_bounds(&self.bounds[0], &self.bounds[1])
    }
}

fn outcome<T: Real>(solution: &Solution<'_, T, N, M>) -> Outcome<T> {
    let status = match solution.status {
        Status::Solved => 0.0,
        Status::Limit => 1.0,
        Status::Infeasible => 2.0,
        Status::Unbounded => 3.0,
        Status::Numerical => 4.0,
    };
    let iterations = T::of(f64::from(solution.iterations));
    (*solution.x, T::of(status), iterations)
}

pub(super) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    let mut data = Data::random();
    let settings = Settings::default();
    let mut ws = Workspace::new();
    let input = (&data.problem(), &settings, &mut ws);
    on.call("solve", input, |(p, s, ws)| {
        solve(p, s, ws).map(|x| outcome(&x)).ok()
    });
    let input = (&data.problem(), &settings, &mut ws);
    on.call("solve_warm", input, |(p, s, ws)| {
        solve_warm(p, s, ws).map(|x| outcome(&x)).ok()
    });
    on.call("Workspace::active", &ws, |ws| {
        T::of(ws.active().count() as f64)
    });
    let capped = Settings {
        max_iterations: 3,
        ..settings
    };
    let input = (&data.problem(), &capped, &mut ws);
    on.call("solve capped", input, |(p, s, ws)| {
        solve(p, s, ws).map(|x| outcome(&x)).ok()
    });
    if let Ok(solution) = solve(&data.problem(), &settings, &mut ws) {
        let input = (&data.problem(), solution);
        on.call("kkt_residual", input, |(p, s)| {
            kkt_residual(p, s.x, s.row_multipliers, s.bound_multipliers).max()
        });
        on.call("cost", input, |(p, s)| p.cost(s.x));
    }
    // Twenty rows at 3 with variables of at most 1 leave nothing.
    data.row_limits = [[T::of(3.0); M]; 2];
    let input = (&data.problem(), &settings, &mut ws);
    on.call("solve infeasible", input, |(p, s, ws)| {
        solve(p, s, ws)
            .map(|x| {
                let proof = infeasibility(p, x.row_multipliers, x.bound_multipliers);
                (outcome(&x), (proof.combination, proof.support))
            })
            .ok()
    });
    data.row_limits = [[T::NAN; M]; 2];
    let input = (&data.problem(), &settings, &mut ws);
    on.call("solve not a number", input, |(p, s, ws)| {
        solve(p, s, ws).is_ok()
    });
}
