//! A flip without legs: a quadrotor turns once about its x axis in free time and hovers again.
//!
//! Paper A claims its planner for thrust-vectored bodies too. The same rigid body is driven here by a
//! thrust `F` along the body's z axis and a moment `τ`; the duration `T` is a state, as in srb-opt:
//!
//! ```text
//! p⁺ = p + dt v + ½ dt² a,   v⁺ = v + dt a,          a = R e_z F/m − g e_z,   dt = T/N
//! R⁺ = R Exp(ω dt),          ω⁺ = ω + dt I⁻¹ (τ − ω × I ω)
//! ```

use core::ops::ControlFlow;
use nalgebra::{Matrix3, Vector3};
use ocp_solver::{
    Derivatives, Dims, Evaluated, Problem, Settings, Solution, Solver, Stage, Values,
};
use so3::{Rotation3, exp, hat, log, right_jacobian};

const N: usize = 60;
const NX: usize = 16;
const NU: usize = 4;
const NI: usize = 16;
/// First tangent coordinates: position 0, velocity 3, rotation 6, angular velocity 9, duration 12.
const TIME: usize = 12;

const MASS: f64 = 0.8;
const GRAVITY: f64 = 9.81;
/// Twice the weight.
const MAX_THRUST: f64 = 16.0;
const MAX_MOMENT: f64 = 0.25;
const TURN: f64 = 2.0 * core::f64::consts::PI;

/// State of a node.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Position in the world, m.
    pub pos_w: Vector3<f64>,
    /// Velocity in the world, m/s.
    pub vel_w: Vector3<f64>,
    /// Rotation from body to world.
    pub rot_wb: Rotation3<f64>,
    /// Angular velocity in the body frame, rad/s.
    pub omega_b: Vector3<f64>,
    /// Duration of the flip, s.
    pub duration: f64,
}

/// The flip; least `T` plus a little effort.
pub struct Flip;

fn inertia() -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(0.004, 0.004, 0.007))
}

fn inverse_inertia() -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(1.0 / 0.004, 1.0 / 0.004, 1.0 / 0.007))
}

/// Accelerations at a node.
struct Motion {
    dt: f64,
    lift_w: Vector3<f64>,
    acceleration: Vector3<f64>,
    alpha: Vector3<f64>,
}

impl Motion {
    fn new(x: &State, u: &[f64; NU]) -> Self {
        let lift_w = x.rot_wb * Vector3::z() / MASS;
        let moment = Vector3::new(u[1], u[2], u[3]);
        Self {
            dt: x.duration / N as f64,
            lift_w,
            acceleration: lift_w * u[0] - Vector3::z() * GRAVITY,
            alpha: inverse_inertia() * (moment - x.omega_b.cross(&(inertia() * x.omega_b))),
        }
    }
}

fn put(out: &mut [f64], at: usize, v: &Vector3<f64>) {
    out[at..at + 3].copy_from_slice(v.as_slice());
}

fn put_block(out: &mut [[f64; NX]], row: usize, column: usize, m: &Matrix3<f64>) {
    for j in 0..3 {
        put(&mut out[column + j], row, &m.column(j).into_owned());
    }
}

impl Problem<f64, NX, NU, NI> for Flip {
    type State = State;

    fn intervals(&self) -> usize {
        N
    }

    fn dims(&self, k: usize) -> Dims {
        let end = k == N;
        let state_rows = if end { 12 } else { usize::from(k == 0) };
        let controls = if end { 0 } else { NU };
        Dims {
            controls,
            state_rows,
            control_rows: controls,
            mixed_rows: 0,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; NI], upper: &mut [f64; NI]) {
        if k == N {
            return; // All twelve rows are zero at the end: the same hover, one turn later.
        }
        let mut at = 0;
        if k == 0 {
            (lower[0], upper[0], at) = (0.2, 3.0, 1);
        }
        (lower[at], upper[at]) = (0.0, MAX_THRUST);
        for i in at + 1..at + 4 {
            (lower[i], upper[i]) = (-MAX_MOMENT, MAX_MOMENT);
        }
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        i == TIME
    }

    fn retract(
        &self,
        _: usize,
        x: &State,
        d: &[f64; NX],
        _: Option<(&State, &[f64; NU])>,
    ) -> State {
        let part = |at: usize| Vector3::new(d[at], d[at + 1], d[at + 2]);
        State {
            pos_w: x.pos_w + part(0),
            vel_w: x.vel_w + part(3),
            rot_wb: x.rot_wb * exp(&part(6)),
            omega_b: x.omega_b + part(9),
            duration: x.duration + d[TIME],
        }
    }

    fn evaluate(
        &self,
        k: usize,
        x: &State,
        u: &[f64; NU],
        next: Option<&State>,
        values: &mut Values<f64, NX, NI>,
    ) {
        let Some(next) = next else {
            values.cost = x.duration;
            put(&mut values.rows, 0, &x.pos_w);
            put(&mut values.rows, 3, &x.vel_w);
            put(&mut values.rows, 6, &log(&x.rot_wb));
            put(&mut values.rows, 9, &x.omega_b);
            return;
        };
        let m = Motion::new(x, u);
        let w = x.omega_b * m.dt;
        put(
            &mut values.gap,
            0,
            &(x.pos_w + (x.vel_w + m.acceleration * (m.dt / 2.0)) * m.dt - next.pos_w),
        );
        put(
            &mut values.gap,
            3,
            &(x.vel_w + m.acceleration * m.dt - next.vel_w),
        );
        put(
            &mut values.gap,
            6,
            &log(&(next.rot_wb.inverse() * x.rot_wb * exp(&w))),
        );
        put(
            &mut values.gap,
            9,
            &(x.omega_b + m.alpha * m.dt - next.omega_b),
        );
        values.gap[TIME] = x.duration - next.duration;
        values.cost = effort(u);
        let at = usize::from(k == 0);
        values.rows[0] = x.duration;
        values.rows[at..at + NU].copy_from_slice(u);
    }

    fn differentiate(
        &self,
        k: usize,
        x: &State,
        u: &[f64; NU],
        next: Option<&State>,
        at: Evaluated<'_, f64, NX, NI>,
        d: &mut Derivatives<f64, NX, NU, NI>,
    ) {
        let Some(next) = next else {
            return differentiate_end(x, d);
        };
        let flow = Flow::new(x, u, next);
        flow.jacobian(x, u, d);
        flow.hessian(x, u, at.dynamics_multiplier, d);

        let scale = [MAX_THRUST, MAX_MOMENT, MAX_MOMENT, MAX_MOMENT];
        let first = usize::from(k == 0);
        for i in 0..NU {
            let weight = 2.0 * EFFORT / (scale[i] * scale[i]);
            (d.cost_u[i], d.hessian_uu[i][i]) = (weight * u[i], weight);
            d.rows_u[first + i][i] = 1.0;
        }
        if k == 0 {
            d.rows_x[0][TIME] = 1.0;
        }
    }
}

/// One interval's dynamics, and what their first and second derivatives share.
struct Flow {
    motion: Motion,
    /// ∂(rotation gap)/∂(rotation): multiplied by it the rows are exact for large gaps as well.
    turn: Matrix3<f64>,
    /// ∂(rotation gap)/∂(ω dt).
    jacobian: Matrix3<f64>,
    /// I⁻¹ ∂(ω × I ω)/∂ω.
    gyration: Matrix3<f64>,
}

impl Flow {
    fn new(x: &State, u: &[f64; NU], next: &State) -> Self {
        let motion = Motion::new(x, u);
        let w = x.omega_b * motion.dt;
        let turn = (x.rot_wb.inverse() * next.rot_wb).inverse().into_inner();
        let momentum = inertia() * x.omega_b;
        Self {
            motion,
            turn,
            jacobian: turn * exp(&w).into_inner() * right_jacobian(&w),
            gyration: inverse_inertia() * (hat(&x.omega_b) * inertia() - hat(&momentum)),
        }
    }

    /// Jacobian of the gap.
    fn jacobian(&self, x: &State, u: &[f64; NU], d: &mut Derivatives<f64, NX, NU, NI>) {
        let (m, jacobian) = (&self.motion, &self.jacobian);
        let (dt, share, one) = (m.dt, 1.0 / N as f64, Matrix3::identity());
        let thrust_b = -hat(&Vector3::z()) * (u[0] / MASS);
        let by_rotation = x.rot_wb.matrix() * thrust_b;

        let a = &mut d.dynamics_x;
        put_block(a, 0, 0, &one);
        put_block(a, 0, 3, &(one * dt));
        put_block(a, 0, 6, &(by_rotation * (dt * dt / 2.0)));
        put_block(a, 3, 3, &one);
        put_block(a, 3, 6, &(by_rotation * dt));
        put_block(a, 6, 6, &self.turn);
        put_block(a, 6, 9, &(jacobian * dt));
        put_block(a, 9, 9, &(one - self.gyration * dt));
        put(&mut a[TIME], 0, &((x.vel_w + m.acceleration * dt) * share));
        put(&mut a[TIME], 3, &(m.acceleration * share));
        put(&mut a[TIME], 6, &(jacobian * x.omega_b * share));
        put(&mut a[TIME], 9, &(m.alpha * share));
        a[TIME][TIME] = 1.0;
        put(&mut d.dynamics_u[0], 0, &(m.lift_w * (dt * dt / 2.0)));
        put(&mut d.dynamics_u[0], 3, &(m.lift_w * dt));
        for j in 0..3 {
            put(
                &mut d.dynamics_u[1 + j],
                9,
                &(inverse_inertia().column(j) * dt),
            );
        }
    }

    /// Hessian of the gap times its multipliers `l`: bilinear in the duration, and thrust × rotation.
    fn hessian(
        &self,
        x: &State,
        u: &[f64; NU],
        l: &[f64; NX],
        d: &mut Derivatives<f64, NX, NU, NI>,
    ) {
        let (m, jacobian) = (&self.motion, &self.jacobian);
        let (dt, share, one) = (m.dt, 1.0 / N as f64, Matrix3::identity());
        let part = |at: usize| Vector3::new(l[at], l[at + 1], l[at + 2]);
        let (l_p, l_v, l_r, l_w) = (part(0), part(3), part(6), part(9));
        let push_b = x.rot_wb.inverse() * (l_v * dt + l_p * (dt * dt / 2.0)) / MASS;
        let rate_b = x.rot_wb.inverse() * (l_v + l_p * dt) * (share / MASS);
        let z = Vector3::z();
        let h = &mut d.hessian_xx;
        let bend = (push_b * z.transpose() + z * push_b.transpose()) / 2.0;
        put_block(
            h,
            6,
            6,
            &((bend - Matrix3::from_diagonal_element(push_b.z)) * u[0]),
        );
        let q = inverse_inertia() * l_w;
        let spin = hat(&q) * inertia();
        put_block(h, 9, 9, &((spin + spin.transpose()) * dt));
        let on_time = [
            (3, l_p * share),
            (6, z.cross(&rate_b) * u[0]),
            (
                9,
                (jacobian.transpose() * l_r + l_w - (one + self.gyration.transpose()) * l_w)
                    * share,
            ),
        ];
        for (row, value) in on_time {
            put(&mut h[TIME], row, &value);
            for i in 0..3 {
                h[row + i][TIME] = value[i];
            }
        }
        h[TIME][TIME] = share * share * l_p.dot(&m.acceleration);
        put(&mut d.hessian_xu[0], 6, &z.cross(&push_b));
        d.hessian_xu[0][TIME] = rate_b.z;
        for j in 0..3 {
            d.hessian_xu[1 + j][TIME] = share * q[j];
        }
    }
}

/// The last node: the duration is the cost, and the state is where it should be.
fn differentiate_end(x: &State, d: &mut Derivatives<f64, NX, NU, NI>) {
    d.cost_x[TIME] = 1.0;
    for i in 0..12 {
        d.rows_x[i][i] = 1.0;
    }
    let by_rotation = so3::right_jacobian_inverse(&log(&x.rot_wb));
    for i in 0..3 {
        put(&mut d.rows_x[6 + i], 6, &by_rotation.row(i).transpose());
    }
}

/// Weight of the effort per node, s.
const EFFORT: f64 = 1e-4;

fn effort(u: &[f64; NU]) -> f64 {
    let moments = (u[1] * u[1] + u[2] * u[2] + u[3] * u[3]) / (MAX_MOMENT * MAX_MOMENT);
    EFFORT * (u[0] * u[0] / (MAX_THRUST * MAX_THRUST) + moments)
}

/// A node of the flip.
pub type Node = Stage<f64, State, NX, NU, NI>;

/// Plans the flip from a uniform turn at hover thrust.
///
/// # Errors
/// None for this problem; the solver checks its input.
pub fn plan() -> Result<(Solution<f64>, Vec<Node>), ocp_solver::Error> {
    let duration = 1.0;
    let mut stages: Vec<_> = (0..=N)
        .map(|k| {
            let inside = k > 0 && k < N;
            let state = State {
                pos_w: Vector3::zeros(),
                vel_w: Vector3::zeros(),
                rot_wb: exp(&(Vector3::x() * (TURN * k as f64 / N as f64))),
                omega_b: Vector3::x() * if inside { TURN / duration } else { 0.0 },
                duration,
            };
            let mut stage = Stage::new(state);
            stage.control[0] = MASS * GRAVITY;
            stage
        })
        .collect();
    let solution =
        Solver::new(Settings::new()).solve(&Flip, &mut stages, |_| ControlFlow::Continue(()))?;
    Ok((solution, stages))
}

/// Total turn of a plan about the body's x axis, rad.
#[must_use]
pub fn turned(stages: &[Node]) -> f64 {
    stages
        .iter()
        .take(N)
        .map(|s| s.state.omega_b.x * s.state.duration / N as f64)
        .sum()
}

fn main() -> Result<(), ocp_solver::Error> {
    let (solution, stages) = plan()?;
    let highest = stages
        .iter()
        .map(|stage| stage.state.pos_w.z)
        .fold(0.0, f64::max);
    println!(
        "{:?} in {} iterations: one turn of {:.4} rad in {:.3} s, climbing {:.2} m, violation {:.1e}",
        solution.status,
        solution.iterations,
        turned(&stages),
        stages[0].state.duration,
        highest,
        solution.residual.primal
    );
    Ok(())
}
