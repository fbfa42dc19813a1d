//! Small problems with known optima, and how tests draw.

use ocp_solver::{Derivatives, Dims, Evaluated, Problem, Values};
use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// The same cases on every machine, unless `PROPTEST_RNG_SEED` says otherwise.
pub(crate) fn config(cases: u32, seed: u64) -> ProptestConfig {
    let mut config = ProptestConfig::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    config
}

/// Rest to rest over one metre with |u| ≤ 1 in least time: T = 2, bang-bang. State (position, speed, T).
pub(crate) struct LeastTime {
    pub(crate) intervals: usize,
    pub(crate) longest: f64,
}

impl Problem<f64, 8, 4, 4> for LeastTime {
    type State = [f64; 3];

    fn intervals(&self) -> usize {
        self.intervals
    }

    fn dims(&self, k: usize) -> Dims {
        let end = k == self.intervals;
        let state_rows = if end { 2 } else { usize::from(k == 0) };
        Dims {
            controls: usize::from(!end),
            state_rows,
            control_rows: usize::from(!end),
            mixed_rows: 0,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; 4], upper: &mut [f64; 4]) {
        if k == self.intervals {
            (lower[0], upper[0], lower[1], upper[1]) = (1.0, 1.0, 0.0, 0.0);
        } else {
            let mut at = 0;
            if k == 0 {
                (lower[0], upper[0]) = (0.1, self.longest);
                at = 1;
            }
            (lower[at], upper[at]) = (-1.0, 1.0);
        }
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        i == 2
    }

    fn retract(
        &self,
        _: usize,
        x: &[f64; 3],
        dx: &[f64; 8],
        _: Option<(&[f64; 3], &[f64; 4])>,
    ) -> [f64; 3] {
        [x[0] + dx[0], x[1] + dx[1], x[2] + dx[2]]
    }

    fn evaluate(
        &self,
        k: usize,
        x: &[f64; 3],
        u: &[f64; 4],
        next: Option<&[f64; 3]>,
        values: &mut Values<f64, 8, 4>,
    ) {
        let Some(next) = next else {
            (values.cost, values.rows[0], values.rows[1]) = (x[2], x[0], x[1]);
            return;
        };
        let dt = x[2] / self.intervals as f64;
        values.cost = 0.0;
        values.gap[0] = x[0] + dt * x[1] + 0.5 * dt * dt * u[0] - next[0];
        values.gap[1] = x[1] + dt * u[0] - next[1];
        values.gap[2] = x[2] - next[2];
        if k == 0 {
            (values.rows[0], values.rows[1]) = (x[2], u[0]);
        } else {
            values.rows[0] = u[0];
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
        if next.is_none() {
            d.cost_x[2] = 1.0;
            (d.rows_x[0][0], d.rows_x[1][1]) = (1.0, 1.0);
            return;
        }
        let share = 1.0 / self.intervals as f64;
        let dt = x[2] * share;
        let l = at.dynamics_multiplier;
        for i in 0..3 {
            d.dynamics_x[i][i] = 1.0;
        }
        d.dynamics_x[1][0] = dt;
        d.dynamics_x[2][0] = share * (x[1] + dt * u[0]);
        d.dynamics_x[2][1] = share * u[0];
        (d.dynamics_u[0][0], d.dynamics_u[0][1]) = (0.5 * dt * dt, dt);
        (d.hessian_xx[1][2], d.hessian_xx[2][1]) = (share * l[0], share * l[0]);
        d.hessian_xx[2][2] = share * share * u[0] * l[0];
        d.hessian_xu[0][2] = share * (dt * l[0] + l[1]);
        if k == 0 {
            (d.rows_x[0][2], d.rows_u[1][0]) = (1.0, 1.0);
        } else {
            d.rows_u[0][0] = 1.0;
        }
    }
}

/// Bryson and Denham: least ∫ ½ u² from (0, 1) to (0, −1) in one second under x ≤ `wall`.
pub(crate) struct BrysonDenham {
    pub(crate) intervals: usize,
    pub(crate) wall: f64,
}

impl Problem<f64, 8, 4, 4> for BrysonDenham {
    type State = [f64; 2];

    fn intervals(&self) -> usize {
        self.intervals
    }

    fn dims(&self, k: usize) -> Dims {
        let end = k == self.intervals;
        let state_rows = if end { 2 } else { usize::from(k > 0) };
        Dims {
            controls: usize::from(!end),
            state_rows,
            control_rows: 0,
            mixed_rows: 0,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; 4], upper: &mut [f64; 4]) {
        if k == self.intervals {
            (lower[0], upper[0], lower[1], upper[1]) = (0.0, 0.0, -1.0, -1.0);
        } else {
            (lower[0], upper[0]) = (f64::NEG_INFINITY, self.wall);
        }
    }

    fn is_free_at_start(&self, _: usize) -> bool {
        false
    }

    fn retract(
        &self,
        _: usize,
        x: &[f64; 2],
        dx: &[f64; 8],
        _: Option<(&[f64; 2], &[f64; 4])>,
    ) -> [f64; 2] {
        [x[0] + dx[0], x[1] + dx[1]]
    }

    fn evaluate(
        &self,
        _: usize,
        x: &[f64; 2],
        u: &[f64; 4],
        next: Option<&[f64; 2]>,
        values: &mut Values<f64, 8, 4>,
    ) {
        (values.rows[0], values.rows[1]) = (x[0], x[1]);
        let Some(next) = next else {
            values.cost = 0.0;
            return;
        };
        let dt = 1.0 / self.intervals as f64;
        values.cost = 0.5 * dt * u[0] * u[0];
        values.gap[0] = x[0] + dt * x[1] + 0.5 * dt * dt * u[0] - next[0];
        values.gap[1] = x[1] + dt * u[0] - next[1];
    }

    fn differentiate(
        &self,
        _: usize,
        _: &[f64; 2],
        u: &[f64; 4],
        next: Option<&[f64; 2]>,
        _: Evaluated<'_, f64, 8, 4>,
        d: &mut Derivatives<f64, 8, 4, 4>,
    ) {
        (d.rows_x[0][0], d.rows_x[1][1]) = (1.0, 1.0);
        if next.is_none() {
            return;
        }
        let dt = 1.0 / self.intervals as f64;
        (d.dynamics_x[0][0], d.dynamics_x[1][0], d.dynamics_x[1][1]) = (1.0, dt, 1.0);
        (d.dynamics_u[0][0], d.dynamics_u[0][1]) = (0.5 * dt * dt, dt);
        d.cost_u[0] = dt * u[0];
        d.hessian_uu[0][0] = dt;
    }
}
