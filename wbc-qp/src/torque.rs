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
//!
//! # Priorities
//! A task is held ([`TorqueQp::hold`]: an equality, eliminated before the solve, so that what is left is well scaled and single
//! precision is enough) or weighed ([`TorqueQp::minimise`]). Held tasks come strictly first; the weighed solution tends to the
//! held one as its weight grows. Any number of levels: solve the first, hold its tasks at what they reached, go on with the
//! costs of the next ([`TorqueQp::next_level`]).

use dense_qp::{Constraint, Problem, Settings, Solution, Status, Workspace, resume, solve_warm};
use rbd_core::linear::{ldl_back_substitute, ldl_factor};
use rbd_core::{
    Effort, Force, JointLimits, MassMatrix, Motion, Tangent, Tree, crba, nonlinear_effects,
};
use so3::{Scalar, math};

use crate::program::Program;
use crate::{Contact, Error, Horizon, Snapshot, Task};

/// Which rows of a torque program had to yield.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Yielded {
    /// None.
    #[default]
    Nothing,
    /// Held tasks ([`TorqueQp::hold`]).
    Tasks,
    /// These, and the limits on the joints' accelerations, and so on positions and speeds.
    MotionLimits,
    /// These, and the contacts' accelerations.
    Contacts,
}

/// A torque program for N joints and K force coordinates, V = N + K variables, at most M rows: K for the contacts, four per
/// ball or ten per rectangle for their cones, N for the torques, one per row of a held task.
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
    /// Which rows are those of held tasks.
    held: [bool; M],
    /// What yields before the first search: more than nothing only after a tick that the cap ended.
    start: Yielded,
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

/// What a torque program found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueAnswer<T, const N: usize, const K: usize> {
    /// τ, N m: the command, inside its limits.
    pub torques: [T; N],
    /// ν̇.
    pub acceleration: Tangent<T, N>,
    /// Force coordinates in the order of the contacts, N and N m.
    pub forces: [T; K],
    /// Which rows had to yield.
    pub yielded: Yielded,
    /// Largest amount by which a joint's acceleration is outside its limits, rad/s².
    pub limit_violation: T,
    /// Largest amount by which the acceleration of a contact of load 1 misses, m/s² or rad/s².
    pub contact_violation: T,
    /// Iterations of all solves.
    pub iterations: u32,
    /// Whether the cap ended the search: torques are the last iterate's, cut to their ranges; accelerations and forces are those of
    /// before the cut, and may be outside of their limits.
    pub capped: bool,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize>
    TorqueQp<T, N, K, V, M>
{
    /// An empty program; iterations are capped at 200 per solve, steps not at all.
    #[must_use]
    pub fn new() -> Self {
        const { assert!(V == N + K, "a torque program has N + K variables") };
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
                max_iterations: 200,
                ..Settings::default()
            },
            contact_damping: T::of(20.0),
            contact_weight: T::of(1e5),
            task_weight: T::of(1e3),
            max_steps: u32::MAX,
            held: [false; M],
            start: Yielded::Nothing,
        }
    }

    /// Starts the program of a tick.
    ///
    /// `friction` is the torque of the joints' own friction, against the motion, as
    /// [`joint_friction`](rbd_core::joint_friction) gives it; zero where it is not known.
    ///
    /// # Errors
    /// [`Error::ForceCoordinates`] and [`Error::NoRoomForRows`].
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
        self.program.clear();
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
        self.held = [false; M];
        self.weigh_contacts();
        Ok(())
    }

    /// Contacts whose rows are no equalities, as costs: a load between 0 and 1 leads from nothing to an equality without a step.
    fn weigh_contacts(&mut self) {
        for k in 0..K {
            let load = get(&self.load, k);
            let (wanted, (low, high)) = (get(&self.wanted, k), self.program.row_limits(k));
            if load > T::ZERO && low < high {
                let share = if load < T::ONE {
                    load / (T::ONE - load)
                } else {
                    T::ONE
                };
                let row = self.program.row(k);
                self.program
                    .minimise(&row, wanted, self.contact_weight * share);
            }
        }
    }

    /// Writes a_b and τ as functions of z.
    fn eliminate<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Effort<T, N>; K],
        friction: &[T; N],
    ) {
        crba(model, &snapshot.posture, &mut self.mass);
        let bias = nonlinear_effects(model, &snapshot.posture, &snapshot.velocity);
        let locked = self.mass.base;
        let mut factors =
            [0, 1, 2, 3, 4, 5].map(|i| locked.mul(&Tangent::<T, N>::unit(i).base).to_array());
        ldl_factor(&mut factors);
        let solve = |f: Force<T>| Motion::from_array(ldl_back_substitute(&factors, f.to_array()));
        self.base_constant = solve(-bias.base);
        let columns = self.mass.coupling.iter().map(|f| -*f);
        let columns = columns.chain(contacts.iter().map(|row| row.base * self.unit));
        for (to, f) in self.base.iter_mut().zip(columns) {
            *to = solve(f);
        }
        let joints = self.effort.iter_mut().zip(&mut self.effort_constant);
        let mass = self.mass.coupling.iter().zip(&self.mass.joints);
        let known = bias.joints.iter().zip(friction);
        for (j, (((row, constant), (coupling, mass)), (h, friction))) in
            joints.zip(mass).zip(known).enumerate()
        {
            *constant = self.base_constant.dot(coupling) + *h - *friction;
            let direct = mass.iter().copied();
            let direct = direct.chain(contacts.iter().map(|c| -get(&c.joints, j) * self.unit));
            for ((x, base), direct) in row.iter_mut().zip(&self.base).zip(direct) {
                *x = base.dot(coupling) + direct;
            }
        }
    }

    /// Friction cones as rows, normal forces as bounds; a contact that is off has no force.
    fn write_cones(&mut self, contacts: &[Contact<T>]) -> Result<(), Error> {
        let mut first = N;
        for contact in contacts {
            let size = contact.size();
            let mut k = 0;
            while let Some(cone) = contact.cone(k) {
                let mut row = [T::ZERO; V];
                for (x, c) in row.iter_mut().skip(first).zip(cone).take(size) {
                    *x = c;
                }
                self.program.constrain(&row, -T::INFINITY, T::ZERO)?;
                k += 1;
            }
            if contact.is_on() {
                let most = contact.max_force * math::min(contact.load, T::ONE);
                let least = math::min(contact.min_force, most);
                let normal = first + Contact::<T>::NORMAL;
                self.program
                    .bound(normal, least / self.unit, most / self.unit);
            } else {
                for i in first..first + size {
                    self.program.bound(i, T::ZERO, T::ZERO);
                }
            }
            first += size;
        }
        Ok(())
    }

    /// A row over motions as coefficients of z and a constant.
    fn row(&self, row: &Effort<T, N>) -> ([T; V], T) {
        let mut a = [T::ZERO; V];
        let direct = row.joints.iter().copied().chain([T::ZERO; K]);
        for ((x, base), direct) in a.iter_mut().zip(&self.base).zip(direct) {
            *x = direct + base.dot(&row.base);
        }
        (a, self.base_constant.dot(&row.base))
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
        let rows = task.jacobian.iter().zip(target.iter().zip(&task.drift));
        for (row, (x, drift)) in rows {
            let (a, constant) = self.row(row);
            let wanted = *x - *drift - constant;
            let index = self.program.constrain(&a, wanted, wanted)?;
            if let Some(held) = self.held.get_mut(index) {
                *held = true;
            }
        }
        Ok(())
    }

    /// Ends a level of strict priority: costs go, limits and held tasks stay. Between [`TorqueQp::solve`] and this call, hold
    /// the level's tasks at what the answer [reached](Task::reached); the costs of the next level follow. Every level wants a
    /// little cost on joints and forces, so that its Hessian is definite.
    pub fn next_level(&mut self) {
        self.program.clear_costs();
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

    /// Solves the program, letting rows yield in the order of [`Yielded`] where it must.
    ///
    /// # Errors
    /// [`Error::Data`] for numbers that are not finite; [`Error::Unsolved`] if 200 iterations or round-off ended even the
    /// last search.
    pub fn solve(&mut self) -> Result<TorqueAnswer<T, N, K>, Error> {
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
                next_relaxation::<T, N, V, M>(yielded, &self.held, &solution)
            };
            match next {
                None if at_cap => return Ok(self.cut(&z, yielded, iterations)),
                None => {
                    self.workspace.forget();
                    return Err(Error::Unsolved(status));
                }
                Some(next) => {
                    // Bounds alone leave the factors as they are.
                    let same = next == Yielded::MotionLimits && status == Status::Infeasible;
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
            Yielded::Tasks => {
                for i in 0..M {
                    if self.held.get(i) == Some(&true) {
                        self.soften(i, self.task_weight);
                    }
                }
            }
            Yielded::MotionLimits => {
                for i in 0..N {
                    self.program.bound(i, -T::INFINITY, T::INFINITY);
                }
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

    /// Makes an equality row a cost.
    fn soften(&mut self, i: usize, weight: T) {
        let (row, (wanted, _)) = (self.program.row(i), self.program.row_limits(i));
        self.program.limit_row(i, -T::INFINITY, T::INFINITY);
        self.program.minimise(&row, wanted, weight);
    }

    fn answer(&self, z: &[T; V], yielded: Yielded, iterations: u32) -> TorqueAnswer<T, N, K> {
        let mut answer = TorqueAnswer {
            torques: self.effort_constant,
            acceleration: Tangent {
                base: self.base_constant,
                joints: [T::ZERO; N],
            },
            forces: [T::ZERO; K],
            yielded,
            limit_violation: T::ZERO,
            contact_violation: T::ZERO,
            iterations,
            capped: false,
        };
        for (tau, row) in answer.torques.iter_mut().zip(&self.effort) {
            *tau += dot(row, z);
        }
        for (base, x) in self.base.iter().zip(z) {
            answer.acceleration.base += *base * *x;
        }
        for (to, x) in answer.acceleration.joints.iter_mut().zip(z) {
            *to = *x;
        }
        for (to, x) in answer.forces.iter_mut().zip(z.iter().skip(N)) {
            *to = *x * self.unit;
        }
        for (x, [low, high]) in z.iter().zip(&self.range) {
            let outside = math::max(*low - *x, *x - *high);
            answer.limit_violation = math::max(answer.limit_violation, outside);
        }
        for (k, (wanted, load)) in self.wanted.iter().zip(&self.load).enumerate() {
            if *load >= T::ONE {
                let miss = math::abs(dot(&self.program.row(k), z) - *wanted);
                answer.contact_violation = math::max(answer.contact_violation, miss);
            }
        }
        answer
    }
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const M: usize> Default
    for TorqueQp<T, N, K, V, M>
{
    fn default() -> Self {
        Self::new()
    }
}

/// What has to yield after a program: the first rows of which its proof of infeasibility contains one.
fn next_relaxation<T: Scalar, const N: usize, const V: usize, const M: usize>(
    yielded: Yielded,
    held: &[bool; M],
    solution: &Solution<'_, T, V, M>,
) -> Option<Yielded> {
    let unproven = solution.status != Status::Infeasible;
    let next = [Yielded::Tasks, Yielded::MotionLimits, Yielded::Contacts];
    next.into_iter().find(|next| {
        let mut conflict = solution.conflict().map(|(constraint, _)| constraint);
        *next > yielded
            && match next {
                Yielded::Nothing => false,
                Yielded::Tasks if unproven => held.contains(&true),
                Yielded::Tasks => {
                    conflict.any(|c| matches!(c, Constraint::Row(i) if held.get(i) == Some(&true)))
                }
                Yielded::MotionLimits => {
                    unproven || conflict.any(|c| matches!(c, Constraint::Bound(i) if i < N))
                }
                Yielded::Contacts => true,
            }
    })
}

fn get<T: Scalar>(xs: &[T], i: usize) -> T {
    xs.get(i).copied().unwrap_or(T::ZERO)
}

fn dot<T: Scalar, const V: usize>(a: &[T; V], b: &[T; V]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (x, y)| sum + *x * *y)
}
