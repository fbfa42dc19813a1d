//! What yields where everything together is impossible, and the search that finds it out.
//!
//! # What yields
//! Limits on torque and friction never do: a command is safe and possible. Where everything together is impossible, first the
//! held tasks become costs of a stated weight, then the limits on acceleration go (positions and speeds of joints), then the
//! contacts become costs as well. The last program always has a solution: no force, no torque, free fall. The answer says which
//! one it comes from and by how much the rows that yielded were missed.
//!
//! # Time
//! A program that is impossible is only known to be so after a search, and up to three more follow. [`TorqueQp::max_steps`] caps all
//! searches of a tick together, so that a tick has a longest time. What the cap ends is a command all the same: the last
//! iterate's torques, cut to their ranges; the answer says so ([`TorqueAnswer::capped`]), and the next tick begins where this one
//! ended, with the rows that had yielded and the active set. It begins with the whole program again once nothing that yielded
//! is missed. Rows yield without another factorisation where that is possible, and those are passed over that the proof of
//! infeasibility does not contain, since without them it is a proof as well.

use dense_qp::{Constraint, Problem, Settings, Solution, Status, Workspace, resume, solve_warm};
use so3::{Scalar, math};

use super::{TorqueAnswer, TorqueQp, get};
use crate::Error;
use crate::rows::{Kind, Rows};

/// Which rows of a program had to yield.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Yielded {
    /// None.
    #[default]
    Nothing,
    /// Held tasks ([`TorqueQp::hold`]) and other rows of [`Rank::Task`](crate::Rank::Task).
    Tasks,
    /// These, and the limits on the joints' accelerations, and so on positions and speeds, and rows of
    /// [`Rank::Limit`](crate::Rank::Limit).
    MotionLimits,
    /// These, and the contacts' accelerations; of a velocity program their feedback.
    Contacts,
}

/// Steps that another factorisation costs: elimination, the reduced Hessian and its factor.
const REFACTORISATION: u32 = 10;

/// Misses of what had yielded, m/s² and rad/s², below which the whole program is tried again after a tick at the cap.
const KEPT: f64 = 0.1;

/// How a search begins.
type Solver<T, const V: usize, const M: usize> =
    for<'p, 'w> fn(
        &Problem<'p, T, V, M>,
        &Settings<T>,
        &'w mut Workspace<T, V, M>,
    ) -> Result<Solution<'w, T, V, M>, dense_qp::Error>;

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// Solves the program, letting rows yield in the order of [`Yielded`] where it must.
    ///
    /// # Errors
    /// [`Error::Data`] for numbers that are not finite; [`Error::Unsolved`] if 1000 iterations or round-off ended even the
    /// last search.
    pub fn solve(&mut self) -> Result<TorqueAnswer<T, N, K>, Error> {
        self.program.finish();
        let (mut iterations, mut left) = (0, self.max_steps);
        let mut yielded = self.start;
        for before in [Yielded::Tasks, Yielded::MotionLimits, Yielded::Contacts] {
            if before <= yielded {
                self.relax(before);
            }
        }
        let mut solver: Solver<T, V, M> = solve_warm;
        loop {
            let price = if yielded == Yielded::Contacts { 2 } else { 1 };
            self.settings.max_steps = left / price;
            let solution = solver(&self.program.problem(), &self.settings, &mut self.workspace)
                .map_err(Error::Data)?;
            iterations += solution.iterations;
            left = left.saturating_sub(solution.steps.saturating_mul(price));
            let (z, status) = (*solution.x, solution.status);
            if status == Status::Solved {
                let answer = self.answer(&z, yielded, iterations);
                let missed = math::max(answer.limit_violation, answer.contact_violation);
                if missed < T::of(KEPT) {
                    self.start = Yielded::Nothing;
                }
                return Ok(answer);
            }
            let at_cap = status == Status::Limit && left < price;
            let next = if at_cap {
                None
            } else {
                next_relaxation::<T, N, V, M>(yielded, &self.rows, &solution)
            };
            match next {
                None if at_cap => return Ok(self.cut(&z, yielded, iterations)),
                None => {
                    self.workspace.forget();
                    return Err(Error::Unsolved(status));
                }
                Some(next) => {
                    // Bounds alone leave the factors as they are.
                    let same = next == Yielded::MotionLimits
                        && status == Status::Infeasible
                        && !self.rows.has(Kind::Limit);
                    solver = if same { resume } else { solve_warm };
                    if !same {
                        self.workspace.forget();
                        left = left.saturating_sub(2 * REFACTORISATION);
                    }
                    self.relax(next);
                    yielded = next;
                    if left == 0 {
                        return Ok(self.cut(&z, yielded, iterations));
                    }
                }
            }
        }
    }

    /// Lets rows yield that have not yet.
    fn relax(&mut self, next: Yielded) {
        match next {
            Yielded::Nothing => {}
            Yielded::Tasks => self.give_way(Kind::Task),
            Yielded::MotionLimits => {
                for i in 0..N {
                    self.program.bound(i, -T::INFINITY, T::INFINITY);
                }
                self.give_way(Kind::Limit);
            }
            Yielded::Contacts => {
                for k in 0..K {
                    if get(&self.load, k) >= T::ONE {
                        self.soften(k, self.contact_weight);
                    }
                }
            }
        }
    }

    /// The command of a search that the cap ended; the next tick begins here.
    fn cut(&mut self, z: &[T; V], yielded: Yielded, iterations: u32) -> TorqueAnswer<T, N, K> {
        self.start = yielded;
        let mut answer = self.answer(z, yielded, iterations);
        answer.capped = true;
        for (tau, [low, high]) in answer.torques.iter_mut().zip(&self.torque_range) {
            let finite = if tau.is_finite_number() {
                *tau
            } else {
                T::ZERO
            };
            *tau = math::clamp(finite, *low, *high);
        }
        answer
    }

    /// Rows of the user of this kind: equalities become costs, ranges go.
    fn give_way(&mut self, kind: Kind) {
        if !self.rows.has(kind) {
            return;
        }
        for i in 0..M {
            if self.rows.kind(i) != kind {
                continue;
            }
            let (low, high) = self.program.row_limits(i);
            if low < high {
                self.program.limit_row(i, -T::INFINITY, T::INFINITY);
            } else {
                self.soften(i, self.task_weight);
            }
        }
    }

    /// Makes an equality row a cost.
    fn soften(&mut self, i: usize, weight: T) {
        let (row, (wanted, _)) = (self.program.row(i), self.program.row_limits(i));
        self.program.limit_row(i, -T::INFINITY, T::INFINITY);
        self.program.minimise(&row, wanted, weight);
    }
}

/// What has to yield after a program: the first rows of which its proof of infeasibility contains one.
fn next_relaxation<T: Scalar, const N: usize, const V: usize, const M: usize>(
    yielded: Yielded,
    rows: &Rows<T, M>,
    solution: &Solution<'_, T, V, M>,
) -> Option<Yielded> {
    let unproven = solution.status != Status::Infeasible;
    let next = [Yielded::Tasks, Yielded::MotionLimits, Yielded::Contacts];
    next.into_iter().find(|next| {
        let mut conflict = solution.conflict().map(|(constraint, _)| constraint);
        *next > yielded
            && match next {
                Yielded::Nothing => false,
                Yielded::Tasks => rows.must_yield(Kind::Task, solution),
                Yielded::MotionLimits => {
                    unproven
                        || conflict.any(|c| match c {
                            Constraint::Bound(i) => i < N,
                            Constraint::Row(i) => {
                                rows.has(Kind::Limit) && rows.kind(i) == Kind::Limit
                            }
                        })
                }
                Yielded::Contacts => true,
            }
    })
}
