//! A planned motion in physical units, and how well it meets the problem.

use crate::drive::Line;
use crate::midpoint::Midpoint;
use crate::problem::Problem;
use crate::robot::BASE;
use crate::state::State;
use crate::sweep::Sweep;
use nalgebra::Vector3;
use so3::Scalar;
use so3::math::{abs, max};

/// An interval in physical units, at its midpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T: Scalar, const N: usize, const FEET: usize> {
    /// Configuration.
    pub q: [T; N],
    /// Rates.
    pub v: [T; N],
    /// Accelerations, constant over the interval.
    pub a: [T; N],
    /// Efforts, constant over the interval; those of the base vanish in a solution.
    pub effort: [T; N],
    /// Force on every foot in the world, N; zero for feet in the air.
    pub forces_w: [Vector3<T>; FEET],
}

/// Cost and worst violation of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement<T> {
    /// Cost.
    pub cost: T,
    /// Largest violation of any row: m, rad, their rates, N or N m as the row has it.
    pub max_violation: T,
    /// Largest normal force, N.
    pub peak_force: T,
    /// Largest joint effort, N m.
    pub peak_effort: T,
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Interval `k` of a motion.
    #[must_use]
    pub fn sample<const NU: usize>(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
    ) -> Sample<T, N, FEET> {
        let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
        let sweep = Sweep::new(&self.robot.bodies, &mid.q, &mid.v, &mid.a);
        let contacts = self.contact_motions(k, &sweep, &mid);
        let mut effort = [T::ZERO; N];
        sweep.effort(&mid.a, &contacts, &mut effort);
        self.add_friction(&mid.v, &mut effort);
        let mut forces_w = [Vector3::zeros(); FEET];
        let mut given = mid.forces.iter();
        for (slot, on) in forces_w.iter_mut().zip(self.contacts(k)) {
            if on && let Some(force) = given.next() {
                *slot = *force;
            }
        }
        Sample {
            q: mid.q,
            v: mid.v,
            a: mid.a,
            effort,
            forces_w,
        }
    }

    /// Judges a motion given node by node: `(state, control)` for nodes `0 ..= intervals()`.
    #[must_use]
    pub fn judge<'s, const NU: usize>(
        &self,
        nodes: impl Iterator<Item = (&'s State<T, N>, &'s [T; NU])>,
    ) -> Judgement<T> {
        let (mut cost, mut peak_force, mut peak_effort) = (T::ZERO, T::ZERO, T::ZERO);
        let mut worst = T::ZERO;
        let mut above = |amount: T| worst = if amount <= worst { worst } else { amount };
        let square = |sum: T, (x, y): (&T, &T)| sum + (*x - *y) * (*x - *y);
        let mut before: Option<(State<T, N>, Sample<T, N, FEET>)> = None;
        for (k, (state, control)) in nodes.enumerate() {
            match before {
                None => {
                    for ((q, v), start) in state.q.iter().zip(&state.v).zip(&self.start) {
                        above(abs(*q - *start));
                        above(abs(*v));
                    }
                }
                Some((from, over)) => {
                    let dt = self.dt(k.saturating_sub(1));
                    for i in 0..N {
                        above(abs(from.q[i] + dt * over.v[i] - state.q[i]));
                        above(abs(from.v[i] + dt * over.a[i] - state.v[i]));
                    }
                }
            }
            if k >= self.intervals() {
                cost += self.weights.goal * state.q.iter().zip(&self.goal).fold(T::ZERO, square);
                for ((q, goal), tolerance) in
                    state.q.iter().zip(&self.goal).zip(&self.goal_tolerance)
                {
                    above(abs(*q - *goal) - *tolerance);
                }
                break;
            }
            let sample = self.sample(k, state, control);
            if let Some(reference) = self.reference.get(k) {
                cost +=
                    self.weights.position * sample.q.iter().zip(reference).fold(T::ZERO, square);
            }
            for (i, effort) in sample.effort.iter().enumerate() {
                if i < BASE {
                    above(abs(*effort));
                } else {
                    cost += self.weights.effort * *effort * *effort;
                    peak_effort = max(peak_effort, abs(*effort));
                }
            }
            self.judge_limits(k, state, &sample, &mut above);
            self.judge_contacts(k, &sample, &mut above);
            for force in &sample.forces_w {
                peak_force = max(peak_force, force.z);
            }
            before = Some((*state, sample));
        }
        Judgement {
            cost,
            max_violation: worst,
            peak_force,
            peak_effort,
        }
    }

    /// Joint limits and the landing configuration.
    fn judge_limits(
        &self,
        k: usize,
        state: &State<T, N>,
        sample: &Sample<T, N, FEET>,
        above: &mut impl FnMut(T),
    ) {
        for (i, limit) in self.robot.limits.iter().enumerate().skip(BASE) {
            above(abs(sample.effort[i]) - limit.effort);
            if let Some(motor) = &self.robot.motors[i] {
                let line = Line::of(Some(motor));
                for offset in self.ends(k) {
                    let speed = sample.v[i] + offset * sample.a[i];
                    above(abs(sample.effort[i] + line.slope * speed) - line.bound);
                }
            }
            if self.is_landing(k) {
                above(abs(state.q[i] - self.goal[i]));
                above(abs(state.v[i]));
                above(abs(sample.a[i]));
            } else {
                above(limit.lower - sample.q[i]);
                above(sample.q[i] - limit.upper);
                above(abs(sample.v[i]) - limit.speed);
            }
        }
    }

    /// Feet, friction and clearances.
    fn judge_contacts(&self, k: usize, sample: &Sample<T, N, FEET>, above: &mut impl FnMut(T)) {
        let sweep = Sweep::new(&self.robot.bodies, &sample.q, &sample.v, &sample.a);
        let feet = self.feet.iter().zip(&sample.forces_w);
        for ((foot, f), on) in feet.zip(self.contacts(k)) {
            let point = sweep.point(&foot.point);
            if on {
                let mut touching = point;
                touching.arm.z = -foot.radius;
                let slip = sweep.slip_rate(&touching);
                slip.iter().for_each(|x| above(abs(*x)));
                for (x, place) in point.pos.iter().zip(&foot.pos_wf) {
                    above(abs(*x - *place) - self.drift);
                }
                above(abs(f.x) - self.friction * f.z);
                above(abs(f.y) - self.friction * f.z);
                above(self.least_force - f.z);
            } else {
                above(self.swing_height - self.over_ground(&point.pos).height);
            }
        }
        for clearance in self.clearances {
            let pos = sweep.place(&clearance.point);
            above(clearance.height - self.over_ground(&pos).height);
        }
    }
}
