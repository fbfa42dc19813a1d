//! What a plan leaves for the next one like it.

use super::FOOT_COUNT;
use super::setup::{N, NI, NU, NX};
use super::task::{SrbStage, Task};
use crate::apart::Separation;
use crate::lengths::Lengths;
use crate::tightening::Tightening;
use ocp_solver::SparseStage;
use wb_opt::State;

/// The motions of a plan's two stages and the multipliers of their limits: where [`replan`](crate::replan) begins.
///
/// As large as the solver's own storage.
#[derive(Clone)]
pub struct Kept {
    /// Nodes of the rigid body's plan.
    pub(crate) body: Vec<SrbStage>,
    /// Feet on the ground in every phase.
    pub(crate) contacts: Vec<[bool; FOOT_COUNT]>,
    /// Lengths of the intervals.
    pub(crate) lengths: Lengths,
    /// Number of intervals of every part of the phases.
    pub(crate) intervals: Vec<usize>,
    /// Nodes of the whole body's plan.
    pub(crate) stages: Vec<SparseStage<f64, State<f64, N>, NX, NU, NI>>,
    /// Share of the torque limits.
    pub(crate) torque_share: f64,
    /// Links that keep apart.
    pub(crate) apart: Separation,
    /// Limits that the audit had asked to be drawn in.
    pub(crate) drawn: Tightening,
}

impl Kept {
    /// Whether a task has the same phases, so that its nodes are these.
    #[must_use]
    pub fn is_of_phases(&self, task: &Task) -> bool {
        let phases = task.problem.used_phases();
        let contacts = phases.iter().map(|phase| &phase.contacts);
        contacts.eq(&self.contacts) && task.problem.intervals() + 1 == self.body.len()
    }
}
