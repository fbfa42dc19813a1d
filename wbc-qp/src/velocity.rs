//! The program at the level of velocities: the unknown is the generalised velocity.
//!
//! The variables are z = (q̇, v_b): joint velocities and the base's velocity in base axes. Contacts are equalities J ν = 0,
//! which the solver eliminates first, and with them the base. Joint limits are bounds. Since ν = 0 keeps every contact and
//! every bound ([`Horizon::velocity_range`]), the program is never infeasible: tasks are costs, and what they cannot have
//! is their residual.

use dense_qp::{Settings, Status, Workspace, solve_warm};
use rbd_core::{Effort, JointLimits, Motion, Tangent, Tree};
use so3::Scalar;

use crate::program::Program;
use crate::{Contact, Error, Horizon, Snapshot, Task};

/// A velocity program for N joints with V = N + 6 variables and at most M contact rows.
#[derive(Clone, Debug)]
pub struct VelocityQp<T, const N: usize, const V: usize, const M: usize> {
    program: Program<T, V, M>,
    workspace: Workspace<T, V, M>,
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
}

impl<T: Scalar, const N: usize, const V: usize, const M: usize> VelocityQp<T, N, V, M> {
    /// An empty program; iterations are capped at 200.
    #[must_use]
    pub fn new() -> Self {
        const { assert!(V == N + 6, "a velocity program has N + 6 variables") };
        Self {
            program: Program::new(),
            workspace: Workspace::new(),
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
        for contact in contacts {
            let (rows, _, _) = contact.motion(model, snapshot);
            // Rows of an absent contact stay in their place, so that the solver's memory fits the next tick.
            let limit = if contact.is_on() {
                T::ZERO
            } else {
                T::INFINITY
            };
            for row in rows.iter().take(contact.size()) {
                self.program.constrain(&flat(row), -limit, limit)?;
            }
        }
        Ok(())
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

    /// Solves the program.
    ///
    /// # Errors
    /// [`Error::Data`] for numbers that are not finite; [`Error::Unsolved`] if the iteration cap or round-off ended the
    /// search. The safe command is then zero velocity.
    pub fn solve(&mut self) -> Result<VelocityAnswer<T, N>, Error> {
        let solution = solve_warm(&self.program.problem(), &self.settings, &mut self.workspace)
            .map_err(Error::Data)?;
        if solution.status != Status::Solved {
            return Err(Error::Unsolved(solution.status));
        }
        let mut answer = VelocityAnswer {
            velocity: Tangent::ZERO,
            iterations: solution.iterations,
        };
        let mut z = solution.x.iter();
        for (qd, x) in answer.velocity.joints.iter_mut().zip(&mut z) {
            *qd = *x;
        }
        let mut base = [T::ZERO; 6];
        for (to, x) in base.iter_mut().zip(z) {
            *to = *x;
        }
        answer.velocity.base = Motion::from_array(base);
        Ok(answer)
    }
}

impl<T: Scalar, const N: usize, const V: usize, const M: usize> Default for VelocityQp<T, N, V, M> {
    fn default() -> Self {
        Self::new()
    }
}

/// A row over motions in the order of the variables: joints, then base.
fn flat<T: Scalar, const N: usize, const V: usize>(row: &Effort<T, N>) -> [T; V] {
    let mut out = [T::ZERO; V];
    let all = row.joints.iter().copied().chain(row.base.to_array());
    for (to, x) in out.iter_mut().zip(all) {
        *to = x;
    }
    out
}
