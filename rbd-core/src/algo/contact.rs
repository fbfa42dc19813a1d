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

use super::blocks::add_scaled;
use super::jacobian::FrameJacobian;
use super::minv::{Columns, MassFactors};
use super::{at, put};
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
        let [x, y, z] = (*bias).into();
        Self::rows(jacobian, [x, y, z])
    }

    /// The six rows of a surface contact, linear first: its frame keeps its velocity. `bias` is the
    /// classical acceleration of the frame at ν̇ = 0.
    #[must_use]
    pub fn surface(jacobian: &FrameJacobian<T, N>, bias: &Motion<T>) -> [Self; 6] {
        Self::rows(jacobian, bias.to_array())
    }

    /// The first `R` rows of a Jacobian.
    #[inline(always)]
    fn rows<const R: usize>(jacobian: &FrameJacobian<T, N>, bias: [T; R]) -> [Self; R] {
        let mut rows = bias.map(|bias| Self { bias, ..Self::ZERO });
        let mut base = [[T::ZERO; 6]; R];
        for (k, column) in jacobian.base.iter().enumerate() {
            for (to, x) in base.iter_mut().zip(column.to_array()) {
                put(to, k, x);
            }
        }
        for (row, base) in rows.iter_mut().zip(base) {
            row.gradient.base = Force::from_array(base);
        }
        for (j, column) in jacobian.joints.iter().enumerate() {
            for (row, x) in rows.iter_mut().zip(column.to_array()) {
                put(&mut row.gradient.joints, j, x);
            }
        }
        rows
    }
}

/// Scratch for up to `K` rows, all zero before use.
#[derive(Clone, Copy, Debug)]
pub struct ContactWorkspace<T, const N: usize, const K: usize> {
    /// Jᵀ by rows: one column per constraint, so that all of them are solved for at once.
    columns: Columns<T, N, K>,
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
            columns: Columns::ZERO,
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
/// `free` is the acceleration without contact: from [`aba`](crate::aba) or, since the mass matrix is factored already,
/// [`MassFactors::solve`] of the effort less [`nonlinear_effects`](crate::nonlinear_effects). Rows beyond `K` are ignored.
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
    let rows = rows.get(..K).unwrap_or(rows);
    ws.columns = Columns::ZERO;
    for (i, row) in rows.iter().enumerate() {
        ws.columns.set(i, &row.gradient);
    }
    mass.delassus(&mut ws.columns, &mut ws.delassus);
    let diagonal = ws.delassus.iter().enumerate().map(|(i, row)| at(row, i));
    let largest = diagonal.fold(T::ZERO, |m, x| math::max(m, x));
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
        // W is symmetric: by columns, all rows at once.
        for (column, &f) in ws.delassus.iter().zip(&forces) {
            add_scaled(&mut rest, -f, column);
        }
        if rest.iter().all(|&r| math::abs(r) <= enough) {
            break;
        }
        let step = ldl_back_substitute(&ws.factors, rest);
        let (mut longest, mut size) = (T::ZERO, T::ZERO);
        for (f, dx) in forces.iter_mut().zip(step) {
            *f += dx;
            longest = math::max(longest, math::abs(dx));
            size = math::max(size, math::abs(*f));
        }
        // What rounding leaves of W λ is no reason for another step.
        if longest <= size * T::EPSILON * T::of(16.0) {
            break;
        }
    }

    let mut push = Effort::ZERO;
    for (row, &f) in rows.iter().zip(&forces) {
        push = push + row.gradient * f;
    }
    let motion = *free + mass.solve(&push);
    let rests = rows.iter().map(|row| math::abs(wanted(row, &motion)));
    let residual = rests.fold(T::ZERO, |m, x| math::max(m, x));
    ContactSolution {
        motion,
        forces,
        residual,
    }
}
