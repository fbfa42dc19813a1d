//! Derivatives by their entries that are not zero.
//!
//! A stage of a robot is mostly zeros: a row of one leg knows nothing of the others, dynamics are an integrator. The
//! passes of an iteration stream all stages through the processor's caches, and what they need of each is what
//! decides their time. So a problem writes into one dense [`Derivatives`] that all nodes share, and a stage keeps
//! its nonzero entries.

use crate::kernel::{Lanes, add_scaled};
use crate::linearised::{Linearised, Parts, Quadratic};
use crate::problem::{Derivatives, Dims};
use so3::Scalar;
use so3::math::{abs, max};

/// Entries of a vector that are not zero, with their places, in ascending order.
trait Entries<T>: Iterator<Item = (usize, T)> + Clone {}

impl<T, I: Iterator<Item = (usize, T)> + Clone> Entries<T> for I {}

/// `y += factor · x`.
#[inline(always)]
fn add_entries<T: Scalar, const N: usize>(y: &mut [T; N], factor: T, x: impl Entries<T>) {
    for (i, x) in x {
        if let Some(y) = y.get_mut(i) {
            *y += factor * x;
        }
    }
}

/// `xᵀ y`, summed as [`crate::kernel::dot`] does.
#[inline(always)]
fn dot_entries<T: Scalar, const N: usize>(x: impl Entries<T>, y: &[T; N]) -> T {
    let mut sum = Lanes::new();
    for (i, x) in x {
        if let Some(y) = y.get(i) {
            sum.add(i, x * *y);
        }
    }
    sum.total()
}

/// `out += matrix · x`.
#[inline(always)]
fn add_combination<T: Scalar, const R: usize, const C: usize>(
    out: &mut [T; R],
    matrix: &[[T; R]; C],
    x: impl Entries<T>,
) {
    for (j, x) in x {
        if let Some(column) = matrix.get(j) {
            add_scaled(out, x, column);
        }
    }
}

/// The next three entries, if there are as many: coordinates of a robot come in threes.
#[inline(always)]
fn take_three<T: Scalar>(entries: &mut impl Entries<T>) -> Option<[(usize, T); 3]> {
    let mut ahead = entries.clone();
    let three = [ahead.next()?, ahead.next()?, ahead.next()?];
    *entries = ahead;
    Some(three)
}

/// `matrix += weight · x · rowᵀ` in three columns, the entries of the row: what there is of `x` is looked up once for all of them.
#[inline(always)]
fn add_to_three<T: Scalar, const R: usize, const C: usize>(
    matrix: &mut [[T; R]; C],
    weight: T,
    row: [(usize, T); 3],
    x: impl Entries<T>,
) {
    let [a, b, c] = row.map(|(_, entry)| weight * entry);
    let Ok([of_a, of_b, of_c]) = matrix.get_disjoint_mut(row.map(|(j, _)| j)) else {
        return;
    };
    for (i, x) in x {
        if let (Some(of_a), Some(of_b), Some(of_c)) =
            (of_a.get_mut(i), of_b.get_mut(i), of_c.get_mut(i))
        {
            *of_a += a * x;
            *of_b += b * x;
            *of_c += c * x;
        }
    }
}

/// `matrix += weight · x · rowᵀ`.
#[inline(always)]
fn add_outer_with<T: Scalar, const R: usize, const C: usize>(
    matrix: &mut [[T; R]; C],
    weight: T,
    mut row: impl Entries<T>,
    x: impl Entries<T>,
) {
    while let Some(three) = take_three(&mut row) {
        add_to_three(matrix, weight, three, x.clone());
    }
    for (j, entry) in row {
        if let Some(column) = matrix.get_mut(j) {
            add_entries(column, weight * entry, x.clone());
        }
    }
}

/// The lower triangle of `matrix += weight · row · rowᵀ`.
#[inline(always)]
fn add_outer<T: Scalar, const N: usize>(matrix: &mut [[T; N]; N], weight: T, row: impl Entries<T>) {
    let mut rest = row;
    loop {
        let corner = rest.clone().take(3);
        let three = take_three(&mut rest);
        add_corner(matrix, weight, corner);
        let Some(three) = three else { break };
        add_to_three(matrix, weight, three, rest.clone());
    }
}

/// As [`add_outer`], one column after the other.
#[inline(always)]
fn add_corner<T: Scalar, const N: usize>(
    matrix: &mut [[T; N]; N],
    weight: T,
    row: impl Entries<T>,
) {
    let mut rest = row;
    loop {
        let from_here = rest.clone();
        let Some((j, entry)) = rest.next() else {
            break;
        };
        if let Some(column) = matrix.get_mut(j) {
            add_entries(column, weight * entry, from_here);
        }
    }
}

/// Writes the vector itself.
#[inline(always)]
fn write_dense<T: Scalar, const N: usize>(x: impl Entries<T>, out: &mut [T; N]) {
    out.fill(T::ZERO);
    for (i, x) in x {
        if let Some(slot) = out.get_mut(i) {
            *slot = x;
        }
    }
}

/// `C` vectors of length `R`, one after the other, without their zeros: there is room for vectors without any, and
/// what is not used of it is never touched.
#[derive(Clone, Copy, Debug)]
struct Vectors<T, const R: usize, const C: usize> {
    values: [[T; R]; C],
    places: [[u16; R]; C],
    /// Where each vector ends.
    ends: [u32; C],
}

impl<T: Scalar, const R: usize, const C: usize> Vectors<T, R, C> {
    const fn new() -> Self {
        const { assert!(R <= u16::MAX as usize, "places are numbers of 16 bits") };
        Self {
            values: [[T::ZERO; R]; C],
            places: [[0; R]; C],
            ends: [0; C],
        }
    }

    /// Takes the entries of the vectors, each from a place on, and leaves zeros there; vectors behind the given ones have none.
    #[inline(always)]
    fn fill<'a>(&mut self, vectors: impl Iterator<Item = (&'a mut [T; R], usize)>)
    where
        T: 'a,
    {
        let (values, places) = (
            self.values.as_flattened_mut(),
            self.places.as_flattened_mut(),
        );
        let (mut count, mut ends) = (0usize, self.ends.iter_mut());
        for (vector, first) in vectors {
            let (unread, read) = vector.split_at_mut(first.min(R));
            unread.fill(T::ZERO);
            let mut take = |place: usize, values_here: &mut [T]| {
                for (i, value) in (place..).zip(values_here) {
                    if *value != T::ZERO
                        && let (Some(slot), Some(place)) =
                            (values.get_mut(count), places.get_mut(count))
                    {
                        (*slot, *place) = (core::mem::replace(value, T::ZERO), i as u16);
                        count = count.wrapping_add(1);
                    }
                }
            };
            // Most eights are all zeros, which is seen at once.
            let (mut place, (eights, rest)) = (unread.len(), read.as_chunks_mut::<8>());
            for eight in eights {
                if eight.iter().fold(false, |any, x| any | (*x != T::ZERO)) {
                    take(place, eight);
                }
                place = place.wrapping_add(8);
            }
            take(place, rest);
            if let Some(end) = ends.next() {
                *end = count as u32;
            }
        }
        for end in ends {
            *end = count as u32;
        }
    }

    #[inline(always)]
    fn vector(&self, j: usize) -> impl Entries<T> {
        let end = self.ends.get(j).map_or(0, |end| *end as usize);
        let before = j.checked_sub(1).and_then(|j| self.ends.get(j));
        let range = before.map_or(0, |end| *end as usize)..end;
        let values = self.values.as_flattened().get(range.clone());
        let places = self.places.as_flattened().get(range);
        let values = values.unwrap_or_default().iter();
        values
            .zip(places.unwrap_or_default())
            .map(|(value, place)| (usize::from(*place), *value))
    }

    /// `out +=` the vectors as columns times `x`.
    #[inline(always)]
    fn add_product(&self, x: &[T; C], out: &mut [T; R]) {
        for (j, x) in x.iter().enumerate() {
            if *x != T::ZERO {
                add_entries(out, *x, self.vector(j));
            }
        }
    }

    /// `out +=` the vectors as rows times `y`.
    #[inline(always)]
    fn add_transposed_product(&self, y: &[T; R], out: &mut [T; C]) {
        for (j, out) in out.iter_mut().enumerate() {
            *out += dot_entries(self.vector(j), y);
        }
    }
}

/// The nonzero entries of [`Derivatives`], as a stage keeps them.
#[derive(Clone, Copy, Debug)]
pub struct Packed<T, const NX: usize, const NU: usize, const NI: usize> {
    cost_x: [T; NX],
    cost_u: [T; NU],
    dynamics_x: Vectors<T, NX, NX>,
    dynamics_u: Vectors<T, NX, NU>,
    rows_x: Vectors<T, NX, NI>,
    rows_u: Vectors<T, NU, NI>,
    hessian_xx: Vectors<T, NX, NX>,
    hessian_xu: Vectors<T, NX, NU>,
    hessian_uu: Vectors<T, NU, NU>,
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Packed<T, NX, NU, NI> {
    pub(crate) const fn new() -> Self {
        Self {
            cost_x: [T::ZERO; NX],
            cost_u: [T::ZERO; NU],
            dynamics_x: Vectors::new(),
            dynamics_u: Vectors::new(),
            rows_x: Vectors::new(),
            rows_u: Vectors::new(),
            hessian_xx: Vectors::new(),
            hessian_xu: Vectors::new(),
            hessian_uu: Vectors::new(),
        }
    }

    /// Takes what a node of these sizes has, and leaves zeros for the next one: there are fewer entries to clear than there is room.
    #[inline(never)]
    pub(crate) fn pack(&mut self, d: &mut Derivatives<T, NX, NU, NI>, dims: Dims) {
        let (rows, controls) = (dims.rows(), dims.controls);
        self.cost_x = core::mem::replace(&mut d.cost_x, [T::ZERO; NX]);
        self.cost_u = core::mem::replace(&mut d.cost_u, [T::ZERO; NU]);
        self.dynamics_x.fill(first(&mut d.dynamics_x, NX));
        self.dynamics_u.fill(first(&mut d.dynamics_u, controls));
        let from = |on: bool, end: usize| if on { 0 } else { end };
        let x = d.rows_x.iter_mut().enumerate().take(rows);
        self.rows_x
            .fill(x.map(|(i, row)| (row, from(dims.parts(i).state, NX))));
        let u = d.rows_u.iter_mut().enumerate().take(rows);
        self.rows_u
            .fill(u.map(|(i, row)| (row, from(dims.parts(i).control, NU))));
        self.hessian_xx
            .fill(d.hessian_xx.iter_mut().enumerate().map(|(j, x)| (x, j)));
        self.hessian_xu.fill(first(&mut d.hessian_xu, controls));
        self.hessian_uu.fill(first(&mut d.hessian_uu, controls));
    }
}

/// The first vectors with all their places, the others without any.
fn first<T, const N: usize>(
    vectors: &mut [[T; N]],
    count: usize,
) -> impl Iterator<Item = (&mut [T; N], usize)> {
    let vectors = vectors.iter_mut().enumerate();
    vectors.map(move |(j, vector)| (vector, if j < count { 0 } else { N }))
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Linearised<T, NX, NU>
    for Packed<T, NX, NU, NI>
{
    #[inline(always)]
    fn cost_x(&self) -> &[T; NX] {
        &self.cost_x
    }

    #[inline(always)]
    fn cost_u(&self) -> &[T; NU] {
        &self.cost_u
    }

    #[inline(always)]
    fn write(&self, n: usize, q: &mut Quadratic<'_, T, NX, NU>) {
        *q.x = self.cost_x;
        for (j, column) in q.xx.iter_mut().enumerate() {
            write_dense(self.hessian_xx.vector(j), column);
        }
        if n > 0 {
            *q.u = self.cost_u.map(|g| [g]);
            let columns = q.xu.iter_mut().zip(q.uu.iter_mut()).enumerate();
            for (j, (xu, uu)) in columns.take(n) {
                write_dense(self.hessian_xu.vector(j), xu);
                write_dense(self.hessian_uu.vector(j), uu);
            }
        }
    }

    #[inline(always)]
    fn push_forward(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NX]) {
        self.dynamics_x.add_product(dx, out);
        self.dynamics_u.add_product(du, out);
    }

    #[inline(always)]
    fn pull_back_x(&self, y: &[T; NX], out: &mut [T; NX]) {
        self.dynamics_x.add_transposed_product(y, out);
    }

    #[inline(always)]
    fn pull_back_u(&self, y: &[T; NX], out: &mut [T; NU]) {
        self.dynamics_u.add_transposed_product(y, out);
    }

    #[inline(always)]
    fn combine_x<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]) {
        add_combination(out, matrix, self.dynamics_x.vector(j));
    }

    #[inline(always)]
    fn combine_u<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]) {
        add_combination(out, matrix, self.dynamics_u.vector(j));
    }

    #[inline(always)]
    fn authority(&self, n: usize) -> T {
        let entries = (0..n).flat_map(|j| self.dynamics_u.vector(j));
        entries.fold(T::ZERO, |most, (_, b)| max(most, abs(b)))
    }

    #[inline(always)]
    fn row(&self, i: usize, _: Parts) -> ([T; NX], [T; NU]) {
        let (mut x, mut u) = ([T::ZERO; NX], [T::ZERO; NU]);
        write_dense(self.rows_x.vector(i), &mut x);
        write_dense(self.rows_u.vector(i), &mut u);
        (x, u)
    }

    #[inline(always)]
    fn row_change(&self, i: usize, _: Parts, dx: &[T; NX], du: &[T; NU]) -> T {
        dot_entries(self.rows_x.vector(i), dx) + dot_entries(self.rows_u.vector(i), du)
    }

    #[inline(always)]
    fn add_row_x(&self, i: usize, y: T, out: &mut [T; NX]) {
        add_entries(out, y, self.rows_x.vector(i));
    }

    #[inline(always)]
    fn add_row_u(&self, i: usize, y: T, out: &mut [T; NU]) {
        add_entries(out, y, self.rows_u.vector(i));
    }

    #[inline(always)]
    fn condense(
        &self,
        i: usize,
        _: Parts,
        (weight, target): (T, T),
        q: &mut Quadratic<'_, T, NX, NU>,
    ) {
        let (x, u) = (self.rows_x.vector(i), self.rows_u.vector(i));
        add_outer(q.xx, weight, x.clone());
        add_entries(q.x, target, x.clone());
        add_outer(q.uu, weight, u.clone());
        for (j, entry) in u.clone() {
            if let Some(u) = q.u.get_mut(j) {
                u[0] += target * entry;
            }
        }
        add_outer_with(q.xu, weight, u, x);
    }

    #[inline(always)]
    fn add_curvature(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NU]) {
        self.hessian_xu.add_transposed_product(dx, out);
        self.hessian_uu.add_product(du, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_come_back_without_their_zeros() {
        let mut given = [
            [0.0, 2.0, 0.0],
            [0.0; 3],
            [4.0, 5.0, 6.0],
            [7.0, 0.0, f64::NAN],
        ];
        let mut packed = Vectors::<f64, 3, 4>::new();
        packed.fill(given.iter_mut().zip([0, 0, 1, 0]));
        // What was there is taken.
        assert_eq!(given, [[0.0; 3]; 4]);
        assert!(packed.vector(0).eq([(1, 2.0)]));
        assert!(packed.vector(1).eq([]));
        // From place 1 on.
        assert!(packed.vector(2).eq([(1, 5.0), (2, 6.0)]));
        // What is broken is no zero.
        let places = packed.vector(3).map(|(i, _)| i);
        assert!(places.eq([0, 2]));
        assert!(packed.vector(4).eq([]));
        // Fewer vectors than before.
        given[0][1] = 2.0;
        packed.fill(given.iter_mut().zip([0, 0]));
        assert!(packed.vector(0).eq([(1, 2.0)]));
        assert!(packed.vector(2).eq([]) && packed.vector(3).eq([]));

        let mut sum = [1.0; 4];
        packed.add_transposed_product(&[1.0, 10.0, 100.0], &mut sum);
        assert_eq!(sum, [21.0, 1.0, 1.0, 1.0]);
    }
}
