//! A box held by two fingers: the least forces inside the friction pyramids that carry its weight.
//!
//! `cargo run -p dense-qp --example grip`

use dense_qp::{Error, Problem, Settings, Status, Workspace, solve, solve_warm};

const FRICTION: f64 = 0.5;
/// No limit.
const FREE: f64 = f64::INFINITY;
/// Variables: normal and tangential force of the left finger, then of the right one, N. Cost: half the sum of squares.
const HESSIAN: [[f64; 4]; 4] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];
/// Sideways balance, weight, and two sides of each pyramid.
const ROWS: [[f64; 4]; 6] = [
    [1.0, 0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0, 1.0],
    [FRICTION, 1.0, 0.0, 0.0],
    [FRICTION, -1.0, 0.0, 0.0],
    [0.0, 0.0, FRICTION, 1.0],
    [0.0, 0.0, FRICTION, -1.0],
];

fn main() -> Result<(), Error> {
    let mut workspace = Workspace::new();
    // Each weight a little more, as from tick to tick of a controller: the last active set is tried first.
    for (tick, weight) in [10.0, 10.5, 11.0].into_iter().enumerate() {
        let lower = [0.0, weight, 0.0, 0.0, 0.0, 0.0];
        let upper = [0.0, weight, FREE, FREE, FREE, FREE];
        let problem = Problem::new(&HESSIAN, &[0.0; 4], &ROWS, &lower, &upper);
        let settings = Settings::default();
        let solution = if tick == 0 {
            solve(&problem, &settings, &mut workspace)?
        } else {
            solve_warm(&problem, &settings, &mut workspace)?
        };
        let iterations = solution.iterations;
        println!(
            "{weight} N: {:.2?} after {iterations} iterations",
            solution.x
        );
        assert_eq!(solution.status, Status::Solved);
        assert!(
            (solution.x[1] - FRICTION * solution.x[0]).abs() < 1e-9,
            "at its cone"
        );
    }
    Ok(())
}
