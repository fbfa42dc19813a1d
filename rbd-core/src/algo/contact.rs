//! Dynamics under contact: accelerations and forces at once, and impacts.
//!
//! Paper A eq. (4) with eq. (5): M ν̇ + C ν + g = τ + Jᵀ λ and J ν̇ + J̇ ν = 0 for the feet on the ground.
//! With the free acceleration ν̇₀ = M⁻¹(τ − C ν − g) and W = J M⁻¹ Jᵀ,
//!
//! W λ = −(J ν̇₀ + J̇ ν),  ν̇ = ν̇₀ + M⁻¹ Jᵀ λ.
//!
//! W is only semidefinite when rows depend on each other (two soles on the ground, a straight leg). It is
//! therefore never inverted: λ ← λ + (W + μ 1)⁻¹ (b − W λ), from λ = 0, converges to the solution of least
//! norm of a consistent system for any μ > 0, by a factor μ/(σ + μ) per step in the direction of an
//! eigenvalue σ > 0, and leaves λ at 0 where σ = 0. Rows that contradict each other show in the residual.

use nalgebra::Vector3;
use so3::{Scalar, math};

use super::jacobian::FrameJacobian;
use super::minv::MassFactors;
use crate::linear::{ldl_back_substitute, ldl_factor};
use crate::spatial::{Force, Motion};
use crate::state::{Effort, Tangent};

/// One scalar constraint on the acceleration: gradient · ν̇ + bias = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow<T, const N: usize> {
    /// Row of J: the effort of a unit constraint force.
    pub gradient: Effort<T, N>,
    /// Row of J̇ν, less the acceleration wanted, m/s² or rad/s².
    pub bias: T,
}

impl<T: Scalar, const N: usize> ContactRow<T, N> {
    /// A row that constrains nothing.
    pub const ZERO: Self = Self {
        gradient: Effort::ZERO,
        bias: T::ZERO,
    };

    /// The three rows of a point contact, x, y, z in the axes of the Jacobian: its point keeps its
    /// velocity. `bias` is the classical acceleration of the point at ν̇ = 0, in the same axes.
    #[must_use]
    pub fn point(jacobian: &FrameJacobian<T, N>, bias: &Vector3<T>) -> [Self; 3] {
        let bias = Motion::new(*bias, Vector3::zeros());
        let [x, y, z, ..] = Self::surface(jacobian, &bias);
        [x, y, z]
    }

    /// The six rows of a surface contact, linear first: its frame keeps its velocity. `bias` is the
    /// classical acceleration of the frame at ν̇ = 0.
    #[must_use]
    pub fn surface(jacobian: &FrameJacobian<T, N>, bias: &Motion<T>) -> [Self; 6] {
        let mut rows = [Self::ZERO; 6];
        for ((i, row), bias) in rows.iter_mut().enumerate().zip(bias.to_array()) {
            let mut unit = [T::ZERO; 6];
            super::put(&mut unit, i, T::ONE);
            *row = Self {
                gradient: jacobian.tr_mul(&Force::from_array(unit)),
                bias,
            };
        }
        rows
    }
}

/// Scratch for up to `K` rows, all zero before use.
#[derive(Clone, Copy, Debug)]
pub struct ContactWorkspace<T, const N: usize, const K: usize> {
    /// M⁻¹ Jᵀ.
    answers: [Tangent<T, N>; K],
    /// W = J M⁻¹ Jᵀ.
    delassus: [[T; K]; K],
    /// Factors of W + μ 1.
    factors: [[T; K]; K],
}

impl<T: Scalar, const N: usize, const K: usize> ContactWorkspace<T, N, K> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            answers: [Tangent::ZERO; K],
            delassus: [[T::ZERO; K]; K],
            factors: [[T::ZERO; K]; K],
        }
    }
}

impl<T: Scalar, const N: usize, const K: usize> Default for ContactWorkspace<T, N, K> {
    fn default() -> Self {
        Self::new()
    }
}

/// What contact does to a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSolution<T, const N: usize, const K: usize> {
    /// Acceleration ν̇ (velocity after the impact).
    pub motion: Tangent<T, N>,
    /// Constraint force of each row, N or N m (impulse, N s or N m s); zero beyond the rows given.
    pub forces: [T; K],
    /// Largest |J ν̇ + J̇ν| left, m/s²: not near zero when rows contradict each other.
    pub residual: T,
}

/// Most corrections of λ.
const STEPS: usize = 12;

/// Forward dynamics under contact, paper A eq. (4) and (5).
///
/// `free` is the acceleration without contact, for example from [`aba`](crate::aba). Rows beyond `K` are
/// ignored.
#[must_use]
pub fn contact_dynamics<T: Scalar, const N: usize, const K: usize>(
    mass: &MassFactors<T, N>,
    free: &Tangent<T, N>,
    rows: &[ContactRow<T, N>],
    ws: &mut ContactWorkspace<T, N, K>,
) -> ContactSolution<T, N, K> {
    project(
        mass,
        free,
        rows,
        |row, motion| -(motion.dot(&row.gradient) + row.bias),
        ws,
    )
}

/// Impulsive contact: the velocity just after the rows hit the ground with `velocity`.
///
/// J ν⁺ = −e J ν⁻ with restitution e in [0, 1]; M (ν⁺ − ν⁻) = Jᵀ λ. With e = 0, kinetic energy never
/// grows. The `bias` of the rows is not used.
#[must_use]
pub fn impact<T: Scalar, const N: usize, const K: usize>(
    mass: &MassFactors<T, N>,
    velocity: &Tangent<T, N>,
    restitution: T,
    rows: &[ContactRow<T, N>],
    ws: &mut ContactWorkspace<T, N, K>,
) -> ContactSolution<T, N, K> {
    let rebound = |row: &ContactRow<T, N>| restitution * velocity.dot(&row.gradient);
    project(
        mass,
        velocity,
        rows,
        |row, motion| -(motion.dot(&row.gradient) + rebound(row)),
        ws,
    )
}

/// Adds M⁻¹ Jᵀ λ to `free` so that `wanted`, the change each row still needs, vanishes.
#[inline(always)]
fn project<T: Scalar, const N: usize, const K: usize>(
    mass: &MassFactors<T, N>,
    free: &Tangent<T, N>,
    rows: &[ContactRow<T, N>],
    wanted: impl Fn(&ContactRow<T, N>, &Tangent<T, N>) -> T,
    ws: &mut ContactWorkspace<T, N, K>,
) -> ContactSolution<T, N, K> {
    for (answer, row) in ws.answers.iter_mut().zip(rows) {
        *answer = mass.solve(&row.gradient);
    }
    let mut largest = T::ZERO;
    ws.delassus = [[T::ZERO; K]; K];
    for ((i, to), row) in ws.delassus.iter_mut().enumerate().zip(rows) {
        for (x, answer) in to.iter_mut().zip(&ws.answers).take(rows.len()) {
            *x = answer.dot(&row.gradient);
        }
        largest = math::max(largest, super::at(to, i));
    }
    let damping = largest * math::sqrt(T::EPSILON);
    ws.factors = ws.delassus;
    for (i, row) in ws.factors.iter_mut().enumerate() {
        if let Some(diagonal) = row.get_mut(i) {
            *diagonal += if i < rows.len() && damping > T::ZERO {
                damping
            } else {
                T::ONE
            };
        }
    }
    ldl_factor(&mut ws.factors);

    let mut goal = [T::ZERO; K];
    for (b, row) in goal.iter_mut().zip(rows) {
        *b = wanted(row, free);
    }
    let scale = goal
        .iter()
        .fold(T::ZERO, |m, &x| math::max(m, math::abs(x)));
    let enough = scale * T::EPSILON * T::of(16.0);
    let mut forces = [T::ZERO; K];
    for _ in 0..STEPS {
        let mut rest = goal;
        for (r, row) in rest.iter_mut().zip(&ws.delassus) {
            for (&w, &f) in row.iter().zip(&forces) {
                *r -= w * f;
            }
        }
        if rest.iter().all(|&r| math::abs(r) <= enough) {
            break;
        }
        let step = ldl_back_substitute(&ws.factors, rest);
        for (f, dx) in forces.iter_mut().zip(step) {
            *f += dx;
        }
    }

    let mut motion = *free;
    for (answer, &f) in ws.answers.iter().zip(&forces).take(rows.len()) {
        motion = motion + *answer * f;
    }
    let rests = rows
        .iter()
        .take(K)
        .map(|row| math::abs(wanted(row, &motion)));
    let residual = rests.fold(T::ZERO, |m, x| math::max(m, x));
    ContactSolution {
        motion,
        forces,
        residual,
    }
}
