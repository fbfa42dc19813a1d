//! A pendulum is swung up with less torque than would hold it sideways: nonlinear dynamics, a bound, a wish for the end.
//!
//! `cargo run --release -p ocp-solver --example swing_up`

use core::ops::ControlFlow;
use ocp_solver::{Derivatives, Dims, Evaluated, Problem, Settings, Solver, Stage, Status, Values};

const INTERVALS: usize = 180;
const STEP: f64 = 0.05;
/// Torque over weight and length: 1 would hold it sideways.
const TORQUE: f64 = 0.6;
/// Weights of the angle and the speed at the end.
const END: f64 = 1e4;

/// State: angle from upright, rad, and its rate; length 1 m over gravity taken as 1.
struct SwingUp;

impl Problem<f64, 2, 1, 1> for SwingUp {
    type State = [f64; 2];

    fn intervals(&self) -> usize {
        INTERVALS
    }

    fn dims(&self, k: usize) -> Dims {
        let used = usize::from(k < INTERVALS);
        Dims {
            controls: used,
            control_rows: used,
            ..Dims::default()
        }
    }

    fn bounds(&self, _: usize, lower: &mut [f64; 1], upper: &mut [f64; 1]) {
        (lower[0], upper[0]) = (-TORQUE, TORQUE);
    }

    fn is_free_at_start(&self, _: usize) -> bool {
        false
    }

    fn retract(
        &self,
        _: usize,
        x: &[f64; 2],
        dx: &[f64; 2],
        _: Option<(&[f64; 2], &[f64; 1])>,
    ) -> [f64; 2] {
        [x[0] + dx[0], x[1] + dx[1]]
    }

    fn evaluate(
        &self,
        _: usize,
        x: &[f64; 2],
        u: &[f64; 1],
        next: Option<&[f64; 2]>,
        v: &mut Values<f64, 2, 1>,
    ) {
        v.rows[0] = u[0];
        let Some(next) = next else {
            v.cost = END * (x[0] * x[0] + x[1] * x[1]);
            return;
        };
        v.cost = STEP * u[0] * u[0];
        let rate = x[1] + STEP * (so3::math::sin(x[0]) + u[0]);
        v.gap = [x[0] + STEP * rate - next[0], rate - next[1]];
    }

    fn differentiate(
        &self,
        _: usize,
        x: &[f64; 2],
        u: &[f64; 1],
        next: Option<&[f64; 2]>,
        _: Evaluated<'_, f64, 2, 1>,
        d: &mut Derivatives<f64, 2, 1, 1>,
    ) {
        if next.is_none() {
            d.cost_x = [2.0 * END * x[0], 2.0 * END * x[1]];
            d.hessian_xx = [[2.0 * END, 0.0], [0.0, 2.0 * END]];
            return;
        }
        d.cost_u = [2.0 * STEP * u[0]];
        d.hessian_uu = [[2.0 * STEP]];
        let slope = STEP * so3::math::cos(x[0]);
        // Columns: what angle, rate and torque do to the next state.
        d.dynamics_x = [[1.0 + STEP * slope, slope], [STEP, 1.0]];
        d.dynamics_u = [[STEP * STEP, STEP]];
        d.rows_u = [[1.0]];
    }
}

fn main() -> Result<(), ocp_solver::Error> {
    let hanging = [core::f64::consts::PI, 0.0];
    let mut stages = vec![Stage::new(hanging); INTERVALS + 1];
    let solution =
        Solver::new(Settings::new()).solve(&SwingUp, &mut stages, |_| ControlFlow::Continue(()))?;
    println!(
        "{:?} after {} iterations",
        solution.status, solution.iterations
    );
    for (k, stage) in stages.iter().enumerate().step_by(20) {
        println!(
            "{:.2} s: {:7.1} degrees",
            k as f64 * STEP,
            stage.state[0].to_degrees()
        );
    }
    assert_eq!(solution.status, Status::Solved);
    assert!(stages[INTERVALS].state[0].abs() < 0.05, "it stands");
    Ok(())
}
