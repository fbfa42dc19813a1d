//! The least cost from an instant on, as a quadratic form of the body's error there, and Riccati's recursion in two steps: over time
//! without feedback ([`CostToGo::before`]), and with one force that may answer ([`CostToGo::answered`]).

use nalgebra::{ArrayStorage, Matrix3, SVector, Vector3};
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

/// A column of S.
type Column<T> = SVector<T, ERRORS>;
/// The columns of a part of the error.
type Part<T> = [Column<T>; 3];

/// How an error goes on for a while if nothing answers it, A: δc + `dt` δv, `turned` δθ + `turns` δL, δv, δL + `pushed` δc.
#[derive(Clone, Debug)]
pub(super) struct Drift<T> {
    /// Time, s.
    pub(super) dt: T,
    /// What becomes of a rotation.
    pub(super) turned: Matrix3<T>,
    /// What an angular momentum turns.
    pub(super) turns: Matrix3<T>,
    /// The angular momentum that the planned forces give to a body that is aside.
    pub(super) pushed: Matrix3<T>,
}

/// xᵀ S x, the least cost from an instant on: S by its columns.
#[derive(Clone, Debug)]
pub(super) struct CostToGo<T: Scalar>([Part<T>; 4]);

impl<T: Scalar> CostToGo<T> {
    /// Nothing costs.
    pub(super) const ZERO: Self =
        Self([[Column::from_array_storage(ArrayStorage([[T::ZERO; ERRORS]])); 3]; 4]);

    /// Adds yᵀ W y, where y are the three rows of the error from `first` on.
    pub(super) fn add(&mut self, first: usize, w: &Matrix3<T>) {
        let columns = self.0.as_flattened_mut().iter_mut().skip(first);
        for (to, w) in columns.zip(w.column_iter()) {
            for (to, w) in to.iter_mut().skip(first).zip(&w) {
                *to += *w;
            }
        }
    }

    /// The cost before an interval over which an error x becomes A x if nothing answers it: S ← Aᵀ S A.
    pub(super) fn before(&mut self, a: &Drift<T>) {
        // (S A)ᵀ is Aᵀ S.
        for _ in 0..2 {
            self.0 = transposed(&after(&self.0, a));
        }
    }

    /// The cost where a force u may answer, which changes the momenta by b u and costs u²/g: the least over u of
    /// (x + b u)ᵀ S (x + b u) + u²/g, so S ← S − S b bᵀ S g/(1 + g bᵀ S b).
    ///
    /// Forces whose costs add up are taken one after the other, in any order: the least over all of them is the same. Nothing is inverted,
    /// and S stays positive.
    pub(super) fn answered(&mut self, b: &SVector<T, MOMENTA>, g: T) {
        let sb = self
            .momenta()
            .zip(b)
            .fold(Column::zeros(), |sum, (column, b)| sum + column * *b);
        let along = sb
            .iter()
            .skip(MOMENTA)
            .zip(b)
            .fold(T::ZERO, |sum, (sb, b)| sum + *sb * *b);
        let weight = g / (T::ONE + g * along);
        for (column, x) in self.0.as_flattened_mut().iter_mut().zip(&sb) {
            *column -= sb * (*x * weight);
        }
    }

    /// Λ, the rows of S that belong to the momenta, S being symmetric: λ = Λ x is half of what a unit of each momentum costs.
    pub(super) fn costate(&self) -> impl Iterator<Item = &Column<T>> {
        self.momenta()
    }

    /// The columns of the momenta.
    fn momenta(&self) -> impl Iterator<Item = &Column<T>> {
        self.0.as_flattened().iter().skip(MOMENTA)
    }
}

/// S A.
fn after<T: Scalar>(
    [place, rotation, velocity, angular]: &[Part<T>; 4],
    a: &Drift<T>,
) -> [Part<T>; 4] {
    [
        sum(place, &times(angular, &a.pushed)),
        times(rotation, &a.turned),
        sum(velocity, &place.map(|column| column * a.dt)),
        sum(angular, &times(rotation, &a.turns)),
    ]
}

/// The product of three columns and a matrix.
fn times<T: Scalar>([x, y, z]: &Part<T>, m: &Matrix3<T>) -> Part<T> {
    m.data.0.map(|[a, b, c]| x * a + y * b + z * c)
}

/// The sum of three columns each.
fn sum<T: Scalar>([x, y, z]: &Part<T>, [dx, dy, dz]: &Part<T>) -> Part<T> {
    [x + dx, y + dy, z + dz]
}

/// Rows for columns.
fn transposed<T: Scalar>(parts: &[Part<T>; 4]) -> [Part<T>; 4] {
    let mut to = CostToGo::ZERO.0;
    for (row, to) in to.as_flattened_mut().iter_mut().enumerate() {
        for (to, column) in to.iter_mut().zip(parts.as_flattened()) {
            *to = column.get(row).copied().unwrap_or_default();
        }
    }
    to
}

/// Vectors one under the other.
pub(super) fn stack<T: Scalar, const R: usize, const P: usize>(
    parts: &[Vector3<T>; P],
) -> SVector<T, R> {
    let mut to = SVector::<T, R>::zeros();
    for (to, x) in to.iter_mut().zip(parts.iter().flatten()) {
        *to = *x;
    }
    to
}
