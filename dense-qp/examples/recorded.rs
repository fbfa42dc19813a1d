//! Solves recorded programs, cold and warm, and writes answers and times for `tests/peers/programs.py`.
//!
//! `cargo run --release -p dense-qp --features bench --example recorded -- PROGRAMS ANSWERS` for times (s, least of 7 each);
//! `… -- PROGRAMS ANSWERS cold` and `… warm` solve each program once, in [`cold`] and [`warm`], for callgrind.
//!
//! PROGRAMS is what the example `peers`, `wbc-qp`'s example `ticks` and `saltus run TASK --programs` leave: little-endian f64, sizes
//! N, M and count, then per program H, g, A, l, u and the bounds, one after the other in time. ANSWERS has per program x, time cold and
//! warm, steps cold and warm, and the largest violation of an optimality condition. Warm is from the last program's workspace.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a measuring program"
)]

use core::hint::black_box;
use dense_qp::{Problem, Settings, Solution, Status, Workspace};
use dense_qp::{kkt_residual, solve, solve_warm};
use std::time::Instant;

const REPEAT: usize = 7;

struct Qp<const N: usize, const M: usize> {
    h: [[f64; N]; N],
    g: [f64; N],
    a: [[f64; N]; M],
    limits: [[f64; M]; 2],
    bounds: [[f64; N]; 2],
    spans: [[usize; 2]; M],
}

impl<const N: usize, const M: usize> Qp<N, M> {
    fn read(mut next: impl FnMut() -> f64) -> Self {
        let h = core::array::from_fn(|_| core::array::from_fn(|_| next()));
        let g = core::array::from_fn(|_| next());
        let a: [[f64; N]; M] = core::array::from_fn(|_| core::array::from_fn(|_| next()));
        let limits = core::array::from_fn(|_| core::array::from_fn(|_| next()));
        let bounds = core::array::from_fn(|_| core::array::from_fn(|_| next()));
        // The controller knows which foot a row speaks of; a file does not say it.
        let spans = a.map(|row| {
            let used = |x: &f64| *x != 0.0;
            let from = row.iter().position(used).unwrap_or(0);
            [from, row.iter().rposition(used).map_or(0, |last| last + 1)]
        });
        Self {
            h,
            g,
            a,
            limits,
            bounds,
            spans,
        }
    }

    /// Without bounds where no variable has any, and with spans where `landing` states them.
    fn problem(&self) -> Problem<'_, f64, N, M> {
        let [l, u] = &self.limits;
        let [lower, upper] = &self.bounds;
        let mut problem = Problem::new(&self.h, &self.g, &self.a, l, u);
        if lower.iter().chain(upper).any(|x| x.is_finite()) {
            problem = problem.with_bounds(lower, upper);
        }
        if (N, M) == (12, 28) {
            problem = problem.with_spans(&self.spans);
        }
        problem
    }
}

/// One cold solve.
#[inline(never)]
fn cold<'w, const N: usize, const M: usize>(
    problem: &Problem<'_, f64, N, M>,
    workspace: &'w mut Workspace<f64, N, M>,
) -> Solution<'w, f64, N, M> {
    solve(problem, &Settings::default(), workspace).unwrap()
}

/// One warm solve.
#[inline(never)]
fn warm<'w, const N: usize, const M: usize>(
    problem: &Problem<'_, f64, N, M>,
    workspace: &'w mut Workspace<f64, N, M>,
) -> Solution<'w, f64, N, M> {
    solve_warm(problem, &Settings::default(), workspace).unwrap()
}

/// Least time and the steps of `repeat` solves, each from a copy of what `workspace` remembers, which is then left as the last one leaves it.
fn measure<const N: usize, const M: usize>(
    problem: &Problem<'_, f64, N, M>,
    workspace: &mut Box<Workspace<f64, N, M>>,
    repeat: usize,
    is_warm: bool,
) -> [f64; 2] {
    let before = workspace.clone();
    let (mut least, mut steps) = (f64::INFINITY, 0);
    for _ in 0..repeat {
        if is_warm {
            workspace.clone_from(&before);
        }
        let begin = Instant::now();
        let solution = if is_warm {
            black_box(warm(black_box(problem), workspace))
        } else {
            black_box(cold(black_box(problem), workspace))
        };
        least = least.min(begin.elapsed().as_secs_f64());
        assert_eq!(solution.status, Status::Solved);
        steps = solution.steps;
    }
    [least, f64::from(steps)]
}

fn all<const N: usize, const M: usize>(
    count: usize,
    mut next: impl FnMut() -> f64,
    only: Option<&str>,
) -> Vec<f64> {
    let (mut of_cold, mut of_warm) = (Box::new(Workspace::new()), Box::new(Workspace::new()));
    let mut out = Vec::new();
    for _ in 0..count {
        let q = Box::new(Qp::<N, M>::read(&mut next));
        let problem = q.problem();
        if let Some(way) = only {
            measure(&problem, &mut of_cold, 1, way == "warm");
            continue;
        }
        let [time, steps] = measure(&problem, &mut of_cold, REPEAT, false);
        let [warm_time, warm_steps] = measure(&problem, &mut of_warm, REPEAT, true);
        let solution = cold(&problem, &mut of_cold);
        let (rows, bounds) = (solution.row_multipliers, solution.bound_multipliers);
        let residual = kkt_residual(&problem, solution.x, rows, bounds);
        out.extend(solution.x);
        out.extend([time, warm_time, steps, warm_steps, residual.max()]);
    }
    out
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let bytes = std::fs::read(&args[1]).unwrap();
    let (words, _) = bytes.as_chunks::<8>();
    let mut numbers = words.iter().map(|word| f64::from_le_bytes(*word));
    let mut next = || numbers.next().unwrap();
    let [n, m, count] = [(); 3].map(|()| next() as usize);
    let only = args.get(3).map(String::as_str);
    let out = match (n, m) {
        (12, 20) => all::<12, 20>(count, next, only),
        (12, 28) => all::<12, 28>(count, next, only),
        (12, 32) => all::<12, 32>(count, next, only),
        (16, 16) => all::<16, 16>(count, next, only),
        (24, 40) => all::<24, 40>(count, next, only),
        (29, 12) => all::<29, 12>(count, next, only),
        (35, 55) => all::<35, 55>(count, next, only),
        (35, 98) => all::<35, 98>(count, next, only),
        _ => panic!("{n} × {m} is no size of a recorded program"),
    };
    let bytes: Vec<u8> = out.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(&args[2], bytes).unwrap();
}
