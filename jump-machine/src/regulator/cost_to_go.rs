//! The least cost from an instant on, as a quadratic form of the body's error there, and Riccati's recursion in two steps: over time
//! without feedback ([`CostToGo::before`]), and with one force that may answer ([`CostToGo::answered`]).

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use so3::Scalar;

/// Rows of the error x = (δc, δθ, δv, δL): place of the centre of mass, m; rotation, rad; velocity of the centre of mass, m/s; angular
/// momentum about it, N m s; all in world axes.
pub(super) const ERRORS: usize = 12;
/// The last six rows, (δv, δL), are all that forces change; the first of them is this one too.
pub(super) const MOMENTA: usize = 6;

/// First rows of the parts of the error.
pub(super) const PLACE: usize = 0;
pub(super) const ROTATION: usize = 3;
pub(super) const VELOCITY: usize = 6;
pub(super) const ANGULAR: usize = 9;

/// xᵀ S x, the least cost from an instant on.
#[derive(Clone, Debug)]
pub(super) struct CostToGo<T: Scalar>(SMatrix<T, ERRORS, ERRORS>);

impl<T: Scalar> CostToGo<T> {
    /// Nothing costs.
    pub(super) fn zero() -> Self {
        Self(SMatrix::zeros())
    }

    /// Adds yᵀ W y, where y are the three rows of the error from `first` on.
    pub(super) fn add(&mut self, first: usize, w: &Matrix3<T>) {
        for column in 0..3 {
            for row in 0..3 {
                let to = self.0.get_mut((first + row, first + column));
                if let (Some(to), Some(w)) = (to, w.get((row, column))) {
                    *to += *w;
                }
            }
        }
    }

    /// The cost before an interval over which an error x becomes A x if nothing answers it: S ← Aᵀ S A.
    pub(super) fn before(&mut self, a: &SMatrix<T, ERRORS, ERRORS>) {
        let ahead = product(&self.0, a);
        self.0 = product(&a.transpose(), &ahead);
    }

    /// The cost where a force u may answer, which changes the momenta by b u and costs u²/g: the least over u of
    /// (x + b u)ᵀ S (x + b u) + u²/g, so S ← S − S b bᵀ S g/(1 + g bᵀ S b).
    ///
    /// Forces whose costs add up are taken one after the other, in any order: the least over all of them is the same. Nothing is inverted,
    /// and S stays positive.
    pub(super) fn answered(&mut self, b: &SVector<T, MOMENTA>, g: T) {
        let sb: SVector<T, ERRORS> = SVector::from_fn(|row, _| {
            let terms = b.iter().enumerate();
            terms.fold(T::ZERO, |sum, (k, b)| {
                sum + at(&self.0, row, MOMENTA + k) * *b
            })
        });
        let along = (0..MOMENTA).fold(T::ZERO, |sum, k| {
            sum + at(&sb, MOMENTA + k, 0) * at(b, k, 0)
        });
        let weight = g / (T::ONE + g * along);
        self.0 = SMatrix::from_fn(|row, column| {
            at(&self.0, row, column) - at(&sb, row, 0) * (at(&sb, column, 0) * weight)
        });
    }

    /// Λ, the rows of S that belong to the momenta: λ = Λ x is half of what a unit of each momentum costs.
    pub(super) fn costate(&self) -> SMatrix<T, MOMENTA, ERRORS> {
        SMatrix::from_fn(|row, column| at(&self.0, MOMENTA + row, column))
    }
}

/// An entry; 0 outside, since the compiler does not see that no index is.
pub(super) fn at<T: Scalar, const R: usize, const C: usize>(
    m: &SMatrix<T, R, C>,
    row: usize,
    column: usize,
) -> T {
    m.get((row, column)).copied().unwrap_or_default()
}

/// The product of two matrices, without a bound to check: the link proves that nothing here panics.
pub(super) fn product<T: Scalar, const R: usize, const C: usize>(
    left: &SMatrix<T, R, ERRORS>,
    right: &SMatrix<T, ERRORS, C>,
) -> SMatrix<T, R, C> {
    SMatrix::from_fn(|row, column| {
        (0..ERRORS).fold(T::ZERO, |sum, k| {
            sum + at(left, row, k) * at(right, k, column)
        })
    })
}

/// Vectors one under the other.
pub(super) fn stack<T: Scalar, const R: usize, const P: usize>(
    parts: &[Vector3<T>; P],
) -> SVector<T, R> {
    SVector::from_fn(|row, _| {
        let part = parts.get(row / 3);
        part.map_or(T::ZERO, |part| at(part, row % 3, 0))
    })
}

/// Writes a block into the rows and columns from `row` and `column` on.
pub(super) fn put<T: Scalar>(
    to: &mut SMatrix<T, ERRORS, ERRORS>,
    (row, column): (usize, usize),
    block: &Matrix3<T>,
) {
    for j in 0..3 {
        for i in 0..3 {
            if let Some(entry) = to.get_mut((row + i, column + j)) {
                *entry = at(block, i, j);
            }
        }
    }
}
