//! How well a planned motion meets problem (2), recomputed from its numbers in physical units.

use crate::dynamics::force_unit;
use crate::problem::Problem;
use crate::rotation::{LogError, about_axis, vee};
use crate::state::State;
use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::{abs, max, sin_cos};

/// Cost and worst violation of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement<T> {
    /// Cost of problem (2).
    pub cost: T,
    /// Largest violation of any row: m, m/s, rad, rad/s, N or s as the row has it.
    pub max_violation: T,
    /// Largest normal force, N.
    pub peak_force: T,
}

/// A node as it is judged: state, contact forces (world, N; zero for feet in the air) and angular
/// acceleration in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<T: Scalar, const FEET: usize> {
    /// Force on every foot in the world, N.
    pub forces_w: [Vector3<T>; FEET],
    /// Angular acceleration, body frame, rad/s².
    pub alpha_b: Vector3<T>,
}

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// Forces and angular acceleration of interval `k` for scaled controls as the solver holds them.
    #[must_use]
    pub fn sample<const NU: usize>(
        &self,
        k: usize,
        state: &State<T, PHASES>,
        control: &[T; NU],
    ) -> Sample<T, FEET> {
        let unit = force_unit(self);
        let mut forces_w = [Vector3::zeros(); FEET];
        let (triples, _) = control.as_chunks::<3>();
        let mut triples = triples.iter();
        let mut moment = Vector3::zeros();
        if let Some((_, phase)) = self.phase_of(k).filter(|_| k < self.intervals()) {
            for ((force, foot), on) in forces_w.iter_mut().zip(&self.feet).zip(&phase.contacts) {
                if let Some(u) = triples.next_if_on(*on) {
                    *force = Vector3::from(*u) * unit;
                    moment += force.cross(&(state.pos_w - foot.pos_wf));
                }
            }
        }
        let momentum = self.inertia_b * state.omega_b;
        let moment_b = state.rot_wb.transpose() * moment;
        let alpha_b = self.inverse_inertia() * (moment_b - state.omega_b.cross(&momentum));
        Sample { forces_w, alpha_b }
    }

    /// Judges a motion given node by node: `(state, control)` for nodes `0 ..= intervals()`.
    #[must_use]
    pub fn judge<'a, const NU: usize>(
        &self,
        nodes: impl Iterator<Item = (&'a State<T, PHASES>, &'a [T; NU])>,
    ) -> Judgement<T> {
        let (mut cost, mut peak_force) = (T::ZERO, T::ZERO);
        let mut worst = T::ZERO;
        let mut above = |amount: T| worst = if amount <= worst { worst } else { amount };
        let mut before: Option<(&State<T, PHASES>, Sample<T, FEET>)> = None;
        let last = self.intervals();
        for (k, (state, control)) in nodes.enumerate() {
            if let Some((from, sample)) = before {
                self.dynamics_rows(k, from, &sample, state, &mut above);
            }
            let sample = self.sample(k, state, control);
            if k == 0 {
                let zero = Vector3::zeros();
                norm(&(state.pos_w - self.start_w), &mut above);
                norm(&(state.vel_w - zero), &mut above);
                norm(&(state.omega_b - zero), &mut above);
                entries(&(state.rot_wb - Matrix3::identity()), &mut above);
                let mut total = T::ZERO;
                for (duration, phase) in state.durations.iter().zip(self.used_phases()) {
                    above(phase.min_duration - *duration);
                    above(*duration - phase.max_duration);
                    total += *duration;
                }
                above(self.min_total - total);
                above(total - self.max_total);
            } else {
                for corner in &self.corners {
                    let point = state.pos_w + state.rot_wb * corner;
                    above(self.ground(&point) + self.clearance - point.z);
                }
            }
            if k < last {
                let Some((_, phase)) = self.phase_of(k) else {
                    continue;
                };
                let feet = self.feet.iter().zip(&sample.forces_w).zip(&phase.contacts);
                for ((foot, f), _) in feet.filter(|(_, on)| **on) {
                    for side in [f.x, f.y] {
                        above(abs(side) - self.friction * f.z);
                    }
                    above(-f.z);
                    above(f.z - self.max_force);
                    peak_force = max(peak_force, f.z);
                    let seen =
                        state.rot_wb.transpose() * (foot.pos_wf - state.pos_w) - foot.nominal_b;
                    for ((x, l), h) in seen.iter().zip(&self.reach_lower).zip(&self.reach_upper) {
                        above(*l - *x);
                        above(*x - *h);
                    }
                    cost += self.weights.force * f.norm_squared();
                }
                let (sin, cos) = sin_cos(self.reference_angle(k));
                let error = about_axis(&self.axis, sin, cos).transpose() * state.rot_wb;
                let error = LogError::new(&error, self.log_epsilon).error;
                cost += self.weights.omega * state.omega_b.norm_squared()
                    + self.weights.rotation * error.norm_squared();
            } else {
                norm(&(state.pos_w - self.goal_w), &mut above);
                let (sin, cos) = sin_cos(self.angle);
                let error = about_axis(&self.axis, sin, cos).transpose() * state.rot_wb;
                norm(&vee(&error), &mut above);
                above(self.min_final_trace - error.trace());
            }
            before = Some((state, sample));
        }
        Judgement {
            cost,
            max_violation: worst,
            peak_force,
        }
    }

    /// The equalities of interval `k − 1`, row by row.
    fn dynamics_rows(
        &self,
        k: usize,
        from: &State<T, PHASES>,
        sample: &Sample<T, FEET>,
        to: &State<T, PHASES>,
        above: &mut impl FnMut(T),
    ) {
        let Some((i, phase)) = self.phase_of(k.saturating_sub(1)) else {
            return;
        };
        let duration = from.durations.get(i).copied().unwrap_or(T::NAN);
        let dt = duration / T::of(phase.intervals.max(1) as f64);
        let mut a = sample
            .forces_w
            .iter()
            .fold(Vector3::zeros(), |sum, f| sum + f)
            / self.mass;
        a.z -= self.gravity;
        norm(&(to.vel_w - from.vel_w - a * dt), above);
        norm(
            &(to.pos_w - from.pos_w - from.vel_w * dt - a * (dt * dt * T::HALF)),
            above,
        );
        norm(&(to.omega_b - from.omega_b - sample.alpha_b * dt), above);
        let turn = self.exponential.step(&(from.omega_b * dt));
        entries(&(to.rot_wb - from.rot_wb * turn), above);
        for (a, b) in from
            .durations
            .iter()
            .zip(&to.durations)
            .take(self.phase_count)
        {
            above(abs(*a - *b));
        }
    }
}

fn norm<T: Scalar>(v: &Vector3<T>, above: &mut impl FnMut(T)) {
    v.iter().for_each(|x| above(abs(*x)));
}

fn entries<T: Scalar>(m: &Matrix3<T>, above: &mut impl FnMut(T)) {
    m.iter().for_each(|x| above(abs(*x)));
}

/// Takes the next item only where a flag is set.
trait NextIfOn: Iterator {
    fn next_if_on(&mut self, on: bool) -> Option<Self::Item> {
        if on { self.next() } else { None }
    }
}

impl<I: Iterator> NextIfOn for I {}
