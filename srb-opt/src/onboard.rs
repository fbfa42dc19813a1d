//! Plans of a quadruped on a microcontroller: 30 intervals, three phases, storage in a `static`.
//!
//! ```
//! use srb_opt::onboard::{INTERVALS, Workspace};
//!
//! // In firmware: a `static`, taken once. Zeroed, so that it lies in .bss and takes no flash.
//! let mut workspace = Box::new(Workspace::<f64>::new());
//! let problem = srb_opt::onboard::example::<f64>();
//! assert_eq!(problem.intervals(), INTERVALS);
//! let solution = workspace.plan(&problem, &ocp_solver::Settings::new(), |_| {
//!     core::ops::ControlFlow::Continue(()) // or Break, when the time is up
//! }).unwrap();
//! assert_eq!(solution.status, ocp_solver::Status::Solved);
//! for (k, node) in workspace.nodes(&problem).iter().enumerate() {
//!     let forces = problem.sample(k, &node.state, &node.control).forces_w;
//!     assert!(forces.iter().all(|f| f.z > -1e-6));
//! }
//! ```

use crate::error::Error;
use crate::exponential::Exponential;
use crate::problem::{Edge, Foot, Phase, Problem, Reference, Weights};
use crate::state::State;
use core::ops::ControlFlow;
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{LeanStage, Progress, Settings, Solution};
use so3::Scalar;

/// Feet.
pub const FEET: usize = 4;
/// Contact phases a problem may have.
pub const PHASES: usize = 3;
/// Intervals a problem may have.
pub const INTERVALS: usize = 30;

/// Problem (2) in this size.
pub type Jump<T> = Problem<T, FEET, PHASES>;

/// A node of the plan: its `state`, and the `control` that [`Problem::sample`] turns into forces.
pub type Node<T> = LeanStage<T, State<T, PHASES>, 15, 12, 40>;

/// All memory of a plan besides the stack.
#[derive(Clone, Debug)]
pub struct Workspace<T: Scalar> {
    nodes: [Node<T>; INTERVALS + 1],
}

impl<T: Scalar> Workspace<T> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            nodes: [Node::lean(State::new()); INTERVALS + 1],
        }
    }

    /// Plans a jump from the guess of [`Problem::write_guess`].
    ///
    /// # Errors
    /// As [`Problem::plan`]; [`Error::Intervals`] for more than [`INTERVALS`].
    pub fn plan(
        &mut self,
        problem: &Jump<T>,
        settings: &Settings<T>,
        observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        let nodes = self.used(problem)?;
        problem.write_guess(nodes, || T::ZERO);
        problem.plan(settings, nodes, observer)
    }

    /// Plans a jump that differs little from the one before, from its plan; with
    /// [`Settings::warm_start`] from its multipliers as well.
    ///
    /// # Errors
    /// As [`Self::plan`].
    pub fn replan(
        &mut self,
        problem: &Jump<T>,
        settings: &Settings<T>,
        observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        problem.plan(settings, self.used(problem)?, observer)
    }

    /// The nodes of the last plan: one per interval of its problem, and the end.
    #[must_use]
    pub fn nodes(&self, problem: &Jump<T>) -> &[Node<T>] {
        let count = problem.intervals().saturating_add(1);
        self.nodes.get(..count).unwrap_or(&self.nodes)
    }

    fn used(&mut self, problem: &Jump<T>) -> Result<&mut [Node<T>], Error> {
        let count = problem.intervals().saturating_add(1);
        self.nodes.get_mut(..count).ok_or(Error::Intervals)
    }
}

impl<T: Scalar> Default for Workspace<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// A jump of 30 cm to the left by the quadruped of paper A, Table I, on 18 intervals of stance and 12 of flight.
#[must_use]
pub fn example<T: Scalar>() -> Jump<T> {
    let s = T::of;
    let v = |x: f64, y: f64, z: f64| Vector3::new(s(x), s(y), s(z));
    let phase = |contacts, intervals, duration_guess: f64| Phase {
        contacts,
        intervals,
        duration_guess: s(duration_guess),
        min_duration: s(0.1),
        max_duration: s(1.0),
        reference_angle: T::ZERO,
    };
    let (x, y) = (0.1805, 0.1308);
    let foot = |x: f64, y: f64| Foot {
        pos_wf: v(x, y, 0.0),
        nominal_b: v(x, y, 0.0),
    };
    let corner = |x: f64, y: f64, z: f64| v(0.1805 * x, 0.097 * y, 0.057 * z);
    Problem {
        mass: s(12.0),
        inertia_b: Matrix3::from_diagonal(&v(0.017, 0.056, 0.065)),
        gravity: s(9.81),
        feet: [foot(x, y), foot(x, -y), foot(-x, y), foot(-x, -y)],
        reach_lower: v(-0.12, -0.10, -0.33),
        reach_upper: v(0.12, 0.10, -0.10),
        friction: s(0.6),
        max_force: s(160.0),
        corners: [
            corner(1.0, 1.0, 1.0),
            corner(1.0, 1.0, -1.0),
            corner(1.0, -1.0, 1.0),
            corner(1.0, -1.0, -1.0),
            corner(-1.0, 1.0, 1.0),
            corner(-1.0, 1.0, -1.0),
            corner(-1.0, -1.0, 1.0),
            corner(-1.0, -1.0, -1.0),
        ],
        clearance: s(0.03),
        edge: None::<Edge<T>>,
        phases: [
            phase([true; FEET], 18, 0.5),
            phase([false; FEET], 12, 0.3),
            phase([false; FEET], 0, 0.0),
        ],
        phase_count: 2,
        min_total: s(0.5),
        max_total: s(0.8),
        start_w: v(0.0, 0.0, 0.25),
        goal_w: v(0.0, 0.3, 0.25),
        axis: Vector3::z(),
        angle: T::ZERO,
        min_final_trace: s(2.5),
        reference: Reference::Linear,
        weights: Weights {
            omega: s(1e-2),
            force: s(1e-5),
            rotation: T::ONE,
        },
        exponential: Exponential::Taylor4,
        log_epsilon: s(1e-6),
    }
}
