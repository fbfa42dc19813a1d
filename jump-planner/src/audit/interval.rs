//! The robot between two nodes of a plan, moved from the first of them by its forward dynamics.

use super::clearance::Overlap;
use super::forward::{Forward, Passed, Velocity, largest};
use super::limits::Limits;
use super::{STEP, state};
use crate::robot::{JOINTS, LEGS, State};
use crate::stored::Stored;
use jump_control::container::PlanNode;
use nalgebra::Vector3;
use rbd_core::difference;

/// What is held over an interval.
pub(super) struct Held {
    pub(super) torques: [f64; JOINTS],
    pub(super) contacts: [bool; LEGS],
    pub(super) steps: usize,
    /// Length of a step, s.
    pub(super) h: f64,
    /// Whether the plan ends with this interval.
    pub(super) last: bool,
}

/// An interval of a plan.
pub(super) struct Interval<'a> {
    from: &'a PlanNode<JOINTS, LEGS>,
    to: &'a PlanNode<JOINTS, LEGS>,
    pub(super) held: Held,
    /// What differences of forces are shares of, N.
    force_range: f64,
}

/// What was seen in intervals.
pub(super) struct Watched {
    /// Time for which each joint's torque is at its limit, s.
    pub(super) saturation: [f64; JOINTS],
    /// Time for which any joint's is, s.
    pub(super) any_saturation: f64,
    /// The smallest of each limit, and when, s.
    pub(super) smallest: Vec<(f64, f64)>,
    /// Shapes of the robot that pass through each other, where they are deepest.
    pub(super) overlaps: Vec<Overlap>,
    /// See [`super::Audit::defect`].
    pub(super) defect: [f64; 2],
    /// See [`super::Audit::force_error`].
    pub(super) force_error: f64,
}

impl<'a> Interval<'a> {
    /// The intervals between nodes of a plan.
    ///
    /// # Errors
    /// One that is none, or in a phase that there is not.
    pub(super) fn all(
        plan: &Stored<'_>,
        nodes: &'a [PlanNode<JOINTS, LEGS>],
    ) -> Result<Vec<Self>, String> {
        let last = nodes.len().saturating_sub(2);
        let pairs = nodes.iter().zip(nodes.iter().skip(1)).enumerate();
        pairs
            .map(|(k, (from, to))| {
                Ok(Self {
                    held: Held::of(plan, from, f64::from(to.time - from.time), k == last)?,
                    force_range: f64::from(plan.header().margins.max_force),
                    from,
                    to,
                })
            })
            .collect()
    }

    /// When it begins, s.
    pub(super) fn time(&self) -> f64 {
        f64::from(self.from.time)
    }

    /// Configuration and velocity at its node.
    pub(super) fn start(&self) -> (State, Velocity) {
        state(self.from)
    }

    /// Moves the robot from the one node to the other and looks at every limit in the middle and at the end of every step.
    pub(super) fn watch(&self, forward: &mut Forward<'_>, limits: &Limits<'_>) -> Watched {
        let (held, mut found) = (&self.held, Watched::new(limits));
        let (mut q, mut v) = self.start();
        for i in 0..held.steps {
            let at = self.time() + i as f64 * held.h;
            let start = (q, v);
            let passed = held.step(forward, &mut q, &mut v);
            let [start_w, middle_w, end_w] = &passed.forces_w;
            let half = 0.5 * held.h;
            let (middle, end) = (&passed.middle, &(q, v));
            if i == 0 {
                limits.check((at, 0.0), &start, held, start_w, &mut found);
            }
            limits.check((at + half, half), middle, held, middle_w, &mut found);
            limits.check((at + held.h, half), end, held, end_w, &mut found);
            // The middle of an even number of steps is the start of one.
            if i == held.steps / 2 {
                let told = self.from.forces_w.map(|f| Vector3::from(f.map(f64::from)));
                let pairs = told.iter().zip(&passed.forces_w[held.steps % 2]);
                let gaps = pairs.map(|(a, b)| (a - b).amax() / self.force_range);
                found.force_error = gaps.fold(0.0, f64::max);
            }
        }
        let (end, end_v) = state(self.to);
        found.defect = [largest(&difference(&end, &q)), largest(&(v - end_v))];
        found
    }
}

impl Held {
    fn of(
        plan: &Stored<'_>,
        node: &PlanNode<JOINTS, LEGS>,
        dt: f64,
        last: bool,
    ) -> Result<Self, String> {
        let header = plan.header();
        let phases = header.phases.get(..usize::from(header.phase_count));
        let phase = phases.and_then(|phases| phases.get(usize::from(node.phase)));
        let bits = phase
            .ok_or("a node is in a phase that there is not")?
            .contacts;
        if !(dt > 0.0 && dt < 1.0) {
            return Err(format!("an interval of {dt} s"));
        }
        let steps = (dt / STEP).round().max(1.0);
        Ok(Self {
            torques: node.torques.map(f64::from),
            contacts: core::array::from_fn(|i| (bits >> i) & 1 == 1),
            steps: steps as usize,
            h: dt / steps,
            last,
        })
    }

    /// One step.
    pub(super) fn step(
        &self,
        forward: &mut Forward<'_>,
        q: &mut State,
        v: &mut Velocity,
    ) -> Passed {
        forward.step(q, v, &self.torques, &self.contacts, self.h)
    }
}

impl Watched {
    /// Nothing yet.
    pub(super) fn new(limits: &Limits<'_>) -> Self {
        Self {
            saturation: [0.0; JOINTS],
            any_saturation: 0.0,
            smallest: vec![(f64::INFINITY, 0.0); limits.count()],
            overlaps: Vec::new(),
            defect: [0.0; 2],
            force_error: 0.0,
        }
    }

    /// Keeps the smallest value of each limit; limits that do not hold now are NaN, those without bounds infinite.
    pub(super) fn remember(&mut self, time: f64, values: &[f64]) {
        for (smallest, value) in self.smallest.iter_mut().zip(values) {
            if *value < smallest.0 {
                *smallest = (*value, time);
            }
        }
    }

    /// Keeps the deepest overlap of two shapes.
    pub(super) fn overlap(&mut self, found: Overlap) {
        let mut known = self.overlaps.iter_mut();
        match known.find(|overlap| overlap.shapes == found.shapes) {
            Some(overlap) if overlap.gap <= found.gap => {}
            Some(overlap) => *overlap = found,
            None => self.overlaps.push(found),
        }
    }

    /// Adds what was seen later.
    pub(super) fn merge(&mut self, later: &Self) {
        let times = self.saturation.iter_mut().zip(&later.saturation);
        times.for_each(|(sum, time)| *sum += time);
        self.any_saturation += later.any_saturation;
        for (smallest, found) in self.smallest.iter_mut().zip(&later.smallest) {
            if found.0 < smallest.0 {
                *smallest = *found;
            }
        }
        later.overlaps.iter().for_each(|found| self.overlap(*found));
        let defects = self.defect.iter_mut().zip(&later.defect);
        defects.for_each(|(most, defect)| *most = most.max(*defect));
        self.force_error = self.force_error.max(later.force_error);
    }
}
