//! The whole-body problem with the durations of its phases among the unknowns: timings straight on the whole body, which paper A
//! (III) leaves to a simpler model.

use crate::error::Error;
use crate::judge::Judgement;
use crate::problem::{Phase, Problem};
use crate::robot::BASE;
use crate::rows::row_capacity;
use crate::state::State;
use core::ops::ControlFlow;
use ocp_solver::{
    Derivatives, Dims, Evaluated, Problem as Ocp, Progress, Settings, Solution, Solver,
    SparseStage, Status, Values,
};
use so3::Scalar;
use so3::math::max;

/// Times that a motion is solved again whose durations moved its bounds.
const REPEATS: usize = 6;
/// How far a motion may break bounds in the durations that it found, in the units of [`Problem::judge`].
const KEPT: f64 = 1e-3;
/// Barrier to begin with when it is solved again.
const AGAIN_MU: f64 = 1e-4;

/// A whole-body problem whose phases may be shorter or longer; each keeps its number of intervals.
#[derive(Clone, Copy, Debug)]
pub struct FreeTiming<'a, T: Scalar, const N: usize, const FEET: usize, const PHASES: usize> {
    /// The problem; lengths of its intervals are the guess.
    pub problem: Problem<'a, T, N, FEET>,
    /// Shortest and longest duration of each phase, s; one entry for each of the problem's, the rest is not used.
    pub durations: [[T; 2]; PHASES],
    /// Shortest and longest total duration, s.
    pub total: [T; 2],
}

/// State of a node, and the durations of all phases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedState<T: Scalar, const N: usize, const PHASES: usize> {
    /// Configuration and velocity.
    pub state: State<T, N>,
    /// Durations, s; the same at all nodes of a solution.
    pub durations: [T; PHASES],
}

/// A stage of [`FreeTiming`].
pub type TimedStage<
    T,
    const N: usize,
    const PHASES: usize,
    const NX: usize,
    const NU: usize,
    const NI: usize,
> = SparseStage<T, TimedState<T, N, PHASES>, NX, NU, NI>;

impl<T: Scalar, const N: usize, const FEET: usize, const PHASES: usize>
    FreeTiming<'_, T, N, FEET, PHASES>
{
    /// First tangent coordinate of the durations.
    const TIMES: usize = 2 * N;

    /// Number of phases.
    const fn count(&self) -> usize {
        self.problem.phases.len()
    }

    /// The durations that the problem's intervals have.
    #[must_use]
    pub fn guessed(&self) -> [T; PHASES] {
        let mut durations = [T::ZERO; PHASES];
        for (slot, phase) in durations.iter_mut().zip(self.problem.phases) {
            *slot = phase.dt * T::of(phase.intervals as f64);
        }
        durations
    }

    /// The problem with these durations.
    fn with<R>(
        &self,
        durations: &[T; PHASES],
        use_it: impl FnOnce(&Problem<'_, T, N, FEET>) -> R,
    ) -> R {
        let mut phases = [Phase {
            contacts: [false; FEET],
            intervals: 0,
            dt: T::ZERO,
            weight: T::ONE,
        }; PHASES];
        let given = self.problem.phases.iter().zip(durations);
        for (slot, (phase, duration)) in phases.iter_mut().zip(given) {
            *slot = Phase {
                dt: *duration * Self::rate(phase),
                ..*phase
            };
        }
        let phases = phases.get(..self.count()).unwrap_or(&[]);
        use_it(&Problem {
            phases,
            ..self.problem
        })
    }

    /// Length of an interval per duration of its phase.
    fn rate(phase: &Phase<T, FEET>) -> T {
        T::ONE / T::of(phase.intervals.max(1) as f64)
    }

    /// Index of the phase of interval `k`.
    fn phase_index(&self, k: usize) -> Option<usize> {
        let mut end = 0usize;
        self.problem.phases.iter().position(|phase| {
            end = end.saturating_add(phase.intervals);
            k < end
        })
    }

    /// Writes the guess of the problem with given timing ([`Problem::write_guess`]) into the stages.
    pub fn write_guess<const SMALL: usize, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        given: &[SparseStage<T, State<T, N>, SMALL, NU, NI>],
        stages: &mut [TimedStage<T, N, PHASES, NX, NU, NI>],
    ) {
        let durations = self.guessed();
        for (stage, given) in stages.iter_mut().zip(given) {
            stage.state = TimedState {
                state: given.state,
                durations,
            };
            stage.control = given.control;
        }
    }

    /// Plans motion and durations from the guess in the stages and leaves them there.
    ///
    /// Two bounds ask how long a foot stands or hovers yet ([`Problem::release`], [`Problem::swing_rise`]) and are those of the durations
    /// that a solve begins with. Where a motion breaks them in the durations that it found, it is solved again from there, with those.
    ///
    /// # Errors
    /// [`Error::Parameter`] for unusable data, [`Error::Capacity`] for const sizes that are too small,
    /// [`Error::Solver`] for what the solver refuses.
    pub fn plan<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        settings: &Settings<T>,
        stages: &mut [TimedStage<T, N, PHASES, NX, NU, NI>],
        mut observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        self.problem.check()?;
        let problem = &self.problem;
        let bounds = self
            .durations
            .iter()
            .take(self.count())
            .chain([&self.total]);
        let ordered = bounds
            .into_iter()
            .all(|[low, high]| *low > T::ZERO && low <= high && high.is_finite_number());
        if !ordered {
            return Err(Error::Parameter(
                "durations, total: must be positive and finite, the shortest not above the longest",
            ));
        }
        let lines = problem.robot.motors.iter().any(Option::is_some);
        let fits = self.count() <= PHASES
            && NX >= Self::TIMES.saturating_add(PHASES)
            && NU >= N.saturating_add(FEET.saturating_mul(3))
            && NI >= row_capacity(N, FEET, problem.friction.sides(), problem.points(), lines)
            && NI >= BASE.saturating_add(PHASES).saturating_add(1);
        if !fits {
            return Err(Error::Capacity);
        }
        let mut solution = Solver::new(*settings).solve(self, stages, &mut observer)?;
        let mut again = *settings;
        (again.warm_start, again.initial_mu) = (true, T::of(AGAIN_MU));
        for _ in 0..REPEATS {
            let nodes = stages.iter().map(|stage| (&stage.state, &stage.control));
            let judged = self.judge(nodes);
            let Some(first) = stages.first() else { break };
            if solution.status != Status::Solved || judged.max_violation <= T::of(KEPT) {
                break;
            }
            let iterations = solution.iterations;
            let durations = first.state.durations;
            solution = self.with(&durations, |problem| {
                let timed = FreeTiming {
                    problem: *problem,
                    durations: self.durations,
                    total: self.total,
                };
                Solver::new(again).solve(&timed, stages, &mut observer)
            })?;
            solution.iterations = solution.iterations.saturating_add(iterations);
        }
        Ok(solution)
    }

    /// Judges a motion in physical units, its durations included.
    #[must_use]
    pub fn judge<'s, const NU: usize>(
        &self,
        mut nodes: impl Iterator<Item = (&'s TimedState<T, N, PHASES>, &'s [T; NU])> + Clone,
    ) -> Judgement<T> {
        let start = nodes.clone().next();
        let durations = start.map_or([T::ZERO; PHASES], |(node, _)| node.durations);
        let motion = nodes.by_ref().map(|(node, control)| (&node.state, control));
        let mut judged = self.with(&durations, |problem| problem.judge(motion));
        let mut total = T::ZERO;
        let bounds = self.durations.iter().zip(&durations).take(self.count());
        for ([low, high], duration) in bounds {
            total += *duration;
            let outside = max(*low - *duration, *duration - *high);
            judged.max_violation = max(judged.max_violation, outside);
        }
        let [low, high] = self.total;
        judged.max_violation = max(judged.max_violation, max(low - total, total - high));
        judged
    }
}

impl<
    T: Scalar,
    const N: usize,
    const FEET: usize,
    const PHASES: usize,
    const NX: usize,
    const NU: usize,
    const NI: usize,
> Ocp<T, NX, NU, NI> for FreeTiming<'_, T, N, FEET, PHASES>
{
    type State = TimedState<T, N, PHASES>;

    fn intervals(&self) -> usize {
        Problem::intervals(&self.problem)
    }

    fn dims(&self, k: usize) -> Dims {
        let mut dims = self.problem.row_dims(k);
        if k >= Problem::intervals(&self.problem) {
            dims.state_rows = dims
                .state_rows
                .saturating_add(self.count())
                .saturating_add(1);
        }
        dims
    }

    fn bounds(&self, k: usize, lower: &mut [T; NI], upper: &mut [T; NI]) {
        self.problem.row_bounds(k, lower, upper);
        if k >= Problem::intervals(&self.problem) {
            let bounds = self
                .durations
                .iter()
                .take(self.count())
                .chain([&self.total]);
            let slots = lower.iter_mut().zip(upper).skip(BASE);
            for ((lower, upper), [low, high]) in slots.zip(bounds) {
                (*lower, *upper) = (*low, *high);
            }
        }
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        (Self::TIMES..Self::TIMES.saturating_add(self.count())).contains(&i)
    }

    fn retract(
        &self,
        _: usize,
        node: &Self::State,
        step: &[T; NX],
        _: Option<(&Self::State, &[T; NU])>,
    ) -> Self::State {
        let (motion, times) = step.split_at(Self::TIMES.min(NX));
        let mut out = TimedState {
            state: self.problem.moved(&node.state, motion.iter().copied()),
            durations: node.durations,
        };
        for (duration, step) in out.durations.iter_mut().zip(times) {
            *duration += *step;
        }
        out
    }

    fn evaluate(
        &self,
        k: usize,
        node: &Self::State,
        control: &[T; NU],
        next: Option<&Self::State>,
        values: &mut Values<T, NX, NI>,
    ) {
        let after = next.map(|next| &next.state);
        self.with(&node.durations, |problem| {
            Ocp::<T, NX, NU, NI>::evaluate(problem, k, &node.state, control, after, values);
        });
        if let Some(next) = next {
            let pairs = node.durations.iter().zip(&next.durations);
            for (gap, (here, there)) in values.gap.iter_mut().skip(Self::TIMES).zip(pairs) {
                *gap = *here - *there;
            }
            return;
        }
        let durations = node.durations.iter().take(self.count()).copied();
        let total = durations
            .clone()
            .fold(T::ZERO, |sum, duration| sum + duration);
        let rows = values.rows.iter_mut().skip(BASE);
        for (row, value) in rows.zip(durations.chain([total])) {
            *row = value;
        }
    }

    fn differentiate(
        &self,
        k: usize,
        node: &Self::State,
        control: &[T; NU],
        next: Option<&Self::State>,
        at: Evaluated<'_, T, NX, NI>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let after = next.map(|next| &next.state);
        let phase = self.phase_index(k).filter(|_| next.is_some());
        let free = phase.and_then(|i| {
            let phase = self.problem.phases.get(i)?;
            Some((Self::TIMES.saturating_add(i), Self::rate(phase)))
        });
        // Columns of the other phases first: that of this one is written by what follows.
        for (i, column) in d.dynamics_x.iter_mut().enumerate().skip(Self::TIMES) {
            if let Some(slot) = column.get_mut(i) {
                *slot = if next.is_some() { T::ONE } else { T::ZERO };
            }
        }
        self.with(&node.durations, |problem| {
            problem.differentiate_with((k, &node.state, control, after), free, at, d);
        });
        if next.is_none() {
            let count = self.count();
            let rows = d.rows_x.iter_mut().skip(BASE).take(count.saturating_add(1));
            for (i, row) in rows.enumerate() {
                for (j, slot) in row.iter_mut().skip(Self::TIMES).take(count).enumerate() {
                    *slot = if i == j || i == count {
                        T::ONE
                    } else {
                        T::ZERO
                    };
                }
            }
        }
    }
}
