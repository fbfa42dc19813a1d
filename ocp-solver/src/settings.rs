//! Options, progress and outcome of a solve.

use so3::Scalar;
use so3::math::{max, min};

/// How the barrier parameter µ goes to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Barrier {
    /// Every iteration anew from the complementarity of the iterate (the rule of LOQO); fewest iterations.
    Adaptive,
    /// From `initial_mu` down, whenever the barrier problem is solved well enough; steadiest.
    Monotone,
    /// Monotone; where that does not end in a solution, from the guess again with the adaptive rule, and
    /// then with the monotone rule from a thirty times larger µ.
    #[default]
    Portfolio,
}

/// Options of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings<T> {
    /// Largest number of iterations, over all attempts.
    pub max_iterations: usize,
    /// Largest number of iterations of one attempt of a portfolio.
    pub attempt_iterations: usize,
    /// Part of `max_iterations` that is kept for the search of a point of least violation where nothing
    /// else ends in a solution; none is kept if it is more than half of them.
    pub restoration_iterations: usize,
    /// Largest violation of dynamics and rows at a solution, in their own units.
    pub primal_tolerance: T,
    /// Largest entry of the gradient of the Lagrangian at a solution, relative to the mean multiplier
    /// where that is above 100.
    pub dual_tolerance: T,
    /// Largest product of a distance to a bound and its multiplier at a solution, scaled likewise.
    pub complementarity_tolerance: T,
    /// Rule for the barrier parameter.
    pub barrier: Barrier,
    /// First µ of the monotone rule.
    pub initial_mu: T,
    /// The first attempt keeps the multipliers that the last solve left in the stages, for a problem that has
    /// changed little: every row begins on the central path where it is nearest to its value and its multiplier. Combine it with the monotone rule, or the portfolio, and an `initial_mu` of 1e-5
    /// (nearly the same problem) to 1e-2.
    pub warm_start: bool,
    /// The monotone rule multiplies µ by this, or raises it to the power of `mu_power`, whichever is less.
    pub mu_factor: T,
    /// See `mu_factor`.
    pub mu_power: T,
    /// The monotone rule goes on once the residuals are below this many times µ.
    pub mu_margin: T,
    /// Factor of the adaptive rule.
    pub adaptive_factor: T,
    /// Multiplier every bound starts with under the adaptive rule.
    pub initial_multiplier: T,
    /// Distance slacks keep from their bounds at the start.
    pub bound_push: T,
    /// An entry below this share of the largest that made it counts as zero when equalities are
    /// eliminated: their row then holds no control, or depends on others.
    pub rank_tolerance: T,
    /// The adaptive rule has stalled after this many steps in a row shorter than `stall_step`; the
    /// monotone rule after ten times as many.
    pub stall_count: usize,
    /// See `stall_count`.
    pub stall_step: T,
    /// Under the monotone rule every slack, and every bound multiplier that falls, takes as much of its own step as keeps a tenth of it,
    /// where otherwise the row that has the least room shortens the step of all.
    ///
    /// A slack that stops early leaves its row violated by what is missing, which the filter weighs against what the others gain. That
    /// takes about half the iterations where the guess is of the right shape, and fails more often where it is far from any solution.
    pub individual_steps: bool,
    /// How many threads work at once on nodes that do not wait for each other; 1 as a default, and 0 counts as 1. All numbers are those
    /// of one thread, bit for bit. It pays where a node is large: a thread is begun for every pass of an iteration.
    #[cfg(feature = "std")]
    pub threads: usize,
}

impl<T: Scalar> Settings<T> {
    /// The defaults; tolerances are those that the scalar type can reach: 1e-4, 1e-2, 1e-4 in `f32`.
    #[must_use]
    pub fn new() -> Self {
        let noise = so3::math::sqrt(T::EPSILON);
        let at_least = |tolerance: f64, share: f64| max(T::of(tolerance), T::of(share) * noise);
        Self {
            max_iterations: 600,
            attempt_iterations: 200,
            restoration_iterations: 300,
            primal_tolerance: at_least(2e-7, 0.3),
            dual_tolerance: at_least(1e-6, 30.0),
            complementarity_tolerance: at_least(1e-6, 0.3),
            barrier: Barrier::default(),
            initial_mu: T::of(0.01),
            warm_start: false,
            mu_factor: T::of(0.2),
            mu_power: T::of(1.5),
            mu_margin: T::of(30.0),
            adaptive_factor: T::of(0.03),
            initial_multiplier: T::ONE,
            bound_push: T::of(0.2),
            rank_tolerance: T::of(0.007) * noise,
            stall_count: 3,
            stall_step: T::of(0.03),
            individual_steps: false,
            #[cfg(feature = "std")]
            threads: 1,
        }
    }

    /// How many threads work at once: one where the build knows of no others.
    pub(crate) const fn workers(&self) -> usize {
        #[cfg(feature = "std")]
        return self.threads;
        #[cfg(not(feature = "std"))]
        1
    }
}

impl<T: Scalar> Default for Settings<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// What the observer sees after every iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress<T> {
    /// Iterations so far.
    pub iteration: usize,
    /// Cost of the iterate.
    pub cost: T,
    /// Residuals of the iterate.
    pub residual: Residual<T>,
    /// Barrier parameter of the step that led here.
    pub mu: T,
    /// Primal step length.
    pub primal_step: T,
    /// Dual step length.
    pub dual_step: T,
    /// Shift of the Hessian that made it positive definite.
    pub shift: T,
    /// 0 for the first barrier rule, 1 after a restart.
    pub attempt: usize,
}

/// Residuals of the optimality conditions, largest entries.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Residual<T> {
    /// Violation of dynamics and rows.
    pub primal: T,
    /// Gradient of the Lagrangian, scaled.
    pub dual: T,
    /// Distance × multiplier, scaled.
    pub complementarity: T,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// All residuals are within their tolerances.
    Solved,
    /// The iteration limit was reached first.
    IterationLimit,
    /// The observer asked to stop.
    Cancelled,
    /// No solution was found, and the stages hold a point of least squared violation of the rows among its
    /// neighbours: [`blocking_rows`](crate::blocking_rows) names them. This proves nothing about points far
    /// away.
    LocallyInfeasible,
    /// Steps became too short to make progress.
    Stalled,
    /// The Hessian could not be made positive definite.
    Indefinite,
    /// The problem returned a NaN or an infinity where the solve could not step around it.
    NotFinite,
}

/// Outcome of a solve; states and controls are left in the stages.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution<T> {
    /// How it ended. Unless [`Status::Solved`] or [`Status::LocallyInfeasible`], the stages hold the best
    /// iterate seen.
    pub status: Status,
    /// Iterations, over all attempts.
    pub iterations: usize,
    /// Cost of the returned iterate.
    pub cost: T,
    /// Residuals of the returned iterate.
    pub residual: Residual<T>,
    /// Largest violation of a row's bounds or of the dynamics there.
    pub violation: T,
    /// Last barrier parameter.
    pub mu: T,
    /// Factorisations, including those repeated with a shifted Hessian.
    pub factorisations: usize,
    /// Restarts under another barrier rule.
    pub restarts: usize,
}

/// Data that cannot be solved with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The slice of stages must hold exactly `intervals + 1` nodes.
    StageCount {
        /// Nodes of the problem.
        needed: usize,
        /// Length of the slice.
        given: usize,
    },
    /// A node asks for more controls or rows than the const sizes hold.
    Dims {
        /// The node.
        stage: usize,
    },
    /// A row has a NaN bound, or its lower bound is above its upper bound.
    Bounds {
        /// The node.
        stage: usize,
        /// The row.
        row: usize,
    },
    /// The guess gives a cost, gap or row that is not finite.
    Guess {
        /// The node.
        stage: usize,
    },
    /// A setting is not a positive finite number (tolerances, weights) or is zero (limits).
    Setting(&'static str),
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::StageCount { needed, given } => {
                write!(
                    f,
                    "{given} stages given, {needed} needed: one per node, intervals + 1"
                )
            }
            Self::Dims { stage } => {
                write!(
                    f,
                    "node {stage} has more controls or rows than NU and NI hold: raise them"
                )
            }
            Self::Bounds { stage, row } => {
                write!(
                    f,
                    "row {row} of node {stage}: bounds must be numbers with lower <= upper"
                )
            }
            Self::Guess { stage } => {
                write!(
                    f,
                    "the guess is not finite at node {stage}: start from finite values"
                )
            }
            Self::Setting(name) => write!(f, "setting `{name}` must be positive and finite"),
        }
    }
}

impl core::error::Error for Error {}

impl<T: Scalar> Settings<T> {
    /// Rules to try in turn: whether it is the adaptive one, and its first µ.
    pub(crate) fn attempts(&self) -> [Option<(bool, T)>; 3] {
        let mu = self.initial_mu;
        match self.barrier {
            Barrier::Adaptive => [Some((true, mu)), None, None],
            Barrier::Monotone => [Some((false, mu)), None, None],
            Barrier::Portfolio => [
                Some((false, mu)),
                Some((true, mu)),
                Some((false, mu * T::of(30.0))),
            ],
        }
    }

    /// Factor on multipliers, which grow with the inverse of the give of the rows.
    pub(crate) fn relief(elastic: T) -> T {
        if elastic > T::ZERO {
            max(min(T::of(1e3) * elastic, T::ONE), T::of(1e-3))
        } else {
            T::ONE
        }
    }

    pub(crate) fn smallest_mu(&self, elastic: T) -> T {
        self.complementarity_tolerance * T::of(0.1) / Self::relief(elastic)
    }

    /// The largest residual in units of its tolerance.
    pub(crate) fn score(&self, residual: &Residual<T>) -> T {
        max(
            max(
                residual.primal / self.primal_tolerance,
                residual.dual / self.dual_tolerance,
            ),
            residual.complementarity / self.complementarity_tolerance,
        )
    }

    /// Whether all residuals are within tolerance; a wider one for points of least violation.
    pub(crate) fn is_solved(&self, residual: &Residual<T>, elastic: T) -> bool {
        let (relief, wider) = if elastic > T::ZERO {
            (Self::relief(elastic), T::of(100.0))
        } else {
            (T::ONE, T::ONE)
        };
        residual.primal <= self.primal_tolerance * wider
            && residual.dual * relief <= self.dual_tolerance * wider
            && residual.complementarity * relief <= self.complementarity_tolerance
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        for (value, name) in [
            (self.primal_tolerance, "primal_tolerance"),
            (self.dual_tolerance, "dual_tolerance"),
            (self.complementarity_tolerance, "complementarity_tolerance"),
            (self.initial_mu, "initial_mu"),
            (self.mu_factor, "mu_factor"),
            (self.mu_power, "mu_power"),
            (self.mu_margin, "mu_margin"),
            (self.adaptive_factor, "adaptive_factor"),
            (self.initial_multiplier, "initial_multiplier"),
            (self.bound_push, "bound_push"),
            (self.rank_tolerance, "rank_tolerance"),
            (self.stall_step, "stall_step"),
        ] {
            if !(value > T::ZERO && value.is_finite_number()) {
                return Err(Error::Setting(name));
            }
        }
        for (value, name) in [
            (self.max_iterations, "max_iterations"),
            (self.attempt_iterations, "attempt_iterations"),
        ] {
            if value == 0 {
                return Err(Error::Setting(name));
            }
        }
        Ok(())
    }
}
