//! The single rigid body over one interval, with first and second derivatives: position, paper A eq. (1a), angular velocity,
//! eq. (1b), and rotation, eq. (1c) in the steps of eq. (2c); what is missing to the next node is eq. (2b).
//!
//! ```text
//! p⁺ = p + dt v + ½ dt² a,   v⁺ = v + dt a,   a = Σ f / m − g
//! ω⁺ = ω + dt α,             α = I⁻¹ (b − ω × I ω),   b = Rᵀ Σ f × (p − p_foot)
//! R⁺ = R E(ω dt),            dt = T_i / N_i
//! ```
//!
//! Tangent order: position, velocity, rotation (`R Exp(θ)`), angular velocity, durations.

use crate::exponential::Exponential;
use crate::problem::Problem;
use crate::rotation::hat;
use crate::state::{OMEGA, POSITION, ROTATION, State, TIMES, VELOCITY, put, put_column};
use nalgebra::{Matrix3, Vector3};
use ocp_solver::Derivatives;
use so3::Scalar;

/// One interval at one point.
pub(crate) struct Interval<T: Scalar> {
    pub(crate) dt: T,
    /// ∂dt/∂T_i = 1/N_i.
    pub(crate) rate: T,
    /// Phase of the interval.
    pub(crate) phase: usize,
    acceleration: Vector3<T>,
    alpha: Vector3<T>,
    /// Σ f.
    force: Vector3<T>,
    /// Body moment b.
    moment_b: Vector3<T>,
}

/// Newtons per unit of control: half the robot's weight, so that controls are of order one.
pub(crate) fn force_unit<T: Scalar, const FEET: usize, const PHASES: usize>(
    problem: &Problem<T, FEET, PHASES>,
) -> T {
    problem.mass * problem.gravity * T::HALF
}

impl<T: Scalar> Interval<T> {
    /// Evaluates eq. (1) at a state and its forces.
    #[inline(always)]
    pub(crate) fn new<const FEET: usize, const PHASES: usize, const NU: usize>(
        problem: &Problem<T, FEET, PHASES>,
        k: usize,
        state: &State<T, PHASES>,
        control: &[T; NU],
    ) -> Option<Self> {
        let (phase, data) = problem.phase_of(k)?;
        let rate = T::ONE / T::of(data.intervals.max(1) as f64);
        let dt = *state.durations.get(phase)? * rate;
        let unit = force_unit(problem);
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        let (triples, _) = control.as_chunks::<3>();
        let in_contact = problem
            .feet
            .iter()
            .zip(&data.contacts)
            .filter(|(_, on)| **on);
        for ((foot, _), u) in in_contact.zip(triples) {
            let f = Vector3::from(*u) * unit;
            force += f;
            moment += f.cross(&(state.pos_w - foot.pos_wf));
        }
        let moment_b = state.rot_wb.transpose() * moment;
        let momentum = problem.inertia_b * state.omega_b;
        let alpha = problem.inverse_inertia() * (moment_b - state.omega_b.cross(&momentum));
        let mut acceleration = force / problem.mass;
        acceleration.z -= problem.gravity;
        Some(Self {
            dt,
            rate,
            phase,
            acceleration,
            alpha,
            force,
            moment_b,
        })
    }

    /// Gap to the next state; the rotation's is kept in that state.
    #[inline(always)]
    pub(crate) fn gap<const PHASES: usize, const NX: usize>(
        &self,
        state: &State<T, PHASES>,
        next: &State<T, PHASES>,
        gap: &mut [T; NX],
    ) {
        let dt = self.dt;
        let v = state.vel_w + self.acceleration * dt;
        let p = state.pos_w + (state.vel_w + self.acceleration * (dt * T::HALF)) * dt;
        put(gap, POSITION, &(p - next.pos_w));
        put(gap, VELOCITY, &(v - next.vel_w));
        put(gap, ROTATION, &next.rotation_gap);
        put(
            gap,
            OMEGA,
            &(state.omega_b + self.alpha * dt - next.omega_b),
        );
        for ((slot, a), b) in gap
            .iter_mut()
            .skip(TIMES)
            .zip(&state.durations)
            .zip(&next.durations)
        {
            *slot = *a - *b;
        }
    }

    /// Jacobians of the gap and the Hessian of `λᵀ gap`; Hessian blocks are overwritten.
    #[inline(always)]
    pub(crate) fn differentiate<
        const FEET: usize,
        const PHASES: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        problem: &Problem<T, FEET, PHASES>,
        state: &State<T, PHASES>,
        next: &State<T, PHASES>,
        multiplier: &[T; NX],
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let inverse_inertia = problem.inverse_inertia();
        let body_from_world = state.rot_wb.transpose();
        let turn = body_from_world * next.rot_wb;
        let shared = Shared {
            inverse_inertia,
            force_b: body_from_world * hat(&self.force),
            momentum: problem.inertia_b * state.omega_b,
            turn: exp_inverse_times(&turn, problem.exponential, &(state.omega_b * self.dt)),
        };
        let part = |at: usize| Vector3::new(multiplier[at], multiplier[at + 1], multiplier[at + 2]);
        let q = inverse_inertia * part(OMEGA);
        let pull = Pull {
            position: part(POSITION),
            velocity: part(VELOCITY),
            rotation: part(ROTATION),
            q,
            z: state.rot_wb * q,
        };
        self.state_jacobian(problem, state, &shared, d);
        self.state_hessian(problem, state, &shared, &pull, d);
        self.forces(problem, state, &inverse_inertia, &pull, d);
    }

    /// Jacobian in the state.
    #[inline(always)]
    fn state_jacobian<
        const FEET: usize,
        const PHASES: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        problem: &Problem<T, FEET, PHASES>,
        state: &State<T, PHASES>,
        shared: &Shared<T>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let Self { dt, rate, .. } = *self;
        let Shared {
            inverse_inertia,
            force_b,
            momentum,
            turn,
        } = shared;
        let omega = &state.omega_b;
        let identity = Matrix3::identity();
        let a = &mut d.dynamics_x;
        put_column(a, POSITION, POSITION, &identity);
        put_column(a, POSITION, VELOCITY, &(identity * dt));
        put_column(a, VELOCITY, VELOCITY, &identity);
        put_column(a, ROTATION, ROTATION, &turn.next_from_body);
        put_column(a, ROTATION, OMEGA, &(turn.jacobian * dt));
        put_column(a, OMEGA, POSITION, &(inverse_inertia * force_b * dt));
        put_column(
            a,
            OMEGA,
            ROTATION,
            &(inverse_inertia * hat(&self.moment_b) * dt),
        );
        let gyration = hat(omega) * problem.inertia_b - hat(momentum);
        put_column(
            a,
            OMEGA,
            OMEGA,
            &(identity - inverse_inertia * gyration * dt),
        );
        for i in 0..PHASES {
            a[TIMES + i][TIMES + i] = T::ONE;
        }
        let by_time = &mut a[TIMES + self.phase];
        put(
            by_time,
            POSITION,
            &((state.vel_w + self.acceleration * dt) * rate),
        );
        put(by_time, VELOCITY, &(self.acceleration * rate));
        let turned = turn.jacobian * omega * rate;
        put(by_time, ROTATION, &turned);
        put(by_time, OMEGA, &(self.alpha * rate));
    }

    /// Second derivatives in the state: everything bilinear in the duration, and force × position or rotation.
    #[inline(always)]
    fn state_hessian<
        const FEET: usize,
        const PHASES: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        problem: &Problem<T, FEET, PHASES>,
        state: &State<T, PHASES>,
        shared: &Shared<T>,
        pull: &Pull<T>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let Self { dt, rate, .. } = *self;
        let time = TIMES + self.phase;
        let (q, m, omega) = (&pull.q, &self.moment_b, &state.omega_b);
        let h = &mut d.hessian_xx;
        put_column(h, POSITION, POSITION, &Matrix3::zeros());
        let mixed = hat(q) * shared.force_b * dt;
        put_column(h, ROTATION, POSITION, &mixed);
        put_column(h, POSITION, ROTATION, &mixed.transpose());
        let outer = (q * m.transpose() + m * q.transpose()) * T::HALF;
        let tilt = outer - Matrix3::from_diagonal_element(q.dot(m));
        put_column(h, ROTATION, ROTATION, &(tilt * dt));
        let spin = hat(q) * problem.inertia_b;
        put_column(h, OMEGA, OMEGA, &((spin + spin.transpose()) * dt));
        let on_time = [
            (POSITION, pull.z.cross(&self.force) * rate),
            (VELOCITY, pull.position * rate),
            (ROTATION, q.cross(m) * rate),
            (
                OMEGA,
                (q.cross(&shared.momentum) - problem.inertia_b * q.cross(omega)
                    + shared.turn.jacobian.transpose() * pull.rotation)
                    * rate,
            ),
        ];
        for (at, value) in on_time {
            put(&mut h[time], at, &value);
            for i in 0..3 {
                h[at + i][time] = value[i];
            }
        }
        h[time][time] = pull.position.dot(&self.acceleration) * rate * rate;
    }

    /// Jacobian and second derivatives in the forces.
    #[inline(always)]
    fn forces<
        const FEET: usize,
        const PHASES: usize,
        const NX: usize,
        const NU: usize,
        const NI: usize,
    >(
        &self,
        problem: &Problem<T, FEET, PHASES>,
        state: &State<T, PHASES>,
        inverse_inertia: &Matrix3<T>,
        pull: &Pull<T>,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let Self { dt, rate, .. } = *self;
        let time = TIMES + self.phase;
        let unit = force_unit(problem);
        let Some(data) = problem.phases.get(self.phase) else {
            return;
        };
        let in_contact = problem
            .feet
            .iter()
            .zip(&data.contacts)
            .filter(|(_, on)| **on);
        let (b_triples, _) = d.dynamics_u.as_chunks_mut::<3>();
        let (h_triples, _) = d.hessian_xu.as_chunks_mut::<3>();
        let (by_p, by_v) = (
            dt * dt * T::HALF / problem.mass * unit,
            dt / problem.mass * unit,
        );
        let linear = (pull.position * dt + pull.velocity) * (rate * unit / problem.mass);
        for (((foot, _), b), h) in in_contact.zip(b_triples).zip(h_triples) {
            let lever = foot.pos_wf - state.pos_w;
            let lever_b = state.rot_wb.transpose() * hat(&lever);
            let on_omega = inverse_inertia * lever_b * (dt * unit);
            let on_rotation = hat(&pull.q) * lever_b * (dt * unit);
            let on_position = hat(&pull.z) * (dt * unit);
            let on_time = linear - lever.cross(&pull.z) * (rate * unit);
            for j in 0..3 {
                b[j][POSITION + j] = by_p;
                b[j][VELOCITY + j] = by_v;
                put(&mut b[j], OMEGA, &on_omega.column(j).into_owned());
                put(&mut h[j], ROTATION, &on_rotation.column(j).into_owned());
                put(&mut h[j], POSITION, &on_position.column(j).into_owned());
                h[j][time] = on_time[j];
            }
        }
    }
}

/// What Jacobian and Hessian in the state share.
struct Shared<T: Scalar> {
    /// I⁻¹.
    inverse_inertia: Matrix3<T>,
    /// Rᵀ [Σ f]×.
    force_b: Matrix3<T>,
    /// I ω.
    momentum: Vector3<T>,
    turn: Turn<T>,
}

/// λ, in its parts.
struct Pull<T: Scalar> {
    position: Vector3<T>,
    velocity: Vector3<T>,
    rotation: Vector3<T>,
    /// I⁻¹ λ_ω.
    q: Vector3<T>,
    /// The same in world axes.
    z: Vector3<T>,
}

/// How rotation steps travel over an interval with the rotation gap `d`.
struct Turn<T: Scalar> {
    /// `Exp(d) Eᵀ`.
    next_from_body: Matrix3<T>,
    /// `Exp(d) J(ω dt)`.
    jacobian: Matrix3<T>,
}

/// From `Rᵀ R⁺ = E Exp(−d)`, without forming `Exp(d)`: it is `(Rᵀ R⁺)ᵀ E` up to the drift of Taylor's E.
#[inline(always)]
fn exp_inverse_times<T: Scalar>(
    turn: &Matrix3<T>,
    exponential: Exponential,
    w: &Vector3<T>,
) -> Turn<T> {
    let next_from_body = turn.transpose();
    Turn {
        next_from_body,
        jacobian: next_from_body * exponential.step(w) * exponential.jacobian(w),
    }
}
