//! Published problems with terminal equalities: their optimum in closed form.

use core::ops::ControlFlow;
use ocp_solver::{
    Derivatives, Dims, Evaluated, Problem, Settings, Solution, Solver, Stage, Status, Values,
    derivative_errors,
};

const GRAVITY: f64 = 1.5;

/// A body on a vertical line, `ḧ = u − g`, from a height and speed to another in time `T`: state (height,
/// speed, T), all three given at the start but `T` where it is free.
///
/// Lander: least `∫ u` for 0 ≤ u ≤ 3 with free `T` (Meditch, "On the problem of optimal thrust programming for a
/// lunar soft landing", 1964). Otherwise: least `∫ ½ u²` over one second without gravity and bounds.
struct Vertical {
    intervals: usize,
    lander: bool,
}

impl Vertical {
    fn gravity(&self) -> f64 {
        if self.lander { GRAVITY } else { 0.0 }
    }
}

impl Problem<f64, 3, 1, 3> for Vertical {
    type State = [f64; 3];

    fn intervals(&self) -> usize {
        self.intervals
    }

    fn dims(&self, k: usize) -> Dims {
        let end = k == self.intervals;
        Dims {
            controls: usize::from(!end),
            state_rows: if end { 2 } else { usize::from(k == 0) },
            control_rows: usize::from(!end),
            mixed_rows: 0,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; 3], upper: &mut [f64; 3]) {
        if k == self.intervals {
            let height = if self.lander { 0.0 } else { 1.0 };
            (lower[0], upper[0], lower[1], upper[1]) = (height, height, 0.0, 0.0);
            return;
        }
        let mut at = 0;
        if k == 0 {
            (lower[0], upper[0]) = (0.5, 20.0);
            at = 1;
        }
        (lower[at], upper[at]) = if self.lander {
            (0.0, 3.0)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        };
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        self.lander && i == 2
    }

    fn retract(
        &self,
        _: usize,
        x: &[f64; 3],
        dx: &[f64; 3],
        _: Option<(&[f64; 3], &[f64; 1])>,
    ) -> [f64; 3] {
        core::array::from_fn(|i| x[i] + dx[i])
    }

    fn evaluate(
        &self,
        k: usize,
        x: &[f64; 3],
        u: &[f64; 1],
        next: Option<&[f64; 3]>,
        values: &mut Values<f64, 3, 3>,
    ) {
        let Some(next) = next else {
            (values.cost, values.rows) = (0.0, [x[0], x[1], 0.0]);
            return;
        };
        let dt = x[2] / self.intervals as f64;
        let a = u[0] - self.gravity();
        values.cost = dt * if self.lander { u[0] } else { 0.5 * u[0] * u[0] };
        values.gap = [
            x[0] + dt * x[1] + 0.5 * dt * dt * a - next[0],
            x[1] + dt * a - next[1],
            x[2] - next[2],
        ];
        values.rows = if k == 0 {
            [x[2], u[0], 0.0]
        } else {
            [u[0], 0.0, 0.0]
        };
    }

    fn differentiate(
        &self,
        k: usize,
        x: &[f64; 3],
        u: &[f64; 1],
        next: Option<&[f64; 3]>,
        at: Evaluated<'_, f64, 3, 3>,
        d: &mut Derivatives<f64, 3, 1, 3>,
    ) {
        if next.is_none() {
            (d.rows_x[0], d.rows_x[1]) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
            return;
        }
        let share = 1.0 / self.intervals as f64;
        let (dt, a, l) = (x[2] * share, u[0] - self.gravity(), at.dynamics_multiplier);
        let (rate, slope, bend) = if self.lander {
            (u[0], 1.0, 0.0)
        } else {
            (0.5 * u[0] * u[0], u[0], 1.0)
        };
        (d.cost_x[2], d.cost_u[0]) = (share * rate, dt * slope);
        d.dynamics_x = [
            [1.0, 0.0, 0.0],
            [dt, 1.0, 0.0],
            [share * (x[1] + dt * a), share * a, 1.0],
        ];
        d.dynamics_u = [[0.5 * dt * dt, dt, 0.0]];
        d.hessian_xx = [
            [0.0; 3],
            [0.0, 0.0, share * l[0]],
            [0.0, share * l[0], share * share * a * l[0]],
        ];
        d.hessian_xu = [[0.0, 0.0, share * (slope + dt * l[0] + l[1])]];
        d.hessian_uu = [[dt * bend]];
        if k == 0 {
            (d.rows_x[0], d.rows_u[1]) = ([0.0, 0.0, 1.0], [1.0]);
        } else {
            d.rows_u[0] = [1.0];
        }
    }
}

type Stages = Vec<Stage<f64, [f64; 3], 3, 1, 3>>;

fn solve(problem: &Vertical, start: [f64; 3]) -> (Solution<f64>, Stages) {
    let mut stages = vec![Stage::new(start); problem.intervals + 1];
    for stage in &mut stages {
        stage.control[0] = problem.gravity();
    }
    let solution = Solver::new(Settings::new())
        .solve(problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    (solution, stages)
}

#[test]
fn the_lunar_lander_falls_and_then_burns_at_once() {
    // Free fall for t₁, then full thrust to the ground: 4.5 t₁² + 12 t₁ = 26 from 10 m at −2 m/s.
    let fall = (so3::math::sqrt(612.0f64) - 12.0) / 9.0;
    let burn = (2.0 + GRAVITY * fall) / GRAVITY;
    let problem = Vertical {
        intervals: 80,
        lander: true,
    };
    let (solution, stages) = solve(&problem, [10.0, -2.0, 3.0]);
    assert!(
        (solution.cost - 3.0 * burn).abs() < 2e-3,
        "{}",
        solution.cost
    );
    let time = stages[0].state[2];
    assert!((time - fall - burn).abs() < 0.05, "{time}");
    let dt = time / 80.0;
    for (k, stage) in stages.iter().enumerate().take(80) {
        let (from, to) = (k as f64 * dt, (k + 1) as f64 * dt);
        if to < fall - 0.06 {
            assert!(stage.control[0] < 1e-2, "{k}: {}", stage.control[0]);
        } else if from > fall + 0.06 {
            assert!(stage.control[0] > 2.99, "{k}: {}", stage.control[0]);
        }
    }
}

#[test]
fn rest_to_rest_costs_what_the_sampled_minimum_costs() {
    // A metre in a second with u held over N intervals: u_k ∝ N − 1 − 2k, cost 6 N² / (N² − 1).
    for n in [2, 3, 10, 40] {
        let problem = Vertical {
            intervals: n,
            lander: false,
        };
        let (solution, stages) = solve(&problem, [0.0, 0.0, 1.0]);
        let squared = (n * n) as f64;
        let wanted = 6.0 * squared / (squared - 1.0);
        assert!(
            (solution.cost / wanted - 1.0).abs() < 1e-9,
            "{n}: {}",
            solution.cost
        );
        // The multiplier of the distance is the derivative of the cost: −2 · cost per metre.
        let y = stages[n].row_multipliers()[0];
        assert!((y + 2.0 * wanted).abs() < 1e-6, "{n}: {y}");
    }
}

#[test]
fn derivatives_agree_with_differences() {
    for lander in [true, false] {
        let problem = Vertical {
            intervals: 5,
            lander,
        };
        for k in 0..6 {
            let next = (k < 5).then_some([0.3, 0.2, 1.7]);
            let errors =
                derivative_errors(&problem, k, &[0.1, -0.4, 1.7], &[0.7], next.as_ref(), 1e-6);
            assert!(errors.worst() < 1e-8, "{errors:?}");
        }
    }
}

#[test]
fn a_warm_start_follows_a_problem_that_has_changed_little() {
    let problem = Vertical {
        intervals: 80,
        lander: true,
    };
    let (cold, mut stages) = solve(&problem, [10.0, -2.0, 3.0]);
    let mut settings = Settings::new();
    (settings.warm_start, settings.initial_mu) = (true, 1e-5);
    let mut again = |height: f64| {
        stages[0].state[0] = height;
        let solution = Solver::new(settings)
            .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!(solution.status, Status::Solved, "{solution:?}");
        solution
    };
    let same = again(10.0);
    assert!((same.cost - cold.cost).abs() < 1e-5);
    assert!(same.iterations <= 3, "{same:?} {cold:?}");
    let higher = again(10.01);
    assert!(higher.iterations < cold.iterations, "{higher:?} {cold:?}");
    let (wanted, _) = solve(&problem, [10.01, -2.0, 3.0]);
    assert!((higher.cost - wanted.cost).abs() < 1e-5);
}
