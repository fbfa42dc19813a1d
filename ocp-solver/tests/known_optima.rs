//! Problems whose optimum is known in closed form.

use crate::common::{BrysonDenham, LeastTime};
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicU32, Ordering};
use ocp_solver::{
    Barrier, Derivatives, Dims, Error, Evaluated, Problem, Settings, Solver, Stage, Status, Values,
    blocking_rows, derivative_errors,
};

fn least_time(intervals: usize) -> Vec<Stage<f64, [f64; 3], 8, 4, 4>> {
    let mut stages = vec![Stage::new([0.0; 3]); intervals + 1];
    for (k, stage) in stages.iter_mut().enumerate() {
        stage.state = [k as f64 / intervals as f64, 0.0, 1.0];
    }
    stages[0].state[0] = 0.0;
    stages
}

#[test]
fn the_least_time_over_a_metre_is_two_seconds_bang_bang() {
    let problem = LeastTime {
        intervals: 20,
        longest: 10.0,
    };
    for barrier in [Barrier::Adaptive, Barrier::Monotone] {
        let mut stages = least_time(20);
        let mut settings = Settings::new();
        settings.barrier = barrier;
        let solution = Solver::new(settings)
            .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!(solution.status, Status::Solved, "{solution:?}");
        assert!((solution.cost - 2.0).abs() < 1e-5, "{}", solution.cost);
        for (k, stage) in stages.iter().enumerate().take(20) {
            let side = if k < 10 { 1.0 } else { -1.0 };
            assert!(
                (stage.control[0] - side).abs() < 1e-3,
                "{k}: {}",
                stage.control[0]
            );
        }
    }
}

#[test]
fn bryson_and_denham_touch_the_wall_at_the_known_cost() {
    // J = 4 / (9 l) for l ≤ 1/6; the piecewise-constant control comes close from above.
    let wall = 1.0 / 9.0;
    let problem = BrysonDenham {
        intervals: 120,
        wall,
    };
    let mut stages = vec![Stage::new([0.0, 0.0]); 121];
    stages[0].state = [0.0, 1.0];
    let solution = Solver::new(Settings::new())
        .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::Solved);
    let known = 4.0 / (9.0 * wall);
    assert!(
        (solution.cost / known - 1.0).abs() < 2e-3,
        "{} {known}",
        solution.cost
    );
    let highest = stages
        .iter()
        .map(|stage| stage.state[0])
        .fold(0.0, f64::max);
    assert!(highest <= wall + 1e-8 && highest > wall - 1e-4);
}

#[test]
fn derivatives_agree_with_differences() {
    let problem = LeastTime {
        intervals: 5,
        longest: 10.0,
    };
    for k in 0..6 {
        let next = (k < 5).then_some([0.3, 0.2, 1.7]);
        let errors = derivative_errors(
            &problem,
            k,
            &[0.1, -0.4, 1.7],
            &[0.7, 0.0, 0.0, 0.0],
            next.as_ref(),
            1e-6,
        );
        assert!(errors.worst() < 1e-8, "{errors:?}");
    }
}

#[test]
fn an_infeasible_problem_is_named_with_its_least_violation() {
    // A metre takes two seconds; one and a half are allowed, which reach 0.5625 m at rest.
    let problem = LeastTime {
        intervals: 20,
        longest: 1.5,
    };
    let mut stages = least_time(20);
    let solution = Solver::new(Settings::new())
        .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::LocallyInfeasible, "{solution:?}");
    // Least squares of (T too long, distance missed, speed left, |u| too large) by hand are not simple, but
    // no row gives way by more than if the distance alone did.
    assert!(
        solution.violation > 0.02 && solution.violation < 0.4375,
        "{solution:?}"
    );
    let [first, second] = blocking_rows::<2, _, _, _, _, _, _>(&stages);
    let (first, second) = (first.unwrap(), second.unwrap());
    assert!((first.violation.abs() - solution.violation).abs() < 1e-9);
    assert!(first.violation.abs() >= second.violation.abs() && second.violation != 0.0);
}

#[test]
fn the_observer_cancels_and_limits_hold() {
    let problem = LeastTime {
        intervals: 20,
        longest: 10.0,
    };
    let mut stages = least_time(20);
    let solver = Solver::new(Settings::new());
    let stop = |p: &ocp_solver::Progress<f64>| {
        if p.iteration == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let solution = solver.solve(&problem, &mut stages, stop).unwrap();
    assert_eq!(
        (solution.status, solution.iterations),
        (Status::Cancelled, 3)
    );

    let mut settings = Settings::new();
    settings.max_iterations = 2;
    let mut stages = least_time(20);
    let solution = Solver::new(settings)
        .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(
        (solution.status, solution.iterations),
        (Status::IterationLimit, 2)
    );
}

#[test]
fn bad_data_is_refused_by_name() {
    let problem = LeastTime {
        intervals: 20,
        longest: 10.0,
    };
    let solver = Solver::new(Settings::new());
    let go = |_: &ocp_solver::Progress<f64>| ControlFlow::Continue(());
    let mut short = least_time(10);
    let error = solver.solve(&problem, &mut short, go).unwrap_err();
    assert_eq!(
        error,
        Error::StageCount {
            needed: 21,
            given: 11
        }
    );
    let mut broken = least_time(20);
    broken[4].state[1] = f64::NAN;
    assert!(matches!(
        solver.solve(&problem, &mut broken, go),
        Err(Error::Guess { .. })
    ));
    let mut settings = Settings::new();
    settings.rank_tolerance = f64::NAN;
    let error = Solver::new(settings)
        .solve(&problem, &mut least_time(20), go)
        .unwrap_err();
    assert_eq!(error, Error::Setting("rank_tolerance"));
}

#[test]
fn the_gain_of_the_duration_is_its_derivative_at_the_start() {
    // T = 2 √(1 − p + v²/2) − v for a start at p with speed v: both derivatives are −1 at rest at 0.
    let problem = LeastTime {
        intervals: 20,
        longest: 10.0,
    };
    let mut stages = least_time(20);
    let solution = Solver::new(Settings::new())
        .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::Solved);
    let mut free = [false; 8];
    free[2] = true;
    let gain = stages[0].free_gain(&free).unwrap();
    assert!((gain[2][0] + 1.0).abs() < 1e-3, "{:?}", gain[2]);
    // A speed moves the switch off its node, which a control held per interval pays for: 1/N more.
    assert!((gain[2][1] + 1.0).abs() < 0.06, "{:?}", gain[2]);
    assert_eq!(gain[0], [0.0; 8]);
}

/// The metre problem, whose dynamics turn to NaN after a number of evaluations.
struct Breaking {
    inner: LeastTime,
    left: AtomicU32,
}

impl Problem<f64, 8, 4, 4> for Breaking {
    type State = [f64; 3];

    fn intervals(&self) -> usize {
        self.inner.intervals
    }

    fn dims(&self, k: usize) -> Dims {
        self.inner.dims(k)
    }

    fn bounds(&self, k: usize, lower: &mut [f64; 4], upper: &mut [f64; 4]) {
        self.inner.bounds(k, lower, upper);
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        self.inner.is_free_at_start(i)
    }

    fn retract(
        &self,
        k: usize,
        x: &[f64; 3],
        dx: &[f64; 8],
        before: Option<(&[f64; 3], &[f64; 4])>,
    ) -> [f64; 3] {
        self.inner.retract(k, x, dx, before)
    }

    fn evaluate(
        &self,
        k: usize,
        x: &[f64; 3],
        u: &[f64; 4],
        next: Option<&[f64; 3]>,
        values: &mut Values<f64, 8, 4>,
    ) {
        self.inner.evaluate(k, x, u, next, values);
        let left = self.left.load(Ordering::Relaxed).saturating_sub(1);
        self.left.store(left, Ordering::Relaxed);
        if left == 0 {
            values.gap[0] = f64::NAN;
            values.cost = f64::NAN;
        }
    }

    fn differentiate(
        &self,
        k: usize,
        x: &[f64; 3],
        u: &[f64; 4],
        next: Option<&[f64; 3]>,
        at: Evaluated<'_, f64, 8, 4>,
        d: &mut Derivatives<f64, 8, 4, 4>,
    ) {
        self.inner.differentiate(k, x, u, next, at, d);
    }
}

#[test]
fn numbers_that_break_midway_end_the_solve_with_the_best_iterate() {
    for evaluations in [22, 60, 100, 150] {
        let inner = LeastTime {
            intervals: 20,
            longest: 10.0,
        };
        let problem = Breaking {
            inner,
            left: AtomicU32::new(evaluations),
        };
        let mut stages = least_time(20);
        let solution = Solver::new(Settings::new())
            .solve(&problem, &mut stages, |_| ControlFlow::Continue(()))
            .unwrap();
        assert_eq!(
            solution.status,
            Status::NotFinite,
            "{evaluations} {solution:?}"
        );
        assert!(stages.iter().all(|s| s.state.iter().all(|x| x.is_finite())));
    }
}
