//! State of a node and the layout of its tangent space.

use crate::rotation::{exp, inverse, log};
use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

/// First tangent coordinate of the position.
pub const POSITION: usize = 0;
/// First tangent coordinate of the velocity.
pub const VELOCITY: usize = 3;
/// First tangent coordinate of the rotation, `R Exp(θ)`.
pub const ROTATION: usize = 6;
/// First tangent coordinate of the angular velocity.
pub const OMEGA: usize = 9;
/// First tangent coordinate of the phase durations.
pub const TIMES: usize = 12;

/// State of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T: Scalar, const PHASES: usize> {
    /// Centre of mass in the world, m.
    pub pos_w: Vector3<T>,
    /// Its velocity in the world, m/s.
    pub vel_w: Vector3<T>,
    /// Rotation from body to world. A product of Taylor exponentials, so orthogonal only up to their order.
    pub rot_wb: Matrix3<T>,
    /// Angular velocity in the body frame, rad/s.
    pub omega_b: Vector3<T>,
    /// Phase durations, s; equal at all nodes of a solution.
    pub durations: [T; PHASES],
    /// What the previous node's rotation still misses: `R⁺ = R E4(ω dt) Exp(−gap)`.
    pub(crate) rotation_gap: Vector3<T>,
    /// Sine and cosine of the reference turn angle.
    pub(crate) reference: (T, T),
}

impl<T: Scalar, const PHASES: usize> State<T, PHASES> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        let zero = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        Self {
            pos_w: zero,
            vel_w: zero,
            rot_wb: Matrix3::new(
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
                T::ZERO,
            ),
            omega_b: zero,
            durations: [T::ZERO; PHASES],
            rotation_gap: zero,
            reference: (T::ZERO, T::ZERO),
        }
    }

    /// Moves the state by a tangent step, the rotation excepted.
    #[inline(always)]
    pub(crate) fn moved<const NX: usize>(&self, step: &[T; NX]) -> Self {
        let part = |at: usize| Vector3::new(step[at], step[at + 1], step[at + 2]);
        let mut out = *self;
        out.pos_w += part(POSITION);
        out.vel_w += part(VELOCITY);
        out.omega_b += part(OMEGA);
        for (duration, step) in out.durations.iter_mut().zip(step.iter().skip(TIMES)) {
            *duration += *step;
        }
        out
    }

    /// Gives the state the rotation `wanted`, expressed through the rotation `reached = R E(ω dt)` of the
    /// interval before, and the gap to it.
    ///
    /// Taylor's E is not orthogonal, so the nodes' matrices form a chain `R⁺ = R E Exp(−gap)`: only then do
    /// all nine rows of the reference problem vanish with the gap.
    #[inline(always)]
    pub(crate) fn attach(&mut self, wanted: &Matrix3<T>, reached: &Matrix3<T>) {
        self.rotation_gap = log(&(inverse(wanted) * reached));
        self.rot_wb = reached * exp(&-self.rotation_gap);
    }
}

impl<T: Scalar, const PHASES: usize> Default for State<T, PHASES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Writes a vector into coordinates `at ..`.
#[inline(always)]
pub(crate) fn put<T: Scalar, const N: usize>(out: &mut [T; N], at: usize, v: &Vector3<T>) {
    for i in 0..3 {
        out[at + i] = v[i];
    }
}

/// Writes a 3 × 3 block at row `row`, column `column` of a column-major matrix.
#[inline(always)]
pub(crate) fn put_column<T: Scalar, const R: usize, const C: usize>(
    out: &mut [[T; R]; C],
    row: usize,
    column: usize,
    block: &Matrix3<T>,
) {
    for j in 0..3 {
        put(&mut out[column + j], row, &block.column(j).into_owned());
    }
}

/// Adds a 3 × 3 block.
#[inline(always)]
pub(crate) fn add_block<T: Scalar, const R: usize, const C: usize>(
    out: &mut [[T; R]; C],
    row: usize,
    column: usize,
    block: &Matrix3<T>,
) {
    for j in 0..3 {
        for i in 0..3 {
            out[column + j][row + i] += block[(i, j)];
        }
    }
}
