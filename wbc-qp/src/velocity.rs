//! The program at the level of velocities: the unknown is the generalised velocity.
//!
//! The variables are z = (q̇, v_b): joint velocities and the base's velocity in base axes. Contacts are equalities J ν = 0,
//! which the solver eliminates first, and with them the base. Joint limits are bounds. Since ν = 0 keeps every contact and
//! every bound ([`Horizon::velocity_range`]), the program is never infeasible: tasks are costs, and what they cannot have
//! is their residual.
//!
//! # What yields
//! Rows of the user and feedback of contacts may contradict each other, bounds and contacts. Then they give way in the order of
//! [`Yielded`]: equalities become costs, ranges are widened until they allow rest, feedback of contacts goes last. What is left
//! is kept by standing still.

use dense_qp::{Constraint, Settings, Solution, Status, Workspace, solve_warm};
use rbd_core::{BaseKind, Effort, JointLimits, Motion, Tangent, Tree};
use so3::{Scalar, math};

use crate::program::{Program, dot};
use crate::rows::{Extent, Kind, Limit, Limited, Rank, Rows, missed, outside};
use crate::{Contact, Error, Horizon, Snapshot, Task, Yielded};

/// A velocity program for N joints with V = N + 6 variables, and one more per row with slack, and at most M rows: three per ball, six
/// per other contact, one per row of the user. The base may be floating or fixed; a fixed one has no velocity.
#[derive(Clone, Debug)]
pub struct VelocityQp<T, const N: usize, const V: usize, const M: usize> {
    program: Program<T, V, M>,
    workspace: Workspace<T, V, M>,
    rows: Rows<T, M>,
    /// Rows of the contacts.
    contact_rows: usize,
    /// Weight of a row of the user that was an equality and has yielded.
    pub task_weight: T,
    /// Tolerances and iteration cap of the solver.
    pub settings: Settings<T>,
}

/// The velocities found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityAnswer<T, const N: usize> {
    /// ν: the joints are the command.
    pub velocity: Tangent<T, N>,
    /// Iterations of the solver.
    pub iterations: u32,
    /// Which rows of the user had to yield.
    pub yielded: Yielded,
}

impl<T: Scalar, const N: usize, const V: usize, const M: usize> VelocityQp<T, N, V, M> {
    /// An empty program; iterations are capped at 200.
    #[must_use]
    pub fn new() -> Self {
        const {
            assert!(
                V >= N + 6,
                "a velocity program has N + 6 variables, and one per slack"
            )
        };
        Self {
            program: Program::new(),
            workspace: Workspace::new(),
            rows: Rows::new(),
            contact_rows: 0,
            task_weight: T::of(1e3),
            settings: Settings {
                max_iterations: 200,
                ..Settings::default()
            },
        }
    }

    /// Starts the program of a tick: these contacts hold, those that are off are not there.
    ///
    /// # Errors
    /// [`Error::NoRoomForRows`].
    pub fn begin<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Contact<T>],
    ) -> Result<(), Error> {
        self.program.clear();
        self.rows.clear();
        self.contact_rows = 0;
        let fixed = model.base_kind() == BaseKind::Fixed;
        for i in (if fixed { N } else { N + 6 })..V {
            self.program.bound(i, T::ZERO, T::ZERO);
        }
        for contact in contacts {
            self.rows.mark_contact(self.contact_rows);
            self.contact_rows += contact.size();
            let (rows, _, _) = contact.motion(model, snapshot);
            // Rows of an absent contact stay in their place, so that the solver's memory fits the next tick.
            let limit = if contact.is_on() {
                T::ZERO
            } else {
                T::INFINITY
            };
            for row in rows.iter().take(contact.size()) {
                let i = self.program.constrain(&flat(row), -limit, limit)?;
                if let Some(asked) = self.rows.asked.get_mut(i) {
                    *asked = [-limit, limit];
                }
            }
        }
        Ok(())
    }

    /// Velocities that contacts shall have in the axes of their rows: feedback on where they are, a rate times [`Contact::error`].
    /// One after the other in the order of the contacts; called after [`VelocityQp::begin`].
    pub fn correct_contacts(&mut self, velocities: &[T]) {
        for (k, x) in velocities.iter().enumerate().take(self.contact_rows) {
            let (low, high) = self.program.row_limits(k);
            if low < high {
                continue; // A contact that is off.
            }
            self.program.limit_row(k, *x, *x);
            if let Some(asked) = self.rows.asked.get_mut(k) {
                *asked = [*x, *x];
            }
        }
    }

    /// Holds a task: ẋ = ẋ* comes before every cost.
    ///
    /// # Errors
    /// [`Error::NoRoomForRows`]: a held task takes R rows.
    pub fn hold<const R: usize>(
        &mut self,
        task: &Task<T, N, R>,
        target: &[T; R],
    ) -> Result<(), Error> {
        self.constrain(task, target, target, Rank::Task)
    }

    /// Keeps a task in a range: l ≤ ẋ ≤ u row by row. Equal limits make an equality, infinite ones leave a row out.
    ///
    /// # Errors
    /// [`Error::NoRoomForRows`]: R rows. [`Error::NoRoomForSlack`]: with slack, R variables.
    pub fn constrain<const R: usize>(
        &mut self,
        task: &Task<T, N, R>,
        lower: &[T; R],
        upper: &[T; R],
        rank: Rank<T>,
    ) -> Result<(), Error> {
        for (row, (low, high)) in task.jacobian.iter().zip(lower.iter().zip(upper)) {
            let (mut a, limits) = (flat(row), [*low, *high]);
            self.rows
                .add(&mut self.program, N + 6, &mut a, limits, rank)?;
        }
        Ok(())
    }

    /// Ends a level of strict priority, as [`TorqueQp::next_level`](crate::TorqueQp::next_level): costs go, limits and rows stay.
    pub fn next_level(&mut self) {
        self.program.next_level(N + 6);
    }

    /// Adds ½ Σ wᵢ (ẋᵢ − ẋᵢ*)².
    pub fn minimise<const R: usize>(
        &mut self,
        task: &Task<T, N, R>,
        target: &[T; R],
        weights: &[T; R],
    ) {
        let rows = task.jacobian.each_ref().map(flat);
        let rows = rows.iter().zip(target.iter().zip(weights));
        self.program
            .minimise_rows(rows.map(|(a, (x, w))| (a, *x, *w)));
    }

    /// Adds ½ Σ wᵢ (q̇ᵢ − q̇ᵢ*)²: the posture and continuity terms of paper B eq. (3a).
    pub fn minimise_joints(&mut self, target: &[T; N], weights: &[T; N]) {
        for (i, (x, w)) in target.iter().zip(weights).enumerate() {
            self.program.minimise_variable(i, *x, *w);
        }
    }

    /// Bounds the joints by their limits, paper B eq. (3e).
    pub fn limit_joints(
        &mut self,
        snapshot: &Snapshot<T, N>,
        limits: &[JointLimits<T>; N],
        horizon: &Horizon<T>,
    ) {
        let joints = limits.iter().zip(&snapshot.configuration.joints);
        for (i, (limits, q)) in joints.enumerate() {
            let [low, high] = horizon.velocity_range(limits, *q);
            self.program.bound(i, low, high);
        }
    }

    /// The program as it stands, over z = (q̇, v_b): for a log, or another solver's opinion.
    #[must_use]
    pub fn problem(&self) -> dense_qp::Problem<'_, T, V, M> {
        self.program.problem()
    }

    /// Solves the program, letting rows of the user yield in the order of [`Yielded`] where it must: up to three more searches.
    ///
    /// # Errors
    /// [`Error::Data`] for numbers that are not finite; [`Error::Unsolved`] if the iteration cap or round-off ended the
    /// search. The safe command is then zero velocity.
    pub fn solve(&mut self) -> Result<VelocityAnswer<T, N>, Error> {
        self.program.finish();
        let (mut yielded, mut iterations) = (Yielded::Nothing, 0);
        loop {
            let solution = solve_warm(&self.program.problem(), &self.settings, &mut self.workspace)
                .map_err(Error::Data)?;
            iterations += solution.iterations;
            if solution.status == Status::Solved {
                return Ok(answer(solution.x, iterations, yielded));
            }
            let status = solution.status;
            let corrected = self.contact_rows > 0;
            let Some(next) = next_relaxation(yielded, &self.rows, corrected, &solution) else {
                return Err(Error::Unsolved(status));
            };
            self.relax(next);
            self.workspace.forget();
            yielded = next;
        }
    }

    /// Lets rows yield.
    fn relax(&mut self, next: Yielded) {
        let kind = match next {
            Yielded::Nothing => return,
            Yielded::Tasks => Kind::Task,
            Yielded::MotionLimits => Kind::Limit,
            Yielded::Contacts => {
                for k in 0..self.contact_rows {
                    let (low, high) = self.program.row_limits(k);
                    if low >= high {
                        self.program.limit_row(k, T::ZERO, T::ZERO);
                    }
                }
                return;
            }
        };
        for i in 0..M {
            if self.rows.kind(i) != kind {
                continue;
            }
            let (low, high) = self.program.row_limits(i);
            if low < high {
                self.program
                    .limit_row(i, math::min(low, T::ZERO), math::max(high, T::ZERO));
            } else {
                let row = self.program.row(i);
                self.program.limit_row(i, -T::INFINITY, T::INFINITY);
                self.program.minimise(&row, low, self.task_weight);
            }
        }
    }

    /// What limited the answer of the last [`VelocityQp::solve`], as [`TorqueQp::report`](crate::TorqueQp::report) tells it.
    pub fn report<'a>(
        &'a self,
        answer: &VelocityAnswer<T, N>,
        least: T,
    ) -> impl Iterator<Item = Limited<T>> + 'a {
        let z: [T; V] = variables(&answer.velocity);
        let held = self.workspace.active().filter_map(|(constraint, side)| {
            let limit = match constraint {
                // Only joints have bounds: the base and slack are free or fixed.
                Constraint::Bound(i) => Limit::Motion(i),
                Constraint::Row(i) => self.rows.number(i).map(Limit::Row)?,
            };
            let extent = Extent::Held(side);
            Some(Limited { limit, extent })
        });
        let corrected = answer.yielded == Yielded::Contacts;
        let contacts = (0..if corrected { self.contact_rows } else { 0 }).filter_map(move |k| {
            let asked = self.rows.asked.get(k)?;
            let by = outside(dot(&self.program.row(k), &z), *asked);
            missed(Limit::Contact(self.rows.contact_of(k)), by, least)
        });
        let users = self
            .rows
            .of_the_user()
            .filter_map(move |(i, number, asked)| {
                let by = outside(dot(&self.program.row(i), &z), asked);
                missed(Limit::Row(number), by, least)
            });
        held.chain(contacts).chain(users)
    }
}

/// What has to yield next, if anything may that has not yet.
fn next_relaxation<T: Scalar, const V: usize, const M: usize>(
    yielded: Yielded,
    rows: &Rows<T, M>,
    corrected: bool,
    solution: &Solution<'_, T, V, M>,
) -> Option<Yielded> {
    let stages = [
        (Yielded::Tasks, rows.must_yield(Kind::Task, solution)),
        (
            Yielded::MotionLimits,
            rows.must_yield(Kind::Limit, solution),
        ),
        (Yielded::Contacts, corrected),
    ];
    let mut stages = stages.into_iter();
    stages.find_map(|(stage, must)| (stage > yielded && must).then_some(stage))
}

/// The solver's variables as an answer.
fn answer<T: Scalar, const N: usize, const V: usize>(
    z: &[T; V],
    iterations: u32,
    yielded: Yielded,
) -> VelocityAnswer<T, N> {
    let mut answer = VelocityAnswer {
        velocity: Tangent::ZERO,
        iterations,
        yielded,
    };
    let mut z = z.iter();
    for (qd, x) in answer.velocity.joints.iter_mut().zip(&mut z) {
        *qd = *x;
    }
    let mut base = [T::ZERO; 6];
    for (to, x) in base.iter_mut().zip(z) {
        *to = *x;
    }
    answer.velocity.base = Motion::from_array(base);
    answer
}

impl<T: Scalar, const N: usize, const V: usize, const M: usize> Default for VelocityQp<T, N, V, M> {
    fn default() -> Self {
        Self::new()
    }
}

/// A row over motions in the order of the variables: joints, then base; no slack.
fn flat<T: Scalar, const N: usize, const V: usize>(row: &Effort<T, N>) -> [T; V] {
    in_order(&row.joints, row.base.to_array())
}

/// A velocity likewise.
fn variables<T: Scalar, const N: usize, const V: usize>(velocity: &Tangent<T, N>) -> [T; V] {
    in_order(&velocity.joints, velocity.base.to_array())
}

fn in_order<T: Scalar, const N: usize, const V: usize>(joints: &[T; N], base: [T; 6]) -> [T; V] {
    let mut out = [T::ZERO; V];
    for (to, x) in out.iter_mut().zip(joints.iter().copied().chain(base)) {
        *to = x;
    }
    out
}
