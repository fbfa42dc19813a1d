//! A planned motion in physical units, and how well it meets the problem.

use crate::drive::Line;
use crate::midpoint::Midpoint;
use crate::problem::Problem;
use crate::robot::{BASE, TURN};
use crate::rotation::{angular_acceleration, set_triple, triple};
use crate::state::State;
use nalgebra::{Rotation3, Vector3};
use rbd_core::second_order::Sweep;
use so3::Scalar;
use so3::math::{abs, max};

/// An interval in physical units, at its midpoint. On SO(3) the base's rates and accelerations are angular velocity and
/// acceleration in base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T: Scalar, const N: usize, const FEET: usize> {
    /// Configuration, see [`crate::Pose::q`].
    pub q: [T; N],
    /// See [`crate::Pose::rot_wc`].
    pub rot_wc: Rotation3<T>,
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
        let mut sweep = Sweep::zero(&self.robot.bodies);
        mid.set(&mut sweep);
        self.sampled(k, &mid, &sweep)
    }

    fn sampled(
        &self,
        k: usize,
        mid: &Midpoint<T, N, FEET>,
        sweep: &Sweep<'_, T, N>,
    ) -> Sample<T, N, FEET> {
        let contacts = self.contact_motions(k, sweep, mid);
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
        let mut sample = Sample {
            q: mid.q,
            rot_wc: mid.rot_wc,
            v: mid.v,
            a: mid.a,
            effort,
            forces_w,
        };
        if self.robot.turns_freely() {
            let joints = triple(&mid.a, TURN);
            let alpha = angular_acceleration(&triple(&mid.v, TURN), &joints);
            set_triple(&mut sample.a, TURN, &alpha);
        }
        sample
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
        let mut before: Option<(State<T, N>, Midpoint<T, N, FEET>)> = None;
        for (k, (state, control)) in nodes.enumerate() {
            match before {
                None => {
                    for ((q, v), start) in state.q.iter().zip(&state.v).zip(&self.start.q) {
                        above(abs(*q - *start));
                        above(abs(*v));
                    }
                    let turned = so3::log(&(self.start.rot_wc.inverse() * state.rot_wc));
                    turned.iter().for_each(|x| above(abs(*x)));
                }
                Some((from, over)) => {
                    let gap = self.gap(k.saturating_sub(1), &from, &over, state);
                    gap.iter().flatten().for_each(|x| above(abs(*x)));
                }
            }
            if k >= self.intervals() {
                let goal = &self.goal;
                cost += self.weights.goal * goal.distance_squared(&state.q, &state.rot_wc);
                let ends = state.q.iter().zip(&goal.q).zip(&self.goal_tolerance);
                for ((q, goal), tolerance) in ends {
                    above(abs(*q - *goal) - *tolerance);
                }
                if self.robot.turns_freely() {
                    let e = goal.seen(&state.rot_wc);
                    let tolerances = self.goal_tolerance.iter().skip(TURN);
                    for (sine, tolerance) in so3::vee(&e).iter().zip(tolerances) {
                        above(abs(*sine) - *tolerance);
                    }
                    // The sine is small at half a turn, too.
                    above(T::ONE - e.trace());
                }
                break;
            }
            let mid: Midpoint<T, N, FEET> = self.midpoint(k, state, control);
            let mut sweep = Sweep::zero(&self.robot.bodies);
            mid.set(&mut sweep);
            let sample = self.sampled(k, &mid, &sweep);
            let weights = self.interval_weights(k);
            if let Some(reference) = self.reference.get(k) {
                let distance = reference.distance_squared(&mid.q, &mid.rot_wc);
                cost += weights.position * distance;
            }
            for (i, effort) in sample.effort.iter().enumerate() {
                if i < BASE {
                    above(abs(*effort));
                } else {
                    cost += weights.effort * *effort * *effort;
                    peak_effort = max(peak_effort, abs(*effort));
                }
            }
            self.judge_limits(k, state, &sample, &mut above);
            self.judge_contacts(k, &sweep, &sample, &mut above);
            for force in &sample.forces_w {
                peak_force = max(peak_force, force.z);
            }
            before = Some((*state, mid));
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
                above(abs(state.q[i] - self.goal.q[i]));
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
    fn judge_contacts(
        &self,
        k: usize,
        sweep: &Sweep<'_, T, N>,
        sample: &Sample<T, N, FEET>,
        above: &mut impl FnMut(T),
    ) {
        let feet = self.feet.iter().zip(&sample.forces_w);
        for (i, ((foot, f), on)) in feet.zip(self.contacts(k)).enumerate() {
            let point = sweep.point(foot.point.link, &foot.point.offset_l);
            if on {
                let mut touching = point;
                touching.arm.z = -foot.radius;
                let slip = sweep.slip_rate(&touching);
                slip.iter().for_each(|x| above(abs(*x)));
                for (x, place) in point.pos.iter().zip(&foot.pos_wf) {
                    above(abs(*x - *place) - self.drift);
                }
                let rows = self.friction.gradients();
                let sides = rows.map(|row| -Vector3::from(row).dot(f));
                sides.take(self.friction.sides()).for_each(&mut *above);
                above(self.least_force - f.z);
                above(f.z - self.most_force(k, i));
            } else {
                above(self.least_height(k, i) - self.over_ground(&point.pos).height);
            }
        }
        for clearance in self.clearances {
            let pos = sweep.place(clearance.point.link, &clearance.point.offset_l);
            above(clearance.height - self.over_ground(&pos).height);
        }
        for pair in self.apart.iter().take(self.groups(k).apart) {
            above(pair.distance * T::HALF - pair.near(sweep).value);
        }
    }
}
