//! The program at the level of torques: the unknowns are joint accelerations and contact forces.
//!
//! The equations of motion M ν̇ + h = S τ + τ_fric + Jᵀ f leave no choice for the base and the torques, so neither is a variable:
//! with z = (q̈, f), the base rows give
//!
//! a_b = M_bb⁻¹ (J_bᵀ f − h_b − M_bj q̈),
//!
//! always, since M_bb is the inertia of the whole robot; and the joint rows give τ = M_jb a_b + M_jj q̈ + h_j − J_jᵀ f − τ_fric.
//! Contacts are equalities J ν̇ + J̇ν = −k J ν, which the solver eliminates first. Friction cones and torques are rows,
//! joint limits and normal forces bounds. Forces are counted in tenths of the robot's weight.
//!
//! # Priorities
//! A task is held ([`TorqueQp::hold`]: an equality, eliminated before the solve, so that what is left is well scaled and single
//! precision is enough) or weighed ([`TorqueQp::minimise`]). Held tasks come strictly first; the weighed solution tends to the
//! held one as its weight grows. Any number of levels: solve the first, hold its tasks at what they reached, go on with the
//! costs of the next ([`TorqueQp::next_level`]).
//!
//! What yields where all this is impossible, and how long it may take, is in `relaxation`.

mod answer;
mod contacts;
mod elimination;
mod relaxation;
mod report;

pub use answer::TorqueAnswer;
pub use relaxation::Yielded;

use dense_qp::{Settings, Workspace};
use rbd_core::{Effort, JointLimits, MassMatrix, Motion, Tree};
use so3::Scalar;

use crate::program::Program;
use crate::rows::{Rank, Rows};
use crate::{Contact, Error, Horizon, Snapshot, Task};

/// A torque program for N joints and K force coordinates, V = N + K variables and one more per row with slack, at most M rows: K for the
/// contacts, four per ball, ten per rectangle or six and one per vertex of a polygon for their cones, N for the torques, one per row of the user.
///
/// The base may be floating or fixed. A fixed one carries what it must: its reaction is in no answer, and K may be 0.
#[derive(Clone, Debug)]
pub struct TorqueQp<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize> {
    program: Program<T, V, M>,
    workspace: Workspace<T, V, M>,
    mass: MassMatrix<T, N>,
    /// a_b at z = 0, and per variable.
    base_constant: Motion<T>,
    base: [Motion<T>; V],
    /// τ at z = 0, and per variable.
    effort_constant: [T; N],
    effort: [[T; V]; N],
    /// Contact rows: coefficients of z, and the value wanted.
    wanted: [T; K],
    /// How much of each row's contact there is, 0 to 1.
    load: [T; K],
    /// Bounds on q̈.
    range: [[T; 2]; N],
    /// Bounds on τ.
    torque_range: [[T; 2]; N],
    /// One force coordinate, N or N m.
    unit: T,
    /// Tolerances and iteration cap of the solver.
    pub settings: Settings<T>,
    /// k: rate at which a contact's own velocity is damped, 1/s.
    pub contact_damping: T,
    /// Weight of a contact row that has yielded; one of a contact with a load below 1 weighs load/(1 − load) times it.
    pub contact_weight: T,
    /// Weight of a held task's row that has yielded.
    pub task_weight: T,
    /// Most steps of all searches of a tick together, as [`Settings::max_steps`] counts them; one of the last relaxation, in which the
    /// contacts' rows are no longer eliminated, counts twice, and so do ten for its factorisation.
    pub max_steps: u32,
    /// What the rows are.
    rows: Rows<T, M>,
    /// Row of the first torque, once torques are limited.
    first_torque: Option<usize>,
    /// What yields before the first search: more than nothing only after a tick that the cap ended.
    start: Yielded,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// An empty program; iterations are capped at 1000 per search, steps not at all.
    #[must_use]
    pub fn new() -> Self {
        const {
            assert!(
                V >= N + K,
                "a torque program has N + K variables, and one per slack"
            )
        };
        const { assert!(M >= K + N, "contact rows and torque rows alone are K + N") };
        Self {
            program: Program::new(),
            workspace: Workspace::new(),
            mass: MassMatrix::ZERO,
            base_constant: Motion::ZERO,
            base: [Motion::ZERO; V],
            effort_constant: [T::ZERO; N],
            effort: [[T::ZERO; V]; N],
            wanted: [T::ZERO; K],
            load: [T::ZERO; K],
            range: [[T::NEG_INFINITY, T::INFINITY]; N],
            torque_range: [[T::NEG_INFINITY, T::INFINITY]; N],
            unit: T::ONE,
            settings: Settings {
                max_iterations: 1000,
                ..Settings::default()
            },
            contact_damping: T::of(20.0),
            contact_weight: T::of(1e5),
            task_weight: T::of(1e3),
            max_steps: u32::MAX,
            rows: Rows::new(),
            first_torque: None,
            start: Yielded::Nothing,
        }
    }

    /// Starts the program of a tick.
    ///
    /// `friction` is the torque of the joints' own friction, against the motion, as
    /// [`joint_friction`](rbd_core::joint_friction) gives it; zero where it is not known.
    ///
    /// # Errors
    /// [`Error::ForceCoordinates`], [`Error::NormalForces`] and [`Error::NoRoomForRows`].
    pub fn begin<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Contact<T>],
        friction: &[T; N],
    ) -> Result<(), Error> {
        let needed = contacts.iter().map(Contact::size).sum();
        if needed != K {
            return Err(Error::ForceCoordinates { needed });
        }
        // No order is also that of a NaN.
        let is_ordered = |c: &Contact<T>| c.min_force <= c.max_force;
        if let Some(contact) = contacts.iter().position(|c| !is_ordered(c)) {
            return Err(Error::NormalForces { contact });
        }
        self.program.clear();
        self.rows.clear();
        self.first_torque = None;
        self.range = [[T::NEG_INFINITY, T::INFINITY]; N];
        self.torque_range = self.range;
        self.unit = snapshot.centroidal.mass * T::of(0.981);
        let mut rows = [Effort::ZERO; K];
        let mut slots = rows.iter_mut().zip(&mut self.wanted).zip(&mut self.load);
        for contact in contacts {
            let (jacobian, drift, rate) = contact.motion(model, snapshot);
            let motion = jacobian.iter().zip(drift.iter().zip(&rate));
            for ((row, (drift, rate)), ((to, wanted), load)) in
                motion.zip(&mut slots).take(contact.size())
            {
                *to = *row;
                *wanted = -*drift - self.contact_damping * *rate;
                *load = if contact.is_whole() {
                    T::ONE
                } else {
                    contact.load
                };
            }
        }
        self.eliminate(model, snapshot, &rows, friction);
        for (k, row) in rows.iter().enumerate() {
            let (a, constant) = self.row(row);
            let (x, load) = (get(&self.wanted, k) - constant, get(&self.load, k));
            if let Some(wanted) = self.wanted.get_mut(k) {
                *wanted = x;
            }
            let free = [-T::INFINITY, T::INFINITY];
            let [low, high] = if load >= T::ONE { [x, x] } else { free };
            self.program.constrain(&a, low, high)?;
        }
        self.write_cones(contacts)?;
        for i in N + K..V {
            self.program.bound(i, T::ZERO, T::ZERO);
        }
        self.weigh_contacts();
        Ok(())
    }

    /// Holds a task: ẍ = ẍ* comes before every cost.
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

    /// Keeps a task in a range: l ≤ ẍ ≤ u row by row. Equal limits make an equality, infinite ones leave a row out.
    ///
    /// Where such rows have to give way, equalities become costs of [`TorqueQp::task_weight`], ranges go, and those with slack have
    /// from the start the cost that they are given.
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
        let rows = task
            .jacobian
            .iter()
            .zip(lower.iter().zip(upper).zip(&task.drift));
        for (row, ((low, high), drift)) in rows {
            let (mut a, constant) = self.row(row);
            let known = *drift + constant;
            let limits = [*low - known, *high - known];
            self.rows
                .add(&mut self.program, N + K, &mut a, limits, rank)?;
        }
        Ok(())
    }

    /// Keeps a combination of the contacts' forces in a range: l ≤ cᵀf ≤ u, over the force coordinates in the order of the contacts.
    ///
    /// # Errors
    /// As [`TorqueQp::constrain`], of one row.
    pub fn constrain_forces(
        &mut self,
        coefficients: &[T; K],
        [lower, upper]: [T; 2],
        rank: Rank<T>,
    ) -> Result<(), Error> {
        let mut a = [T::ZERO; V];
        for (to, c) in a.iter_mut().skip(N).zip(coefficients) {
            *to = *c * self.unit;
        }
        self.rows
            .add(&mut self.program, N + K, &mut a, [lower, upper], rank)
    }

    /// Ends a level of strict priority: costs go, limits and held tasks stay. Between [`TorqueQp::solve`] and this call, hold
    /// the level's tasks at what the answer [reached](Task::reached); the costs of the next level follow. Every level wants a
    /// little cost on joints and forces, so that its Hessian is definite.
    pub fn next_level(&mut self) {
        self.program.next_level(N + K);
        self.weigh_contacts();
    }

    /// Adds ½ Σ wᵢ (ẍᵢ − ẍᵢ*)².
    pub fn minimise<const R: usize>(
        &mut self,
        task: &Task<T, N, R>,
        target: &[T; R],
        weights: &[T; R],
    ) {
        let rows = task.jacobian.each_ref().map(|row| self.row(row));
        let wanted = target.iter().zip(&task.drift).zip(weights);
        let rows = rows.iter().zip(wanted);
        self.program.minimise_rows(
            rows.map(|((a, constant), ((x, drift), w))| (a, *x - *drift - *constant, *w)),
        );
    }

    /// Adds ½ Σ wᵢ (q̈ᵢ − q̈ᵢ*)²: the posture term of paper B eq. (6a).
    pub fn minimise_joints(&mut self, target: &[T; N], weights: &[T; N]) {
        for (i, (x, w)) in target.iter().zip(weights).enumerate() {
            self.program.minimise_variable(i, *x, *w);
        }
    }

    /// Adds ½ Σ wᵢ (τᵢ − τᵢ*)²: the continuity term of paper B eq. (6a) when τ* is the last tick's.
    pub fn minimise_torques(&mut self, target: &[T; N], weights: &[T; N]) {
        let rows = self.effort.iter().zip(&self.effort_constant);
        let rows = rows.zip(target.iter().zip(weights));
        self.program
            .minimise_rows(rows.map(|((a, constant), (x, w))| (a, *x - *constant, *w)));
    }

    /// Adds ½ Σ wᵢ (fᵢ − fᵢ*)² over the force coordinates, weights per N² and (N m)².
    pub fn minimise_forces(&mut self, target: &[T; K], weights: &[T; K]) {
        let unit = self.unit;
        for (i, (f, w)) in target.iter().zip(weights).enumerate() {
            self.program
                .minimise_variable(N + i, *f / unit, *w * unit * unit);
        }
    }

    /// Keeps torques inside these ranges, paper B eq. (6e); each must contain zero.
    ///
    /// # Errors
    /// [`Error::NoRoomForRows`].
    pub fn limit_torques(&mut self, ranges: &[[T; 2]; N]) -> Result<(), Error> {
        self.torque_range = *ranges;
        let rows = self.effort.iter().zip(&self.effort_constant);
        self.first_torque = Some(self.program.used());
        for ((row, constant), [low, high]) in rows.zip(ranges) {
            self.program
                .constrain(row, *low - *constant, *high - *constant)?;
        }
        Ok(())
    }

    /// Keeps joints inside their ranges of position and speed, paper B eq. (6e).
    pub fn limit_joints(
        &mut self,
        snapshot: &Snapshot<T, N>,
        limits: &[JointLimits<T>; N],
        horizon: &Horizon<T>,
    ) {
        let state = snapshot
            .configuration
            .joints
            .iter()
            .zip(&snapshot.velocity.joints);
        let joints = self.range.iter_mut().zip(limits.iter().zip(state));
        for (i, (range, (limits, (q, qd)))) in joints.enumerate() {
            *range = horizon.acceleration_range(limits, *q, *qd);
            let [low, high] = *range;
            self.program.bound(i, low, high);
        }
    }

    /// The program as it stands, over z = (q̈, f / unit): for a log, or another solver's opinion.
    #[must_use]
    pub fn problem(&self) -> dense_qp::Problem<'_, T, V, M> {
        self.program.problem()
    }
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize> Default
    for TorqueQp<T, N, K, V, M>
{
    fn default() -> Self {
        Self::new()
    }
}

fn get<T: Scalar>(xs: &[T], i: usize) -> T {
    xs.get(i).copied().unwrap_or(T::ZERO)
}
