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

/// How an error goes on for a while if nothing answers it, A x + p d, of a robot that carries p: δc + `dt` δv, `turned` δθ + `turns` δL, δv,
/// δL + `pushed` δc + p `loaded`.
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
    /// The angular momentum that the planned forces give to a body with a load of its own mass, beyond the plan's.
    pub(super) loaded: Vector3<T>,
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

/// to ← to − x `by`.
fn subtract<T: Scalar>(to: &mut [T; ERRORS], x: &[T; ERRORS], by: T) {
    for (to, x) in to.iter_mut().zip(x) {
        *to -= *x * by;
    }
}

/// Adds to three numbers.
fn add<T: Scalar>([x, y, z]: [&mut T; 3], [dx, dy, dz]: [T; 3]) {
    *x += dx;
    *y += dy;
    *z += dz;
}

/// xᵀ S x + 2 p sᵀ x, the least cost from an instant on, but for what no error changes; S is symmetric.
#[derive(Clone, Debug)]
pub(super) struct CostToGo<T: Scalar> {
    /// S.
    of_errors: SMatrix<T, ERRORS, ERRORS>,
    /// s.
    of_load: [T; ERRORS],
}

impl<T: Scalar> CostToGo<T> {
    /// Nothing costs.
    pub(super) const ZERO: Self = Self {
        of_errors: SMatrix::from_array_storage(ArrayStorage([[T::ZERO; ERRORS]; ERRORS])),
        of_load: [T::ZERO; ERRORS],
    };

    /// Adds yᵀ W y, where y are the three rows of the error from `first` on.
    pub(super) fn add(&mut self, first: usize, w: &Matrix3<T>) {
        let columns = self.of_errors.data.0.iter_mut().skip(first);
        for (to, w) in columns.zip(&w.data.0) {
            for (to, w) in to.iter_mut().skip(first).zip(w) {
                *to += *w;
            }
        }
    }

    /// The cost before an interval over which an error x becomes A x + p d if nothing answers it: S ← Aᵀ S A and s ← Aᵀ (s + S d).
    pub(super) fn before(&mut self, a: &Drift<T>) {
        let angular = self.of_errors.data.0.iter().skip(ANGULAR);
        for (column, d) in angular.zip(&a.loaded) {
            for (s, x) in self.of_load.iter_mut().zip(column) {
                *s += *x * *d;
            }
        }
        a.before(&mut self.of_load);
        // Aᵀ S first; the transpose of that is Sᵀ A, which is S A.
        for _ in 0..2 {
            for column in &mut self.of_errors.data.0 {
                a.before(column);
            }
            self.of_errors.transpose_mut();
        }
    }

    /// The cost where a force u may answer, which changes the momenta by b u and costs u²/g: the least over u of
    /// (x + b u)ᵀ S (x + b u) + 2 p sᵀ (x + b u) + u²/g, so S ← S − S b bᵀ S w and s ← s − S b bᵀ s w with w = g/(1 + g bᵀ S b).
    ///
    /// Forces whose costs add up are taken one after the other, in any order: the least over all of them is the same. Nothing is inverted,
    /// and S stays positive.
    pub(super) fn answered(&mut self, b: &SVector<T, MOMENTA>, g: T) {
        let mut sb = [T::ZERO; ERRORS];
        for (column, b) in self.of_errors.data.0.iter().skip(MOMENTA).zip(b) {
            for (sb, s) in sb.iter_mut().zip(column) {
                *sb += *s * *b;
            }
        }
        let along = |x: &[T; ERRORS]| {
            let pairs = x.iter().skip(MOMENTA).zip(b);
            pairs.fold(T::ZERO, |sum, (x, b)| sum + *x * *b)
        };
        let weight = g / (T::ONE + g * along(&sb));
        let of_load = along(&self.of_load);
        for (column, x) in self.of_errors.data.0.iter_mut().zip(&sb) {
            subtract(column, &sb, *x * weight);
        }
        subtract(&mut self.of_load, &sb, of_load * weight);
    }

    /// Λ by rows, those of (S, s) that belong to the momenta: λ = Λ (x, p) is half of what a unit of each momentum costs.
    pub(super) fn costate(&self) -> impl Iterator<Item = (&[T; ERRORS], T)> {
        let rows = self.of_errors.data.0.iter().zip(self.of_load);
        rows.skip(MOMENTA)
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
