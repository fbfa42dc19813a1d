//! The initial guess: the reference, its rates, and given contact forces.

use crate::problem::Problem;
use crate::robot::{BASE, TURN};
use crate::rotation::{set_triple, triple};
use crate::state::{Layout, Pose, State, Units};
use nalgebra::Vector3;
use ocp_solver::SparseStage;
use so3::Scalar;

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Writes the guess into the stages.
    ///
    /// Configurations are those of `nodes`, one per node, less than half a turn apart; rates and accelerations of the
    /// base are their differences; joints do not move. `forces` gives the force on each foot during an interval, world
    /// axes, N; only feet in contact are asked for. `perturb` gives the offset of every unknown in the
    /// solver's units: pass `|| T::ZERO` for the plain guess.
    pub fn write_guess<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        stages: &mut [SparseStage<T, State<T, N>, NX, NU, NI>],
        nodes: &[Pose<T, N>],
        mut forces: impl FnMut(usize, usize) -> Vector3<T>,
        mut perturb: impl FnMut() -> T,
    ) {
        let units = Units::<T>::new();
        let last = nodes.len().saturating_sub(1);
        // Speed over interval k of the plain guess; none before the start.
        let speed = |k: usize, i: usize| {
            let at = |k: usize| nodes.get(k.min(last)).unwrap_or(&self.start);
            let (from, to) = (at(k), at(k.saturating_add(1)));
            let dt = self.dt(k.min(last.saturating_sub(1)));
            let straight = to.q[i] - from.q[i];
            match i.checked_sub(TURN) {
                Some(axis) if self.robot.turns_freely() => {
                    so3::log(&(from.rot_wc.inverse() * to.rot_wc))[axis] / dt
                }
                _ => straight / dt,
            }
        };
        let before = |k: usize, i: usize| k.checked_sub(1).map_or(T::ZERO, |k| speed(k, i));
        for (k, stage) in stages.iter_mut().enumerate() {
            let mut state = State::at_rest(nodes.get(k.min(last)).copied().unwrap_or(self.start));
            for i in 0..BASE.min(N) {
                state.v[i] = (before(k, i) + speed(k.min(last.saturating_sub(1)), i)) * T::HALF;
            }
            stage.control = [T::ZERO; NU];
            if k == 0 {
                state = State::at_rest(self.start);
            } else {
                state = self.moved(&state, core::iter::repeat_with(&mut perturb));
            }
            stage.state = state;
            if k >= self.intervals() {
                continue;
            }
            for (i, u) in stage.control.iter_mut().enumerate().take(BASE.min(N)) {
                *u = (speed(k, i) - before(k, i)) / (self.dt(k) * units.acceleration);
            }
            let on = self.contacts(k);
            let standing = (0..FEET).filter(|f| on.get(*f).copied().unwrap_or(false));
            for (slot, f) in standing.enumerate() {
                let slots = stage.control.iter_mut().skip(Layout::force(slot));
                for (u, value) in slots.zip(forces(k, f).iter()) {
                    *u = *value / units.force;
                }
            }
            for u in stage.control.iter_mut().take(self.layout(k).controls()) {
                *u += perturb();
            }
        }
    }

    /// Writes a motion whose intervals are `parts` times as long into the stages: its nodes, with their controls. Accelerations and
    /// forces are held over an interval, so it is nearly the same motion; a base on SO(3) turns otherwise in the third order of an
    /// interval.
    pub fn write_split<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        stages: &mut [SparseStage<T, State<T, N>, NX, NU, NI>],
        nodes: &[(State<T, N>, [T; NU])],
        parts: usize,
    ) {
        let parts = parts.max(1);
        for (k, stage) in stages.iter_mut().enumerate() {
            let Some((state, control)) = nodes.get(k / parts) else {
                break;
            };
            let time = self.dt(k) * T::of((k % parts) as f64);
            stage.state = self.held(k, state, control, time);
            stage.control = *control;
        }
    }

    /// The state that accelerations held from a node on lead to.
    fn held<const NU: usize>(
        &self,
        k: usize,
        state: &State<T, N>,
        control: &[T; NU],
        time: T,
    ) -> State<T, N> {
        let units = Units::<T>::new();
        let layout = Layout {
            joints: N.saturating_sub(BASE),
            ..self.layout(k)
        };
        let mut out = *state;
        for (i, (q, v)) in out.q.iter_mut().zip(&mut out.v).enumerate() {
            let u = layout.acceleration(i).and_then(|u| control.get(u));
            let gained = time * units.acceleration * u.copied().unwrap_or(T::ZERO);
            *q += time * (*v + T::HALF * gained);
            *v += gained;
        }
        if self.robot.turns_freely() {
            // The angles would have come from zero to the angular velocity of the middle, times the time.
            out.rot_wc = state.rot_wc * so3::exp(&triple(&out.q, TURN));
            set_triple(&mut out.q, TURN, &Vector3::zeros());
        }
        out
    }
}
