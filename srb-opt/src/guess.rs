//! The initial guess of the reference problem: ballistic flight, reference rotation, weight on the feet.

use crate::dynamics::force_unit;
use crate::problem::Problem;
use crate::rotation::about_axis;
use crate::state::State;
use nalgebra::{Matrix3, Vector3};
use ocp_solver::Stage;
use so3::Scalar;
use so3::math::sin_cos;

/// The centre of mass rests at the start until lift-off, while its velocity ramps up, and then flies to the goal.
struct Ballistic<T: Scalar> {
    start_w: Vector3<T>,
    gravity: T,
    /// When the last phase begins, s.
    lift_off: T,
    /// Velocity there.
    take_off: Vector3<T>,
}

impl<T: Scalar> Ballistic<T> {
    fn new<const FEET: usize, const PHASES: usize>(problem: &Problem<T, FEET, PHASES>) -> Self {
        let (mut total, mut flight) = (T::ZERO, T::ZERO);
        for phase in problem.used_phases() {
            flight = phase.duration_guess;
            total += flight;
        }
        let across = problem.goal_w - problem.start_w;
        let up = Vector3::new(T::ZERO, T::ZERO, problem.gravity * T::HALF * flight);
        Self {
            start_w: problem.start_w,
            gravity: problem.gravity,
            lift_off: total - flight,
            take_off: across / flight + up,
        }
    }

    /// Position and velocity.
    fn at(&self, time: T) -> (Vector3<T>, Vector3<T>) {
        let in_flight = time - self.lift_off;
        if in_flight <= T::of(1e-12) {
            let share = if self.lift_off > T::ZERO {
                time / self.lift_off
            } else {
                T::ZERO
            };
            return (self.start_w, self.take_off * share);
        }
        let fall = Vector3::new(T::ZERO, T::ZERO, self.gravity * in_flight);
        let pos_w = self.start_w + (self.take_off - fall * T::HALF) * in_flight;
        (pos_w, self.take_off - fall)
    }
}

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// Writes this problem's reference rotation into stages that another one guessed or solved; nothing else of them changes.
    pub fn write_reference<const NX: usize, const NU: usize, const NI: usize, K>(
        &self,
        stages: &mut [Stage<T, State<T, PHASES>, NX, NU, NI, K>],
    ) {
        for (k, stage) in stages.iter_mut().enumerate() {
            stage.state.reference = sin_cos(self.reference_angle(k));
        }
    }

    /// Writes the guess into the stages.
    ///
    /// The centre of mass stays at the start until the last phase and then flies to the goal; its
    /// velocity ramps up to lift-off linearly in time; the rotation is the reference; forces share the
    /// weight. `perturb` gives the offset of every number that is added to the guess, in units of m,
    /// m/s, rad, rad/s, s and 50 N: pass `|| T::ZERO` for the plain guess.
    pub fn write_guess<const NX: usize, const NU: usize, const NI: usize, K>(
        &self,
        stages: &mut [Stage<T, State<T, PHASES>, NX, NU, NI, K>],
        mut perturb: impl FnMut() -> T,
    ) {
        // Of one type: what is long is compiled once for all who perturb.
        let mut perturb: &mut dyn FnMut() -> T = &mut perturb;
        let mut durations = [T::ZERO; PHASES];
        for (slot, phase) in durations.iter_mut().zip(self.used_phases()) {
            *slot = phase.duration_guess;
        }
        let way = Ballistic::new(self);
        // The guess of the durations is moved inside their bounds after the noise.
        let mut moved = durations;
        for (slot, phase) in moved.iter_mut().zip(self.used_phases()) {
            let margin = T::of(0.01) * (phase.max_duration - phase.min_duration);
            let wanted = *slot + perturb();
            *slot = wanted.clamp(phase.min_duration + margin, phase.max_duration - margin);
        }
        let noise = |perturb: &mut dyn FnMut() -> T| Vector3::new(perturb(), perturb(), perturb());
        let unit = force_unit(self);
        let last = self.intervals();
        let (mut time, mut dt) = (T::ZERO, T::ONE);
        let mut before: Option<(Matrix3<T>, Vector3<T>)> = None;
        for (k, stage) in stages.iter_mut().enumerate() {
            let mut state = State::new();
            let angle = self.reference_angle(k);
            state.durations = moved;
            state.reference = sin_cos(angle);
            (state.pos_w, state.vel_w) = way.at(time);
            let mut step_dt = dt;
            let mut turn = angle - self.reference_angle(k.saturating_sub(1));
            let mut moved_dt = dt;
            if let Some((i, phase)) = self.phase_of(k).filter(|_| k < last) {
                let share = T::ONE / T::of(phase.intervals.max(1) as f64);
                step_dt = durations.get(i).copied().unwrap_or(T::ONE) * share;
                moved_dt = moved.get(i).copied().unwrap_or(T::ONE) * share;
                turn = self.reference_angle(k.saturating_add(1)) - angle;
            }
            state.omega_b = self.axis * (turn / step_dt);
            let mut rotation = about_axis(&self.axis, state.reference.0, state.reference.1);
            if k == 0 {
                (state.vel_w, state.omega_b) = (Vector3::zeros(), Vector3::zeros());
            } else {
                if k < last {
                    state.pos_w += noise(&mut perturb);
                }
                state.vel_w += noise(&mut perturb);
                rotation *= crate::rotation::exp(&noise(&mut perturb));
                state.omega_b += noise(&mut perturb);
            }
            match &before {
                Some((from, w)) => {
                    state.attach(&rotation, &(from * self.exponential.step(w)));
                }
                None => state.rot_wb = rotation,
            }
            before = Some((state.rot_wb, state.omega_b * moved_dt));
            stage.control = [T::ZERO; NU];
            let feet = self.contacts(k).count();
            let share = T::TWO / T::of(feet.max(1) as f64);
            let (triples, _) = stage.control.as_chunks_mut::<3>();
            for [x, y, z] in triples.iter_mut().take(feet) {
                *z = share;
                for value in [x, y, z] {
                    *value += perturb() * T::of(50.0) / unit;
                }
            }
            stage.state = state;
            time += step_dt;
            dt = step_dt;
        }
    }
}
