//! Square matrices over all coordinates of a robot, stored by blocks.

use nalgebra::SMatrix;
use so3::{Scalar, math};

/// A (6 + N) × (6 + N) matrix over base and joint coordinates, each block by rows:
///
/// ```text
/// ⎡ base         base_joints ⎤   6
/// ⎣ joints_base  joints      ⎦   N
/// ```
///
/// Rows and columns are ordered as [`Tangent`](crate::Tangent) and [`Effort`](crate::Effort) are: base
/// linear, base angular, both in base axes, then joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockMatrix<T, const N: usize> {
    /// Rows of the base, columns of the base.
    pub base: [[T; 6]; 6],
    /// Rows of the base, columns of the joints.
    pub base_joints: [[T; N]; 6],
    /// Rows of the joints, columns of the base.
    pub joints_base: [[T; 6]; N],
    /// Rows of the joints, columns of the joints.
    pub joints: [[T; N]; N],
}

impl<T: Scalar, const N: usize> BlockMatrix<T, N> {
    /// All zero: also storage to be overwritten.
    pub const ZERO: Self = Self {
        base: [[T::ZERO; 6]; 6],
        base_joints: [[T::ZERO; N]; 6],
        joints_base: [[T::ZERO; 6]; N],
        joints: [[T::ZERO; N]; N],
    };

    /// Matrix times vector, base part first.
    #[inline]
    #[must_use]
    pub fn mul(&self, base: [T; 6], joints: &[T; N]) -> ([T; 6], [T; N]) {
        let (mut top, mut bottom) = ([T::ZERO; 6], [T::ZERO; N]);
        for ((y, left), right) in top.iter_mut().zip(&self.base).zip(&self.base_joints) {
            *y = dot(left, &base) + dot(right, joints);
        }
        for ((y, left), right) in bottom.iter_mut().zip(&self.joints_base).zip(&self.joints) {
            *y = dot(left, &base) + dot(right, joints);
        }
        (top, bottom)
    }

    /// As one dense matrix, base first. `V` must be 6 + N; other sizes do not compile.
    #[must_use]
    pub fn to_dense<const V: usize>(&self) -> SMatrix<T, V, V> {
        const { assert!(V == 6 + N, "a matrix over all coordinates has 6 + N rows") };
        let mut m: SMatrix<T, V, V> = SMatrix::zeros();
        let top = self.base.iter().zip(&self.base_joints);
        let bottom = self.joints_base.iter().zip(&self.joints);
        let rows = top
            .map(|(left, right)| left.iter().chain(right))
            .chain(bottom.map(|(left, right)| left.iter().chain(right)));
        for (mut to, from) in m.row_iter_mut().zip(rows) {
            for (x, &y) in to.iter_mut().zip(from) {
                *x = y;
            }
        }
        m
    }
}

impl<T: Scalar, const N: usize> Default for BlockMatrix<T, N> {
    fn default() -> Self {
        Self::ZERO
    }
}

#[inline(always)]
fn dot<T: Scalar, const K: usize>(a: &[T; K], b: &[T; K]) -> T {
    let mut sum = T::ZERO;
    for (&x, &y) in a.iter().zip(b) {
        sum = math::mul_add(x, y, sum);
    }
    sum
}

/// y ← y + a x.
#[inline(always)]
pub(crate) fn add_scaled<T: Scalar, const K: usize>(y: &mut [T; K], a: T, x: &[T; K]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y = math::mul_add(a, x, *y);
    }
}
