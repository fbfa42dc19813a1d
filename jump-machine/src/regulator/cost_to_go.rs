//! The least cost from an instant on, as a quadratic form of the body's error there, and Riccati's recursion in two steps: over time
//! without feedback ([`CostToGo::before`]), and with one force that may answer ([`CostToGo::answered`]).

use nalgebra::{ArrayStorage, Matrix3, SMatrix, SVector, Vector3};
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

impl<T: Scalar> Drift<T> {
    /// λ ← Aᵀ λ: the costate before, where it is λ after.
    fn before(&self, costate: &mut [T; ERRORS]) {
        let [px, py, pz, rx, ry, rz, vx, vy, vz, lx, ly, lz] = costate;
        let (place, rotation) = ([*px, *py, *pz], [*rx, *ry, *rz]);
        let pushed = transposed(&self.pushed, &[*lx, *ly, *lz]);
        let turns = transposed(&self.turns, &rotation);
        add([vx, vy, vz], place.map(|x| x * self.dt));
        add([px, py, pz], pushed);
        add([lx, ly, lz], turns);
        [*rx, *ry, *rz] = transposed(&self.turned, &rotation);
    }
}

/// mᵀ x.
fn transposed<T: Scalar>(m: &Matrix3<T>, [x, y, z]: &[T; 3]) -> [T; 3] {
    m.data.0.map(|[a, b, c]| a * *x + b * *y + c * *z)
}

/// Adds to three numbers.
fn add<T: Scalar>([x, y, z]: [&mut T; 3], [dx, dy, dz]: [T; 3]) {
    *x += dx;
    *y += dy;
    *z += dz;
}

/// xᵀ S x, the least cost from an instant on; S is symmetric.
#[derive(Clone, Debug)]
pub(super) struct CostToGo<T: Scalar>(SMatrix<T, ERRORS, ERRORS>);

impl<T: Scalar> CostToGo<T> {
    /// Nothing costs.
    pub(super) const ZERO: Self = Self(SMatrix::from_array_storage(ArrayStorage(
        [[T::ZERO; ERRORS]; ERRORS],
    )));

    /// Adds yᵀ W y, where y are the three rows of the error from `first` on.
    pub(super) fn add(&mut self, first: usize, w: &Matrix3<T>) {
        let columns = self.0.data.0.iter_mut().skip(first);
        for (to, w) in columns.zip(&w.data.0) {
            for (to, w) in to.iter_mut().skip(first).zip(w) {
                *to += *w;
            }
        }
    }

    /// The cost before an interval over which an error x becomes A x if nothing answers it: S ← Aᵀ S A.
    pub(super) fn before(&mut self, a: &Drift<T>) {
        // Aᵀ S first; the transpose of that is Sᵀ A, which is S A.
        for _ in 0..2 {
            for column in &mut self.0.data.0 {
                a.before(column);
            }
            self.0.transpose_mut();
        }
    }

    /// The cost where a force u may answer, which changes the momenta by b u and costs u²/g: the least over u of
    /// (x + b u)ᵀ S (x + b u) + u²/g, so S ← S − S b bᵀ S g/(1 + g bᵀ S b).
    ///
    /// Forces whose costs add up are taken one after the other, in any order: the least over all of them is the same. Nothing is inverted,
    /// and S stays positive.
    pub(super) fn answered(&mut self, b: &SVector<T, MOMENTA>, g: T) {
        let mut sb = [T::ZERO; ERRORS];
        for (column, b) in self.costate().zip(b) {
            for (sb, s) in sb.iter_mut().zip(column) {
                *sb += *s * *b;
            }
        }
        let along = sb.iter().skip(MOMENTA).zip(b);
        let along = along.fold(T::ZERO, |sum, (sb, b)| sum + *sb * *b);
        let weight = g / (T::ONE + g * along);
        for (column, x) in self.0.data.0.iter_mut().zip(&sb) {
            let x = *x * weight;
            for (s, sb) in column.iter_mut().zip(&sb) {
                *s -= *sb * x;
            }
        }
    }

    /// Λ by rows, those of S that belong to the momenta: λ = Λ x is half of what a unit of each momentum costs.
    pub(super) fn costate(&self) -> impl Iterator<Item = &[T; ERRORS]> {
        self.0.data.0.iter().skip(MOMENTA)
    }
}

/// Vectors one under the other.
pub(super) fn stack<T: Scalar, const P: usize, const R: usize>(
    parts: [Vector3<T>; P],
) -> SVector<T, R> {
    let parts = parts.map(<[T; 3]>::from);
    let mut to = [T::ZERO; R];
    for (to, x) in to.iter_mut().zip(parts.as_flattened()) {
        *to = *x;
    }
    to.into()
}
