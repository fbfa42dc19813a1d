//! Random programs from proptest's numbers, and the Clarabel oracle.
#![allow(unreachable_pub, reason = "tests")]
#![allow(
    clippy::expect_used,
    clippy::needless_range_loop,
    clippy::panic,
    reason = "tests"
)]

pub mod oracle;

use core::cell::RefCell;
use dense_qp::Problem;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use so3::Scalar;

pub const INF: f64 = f64::INFINITY;

/// Numbers in [0, 1) that proptest drew, used one after the other and then again.
#[derive(Clone, Debug)]
pub struct Draw {
    numbers: Vec<f64>,
    at: usize,
}

impl Draw {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        let x = self.numbers[self.at % self.numbers.len()];
        self.at += 1;
        x
    }
    /// In [−1, 1).
    pub fn sym(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n.saturating_sub(1))
    }
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
}

/// As many numbers as a program of this size takes, at most.
const fn most_numbers(n: usize, m: usize) -> usize {
    n * n + m * (2 * n + 12) + 8 * n + 16
}

fn draw(len: usize) -> impl Strategy<Value = Draw> {
    prop::collection::vec(0.0..1.0_f64, len).prop_map(|numbers| Draw { numbers, at: 0 })
}

/// Runs a property on `cases` draws: the same ones on every machine unless `PROPTEST_RNG_SEED` says otherwise.
pub fn each<const N: usize, const M: usize>(cases: u32, seed: u64, body: impl Fn(Draw)) {
    run(most_numbers(N, M), cases, seed, &body);
}

/// [`each`], compiled once: proptest's runner is larger than most properties.
fn run(len: usize, cases: u32, seed: u64, body: &dyn Fn(Draw)) {
    let mut config = Config::with_cases(cases);
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(seed);
    }
    config.failure_persistence = None;
    let outcome = TestRunner::new(config).run(&draw(len), |draw| {
        body(draw);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

/// Counts of outcomes over the cases of [`each`].
#[derive(Default)]
pub struct Tally(RefCell<std::collections::BTreeMap<&'static str, u32>>);

impl Tally {
    pub fn add(&self, what: &'static str) {
        self.count(what, 1);
    }
    pub fn count(&self, what: &'static str, n: u32) {
        *self.0.borrow_mut().entry(what).or_default() += n;
    }
    pub fn of(&self, what: &str) -> u32 {
        self.0.borrow().get(what).copied().unwrap_or_default()
    }
}

/// A program that owns its numbers.
#[derive(Clone, Debug)]
pub struct Qp<T, const N: usize, const M: usize> {
    pub h: [[T; N]; N],
    pub g: [T; N],
    pub a: [[T; N]; M],
    pub l: [T; M],
    pub u: [T; M],
    pub lb: [T; N],
    pub ub: [T; N],
}

impl<T: Scalar, const N: usize, const M: usize> Qp<T, N, M> {
    /// No cost, rows of zeros and no limits.
    pub fn zero() -> Box<Self> {
        Box::new(Self {
            h: [[T::ZERO; N]; N],
            g: [T::ZERO; N],
            a: [[T::ZERO; N]; M],
            l: [-T::INFINITY; M],
            u: [T::INFINITY; M],
            lb: [-T::INFINITY; N],
            ub: [T::INFINITY; N],
        })
    }

    pub fn problem(&self) -> Problem<'_, T, N, M> {
        Problem::new(&self.h, &self.g, &self.a, &self.l, &self.u).with_bounds(&self.lb, &self.ub)
    }
}

impl<const N: usize, const M: usize> Qp<f64, N, M> {
    /// The same numbers in single precision.
    pub fn single(&self) -> Box<Qp<f32, N, M>> {
        let f = |x: f64| x as f32;
        Box::new(Qp {
            h: self.h.map(|h| h.map(f)),
            g: self.g.map(f),
            a: self.a.map(|a| a.map(f)),
            l: self.l.map(f),
            u: self.u.map(f),
            lb: self.lb.map(f),
            ub: self.ub.map(f),
        })
    }

    /// H = Σ of `rank` outer products + `shift`·I.
    pub fn set_hessian(&mut self, r: &mut Draw, rank: usize, shift: f64) {
        self.h = [[0.0; N]; N];
        for _ in 0..rank {
            let v: [f64; N] = core::array::from_fn(|_| r.sym());
            self.add_outer(&v, 1.0);
        }
        for i in 0..N {
            self.h[i][i] += shift;
        }
    }

    /// H ← H + w v vᵀ.
    pub fn add_outer(&mut self, v: &[f64; N], w: f64) {
        for i in 0..N {
            for j in 0..N {
                self.h[i][j] += w * (v[i] * v[j]);
            }
        }
    }

    /// g ← −H x, so that x is a minimum where nothing limits it.
    pub fn aim(&mut self, x: &[f64; N]) {
        for (g, h) in self.g.iter_mut().zip(&self.h) {
            *g = -dot(h, x);
        }
    }

    /// Rows around a feasible point, a share of them equalities, duplicated or tight at the point.
    pub fn set_rows(&mut self, r: &mut Draw, equalities: usize, degenerate: bool) {
        let x0: [f64; N] = core::array::from_fn(|_| 2.0 * r.sym());
        for i in 0..M {
            let sparse = r.chance(0.3);
            for j in 0..N {
                self.a[i][j] = if sparse && !r.chance(0.3) {
                    0.0
                } else {
                    r.sym()
                };
            }
            if degenerate && i > 0 && r.chance(0.3) {
                // A copy, a multiple or a combination of earlier rows.
                let (p, q) = (r.below(i), r.below(i));
                let (f, g) = match r.below(3) {
                    0 => (1.0, 0.0),
                    1 => (-2.0, 0.0),
                    _ => (r.sym(), r.sym()),
                };
                for j in 0..N {
                    self.a[i][j] = f * self.a[p][j] + g * self.a[q][j];
                }
            }
            let v = dot(&self.a[i], &x0);
            let gap = |r: &mut Draw| {
                if degenerate && r.chance(0.5) {
                    0.0
                } else {
                    r.unit()
                }
            };
            if i < equalities {
                (self.l[i], self.u[i]) = (v, v);
            } else {
                self.u[i] = if r.chance(0.7) { v + gap(r) } else { INF };
                self.l[i] = if r.chance(0.5) {
                    v - gap(r) - 1e-3
                } else {
                    -INF
                };
            }
        }
        for j in 0..N {
            if r.chance(0.4) {
                let fixed = degenerate && r.chance(0.2);
                self.lb[j] = x0[j] - if fixed { 0.0 } else { r.unit() };
                self.ub[j] = x0[j] + if fixed { 0.0 } else { r.unit() };
            }
        }
        for g in &mut self.g {
            *g = 5.0 * r.sym();
        }
    }
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A definite program: H of full rank, `equalities` rows met by a common point.
pub fn definite<const N: usize, const M: usize>(
    equalities: usize,
) -> impl Strategy<Value = Box<Qp<f64, N, M>>> {
    draw(most_numbers(N, M)).prop_map(move |mut r| {
        let mut q = Qp::zero();
        q.set_hessian(&mut r, N, 0.1);
        q.set_rows(&mut r, equalities, false);
        q
    })
}

/// A program whose H is singular, with limits on both sides of most rows and none of variables.
pub fn semidefinite<const N: usize, const M: usize>(
    rank: usize,
) -> impl Strategy<Value = Box<Qp<f64, N, M>>> {
    draw(most_numbers(N, M)).prop_map(move |mut r| {
        let mut q = Qp::zero();
        q.set_hessian(&mut r, rank, 0.0);
        q.set_rows(&mut r, 0, false);
        (q.lb, q.ub) = ([-INF; N], [INF; N]);
        for (l, u) in q.l.iter_mut().zip(&mut q.u) {
            if l.is_finite() {
                *u = u.min(*l + 3.0);
            } else if u.is_finite() {
                *l = *u - 3.0;
            }
        }
        q
    })
}

/// Limits of rows, then of variables, with their multipliers and values at x.
fn limited<'a, const N: usize, const M: usize>(
    q: &'a Qp<f64, N, M>,
    x: &'a [f64; N],
    rows: &'a [f64; M],
    bounds: &'a [f64; N],
) -> impl Iterator<Item = (f64, f64, [f64; 2])> {
    let rows =
        q.a.iter()
            .map(|a| dot(a, x))
            .zip(rows)
            .zip(q.l.iter().zip(&q.u));
    let bounds = x.iter().copied().zip(bounds).zip(q.lb.iter().zip(&q.ub));
    rows.chain(bounds).map(|((v, y), (l, u))| (v, *y, [*l, *u]))
}

/// What it is worth by these multipliers that x misses limits. They are those of an optimum: no point is cheaper by more.
pub fn worth_of_misses<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    x: &[f64; N],
    rows: &[f64; M],
    bounds: &[f64; N],
) -> f64 {
    let misses = limited(q, x, rows, bounds).map(|(v, y, [l, u])| {
        // An infinite limit has no multiplier.
        if y > 0.0 {
            y * (v - u).max(0.0)
        } else if y < 0.0 {
            -y * (l - v).max(0.0)
        } else {
            0.0
        }
    });
    misses.sum()
}

/// The largest of the terms whose differences are the conditions of optimality: of a gradient's entry, of a row, and of a row times its
/// multiplier. What round-off leaves of a condition is measured by them.
pub fn largest_term<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    x: &[f64; N],
    rows: &[f64; M],
    bounds: &[f64; N],
) -> f64 {
    let sizes = |a: &[f64; N]| a.iter().zip(x).map(|(a, x)| (a * x).abs()).sum::<f64>();
    let mut most: f64 = 0.0;
    for i in 0..N {
        let pulls = q.a.iter().zip(rows).map(|(a, y)| (a[i] * y).abs());
        let gradient = sizes(&q.h[i]) + q.g[i].abs() + bounds[i].abs() + pulls.sum::<f64>();
        most = most
            .max(gradient)
            .max(x[i].abs() * bounds[i].abs().max(1.0));
    }
    let rows =
        q.a.iter()
            .zip(rows)
            .map(|(a, y)| sizes(a) * y.abs().max(1.0));
    rows.fold(most, f64::max)
}
