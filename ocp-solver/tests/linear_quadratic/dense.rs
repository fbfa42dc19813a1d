//! The dense solution: rows are solved for as many variables, and the quadratic is least over the others, in double-double.
//!
//! In doubles no dense method is accurate enough to judge with. A row that next to no control can meet has a multiplier of 10⁵ and more, and
//! the matrix of the KKT conditions then has singular values down to 10⁻¹², which an SVD in doubles cannot tell from those of rows that depend
//! on others. Here the multipliers do not enter, and what rounding leaves of a dependent row, 10⁻¹⁶, is far below what is left of any other.

use super::NX;
use super::problem::Lq;
use core::ops::{Add, AddAssign, Div, Mul, Neg, SubAssign};
use nalgebra::DVector;

/// A number of 106 bits, as the unevaluated sum of two (Dekker 1971; Knuth, The Art of Computer Programming 2, 4.2.2).
#[derive(Clone, Copy, Debug, Default)]
struct Dd(f64, f64);

fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let t = s - a;
    Dd(s, (a - (s - t)) + (b - t))
}

fn two_product(a: f64, b: f64) -> Dd {
    let split = |a: f64| {
        let t = a * 134_217_729.0;
        let high = t - (t - a);
        (high, a - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Add for Dd {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, t) = (two_sum(self.0, o.0), two_sum(self.1, o.1));
        let s = two_sum(s.0, s.1 + t.0);
        two_sum(s.0, s.1 + t.1)
    }
}

impl AddAssign for Dd {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Dd {
    fn sub_assign(&mut self, o: Self) {
        *self += -o;
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = two_product(self.0, o.0);
        two_sum(p.0, p.1 + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Div for Dd {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let q = Self(self.0 / o.0, 0.0);
        let r = self + -(q * o);
        q + Self(r.0 / o.0, 0.0)
    }
}

/// Gauss and Jordan with complete pivoting: solves the equations `Σ_j m[i][j] x_j = m[i][columns]` for as many variables as are independent.
/// Returns equation and variable of every pivot, and the largest number that was taken as zero.
fn solve_for_some(m: &mut [Vec<Dd>], columns: usize, zero: f64) -> (Vec<(usize, usize)>, f64) {
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    loop {
        let mut best = (0.0, 0, 0);
        for (i, row) in m.iter().enumerate() {
            if pivots.iter().any(|pivot| pivot.0 == i) {
                continue;
            }
            for (j, value) in row.iter().enumerate().take(columns) {
                if value.0.abs() > best.0 {
                    best = (value.0.abs(), i, j);
                }
            }
        }
        let (size, i, j) = best;
        if size <= zero {
            return (pivots, size);
        }
        let pivot = m[i][j];
        for value in &mut m[i] {
            *value = *value / pivot;
        }
        let own = m[i].clone();
        for (_, row) in m.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[j];
            if factor.0 == 0.0 {
                continue;
            }
            for (value, own) in row.iter_mut().zip(&own) {
                *value -= factor * *own;
            }
            row[j] = Dd::default();
        }
        pivots.push((i, j));
    }
}

/// All rows as equations over all variables, the right-hand side last.
fn equations(problem: &Lq, start: &[f64; NX]) -> Vec<Vec<Dd>> {
    let nx = problem.nx;
    let sizes: Vec<usize> = problem.nodes.iter().map(|node| node.g.len()).collect();
    let at: Vec<usize> = (0..sizes.len()).map(|k| sizes[..k].iter().sum()).collect();
    let variables: usize = sizes.iter().sum();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let none = vec![0.0; variables + 1];
    for i in (0..nx).filter(|i| !problem.free[*i]) {
        let mut row = none.clone();
        (row[i], row[variables]) = (1.0, start[i]);
        rows.push(row);
    }
    for (k, node) in problem.nodes.iter().enumerate() {
        for (own, right) in node.rows.row_iter().zip(&node.right) {
            let mut row = none.clone();
            for (to, value) in row[at[k]..].iter_mut().zip(own.iter()) {
                *to = *value;
            }
            row[variables] = *right;
            rows.push(row);
        }
        if k + 1 < sizes.len() {
            for i in 0..nx {
                let mut row = none.clone();
                for (to, value) in row[at[k]..].iter_mut().zip(node.a.row(i).iter()) {
                    *to = *value;
                }
                row[at[k + 1] + i] -= 1.0;
                row[variables] = -node.offset[i];
                rows.push(row);
            }
        }
    }
    let scaled = rows.iter().map(|row| {
        let size = row[..variables]
            .iter()
            .fold(0.0, |a: f64, x| a.max(x.abs()));
        row.iter().map(|x| Dd(*x, 0.0) / Dd(size, 0.0)).collect()
    });
    scaled.collect()
}

/// States and controls of all nodes in a row.
pub(crate) fn solve(problem: &Lq, start: &[f64; NX]) -> DVector<f64> {
    let mut rows = equations(problem, start);
    let n = rows[0].len() - 1;
    let (pivots, dropped) = solve_for_some(&mut rows, n, 1e-12);
    assert!(dropped < 1e-14, "depends or does not: {dropped:e}");
    let free: Vec<usize> = (0..n)
        .filter(|j| pivots.iter().all(|pivot| pivot.1 != *j))
        .collect();
    // z = `moves` · (free variables, 1).
    let mut moves = vec![vec![Dd::default(); free.len() + 1]; n];
    for (i, j) in &pivots {
        for (to, free) in moves[*j].iter_mut().zip(&free) {
            *to = -rows[*i][*free];
        }
        moves[*j][free.len()] = rows[*i][n];
    }
    for (f, j) in free.iter().enumerate() {
        moves[*j][f] = Dd(1.0, 0.0);
    }
    // Mᵀ H M and Mᵀ g, with the constants in the last column: what is stationary over the free variables.
    let mut reduced = vec![vec![Dd::default(); free.len() + 1]; free.len()];
    let mut first = 0;
    for node in &problem.nodes {
        let size = node.g.len();
        for i in 0..size {
            let mut gradient = vec![Dd::default(); free.len() + 1];
            for j in 0..size {
                for (to, value) in gradient.iter_mut().zip(&moves[first + j]) {
                    *to += Dd(node.h[(i, j)], 0.0) * *value;
                }
            }
            gradient[free.len()] += Dd(node.g[i], 0.0);
            for (row, share) in reduced.iter_mut().zip(&moves[first + i]) {
                for (to, value) in row.iter_mut().zip(&gradient) {
                    *to += *share * *value;
                }
            }
        }
        first += size;
    }
    for row in &mut reduced {
        row[free.len()] = -row[free.len()];
    }
    let (found, _) = solve_for_some(&mut reduced, free.len(), 0.0);
    let mut values = vec![Dd(1.0, 0.0); free.len() + 1];
    for (i, f) in found {
        values[f] = reduced[i][free.len()];
    }
    let z = moves.iter().map(|row| {
        let terms = row.iter().zip(&values);
        terms.fold(Dd::default(), |sum, (a, b)| sum + *a * *b).0
    });
    DVector::from_iterator(n, z)
}
