//! Solves recorded programs, cold, and writes answers and times for `tests/peers/landing_qp.py`.
//!
//! `cargo run --release -p dense-qp --example recorded -- PROGRAMS ANSWERS` for times (s, least of 5 each);
//! `… -- PROGRAMS ANSWERS once` solves each program once, in [`measured`], for callgrind.
//!
//! PROGRAMS is what `saltus run TASK --programs` leaves: little-endian f64, sizes 12 × 28 and count, then per program H, g, A, l, u
//! and the bounds. ANSWERS has x, iterations, time and the largest violation of an optimality condition per program.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "a measuring program"
)]

use core::hint::black_box;
use dense_qp::{Problem, Settings, Solution, Status, Workspace, kkt_residual, solve};
use std::time::Instant;

const N: usize = 12;
const M: usize = 28;
const REPEAT: usize = 5;

struct Qp {
    h: [[f64; N]; N],
    g: [f64; N],
    a: [[f64; N]; M],
    limits: [[f64; M]; 2],
    bounds: [[f64; N]; 2],
    spans: [[usize; 2]; M],
}

fn read(path: &str) -> Vec<Qp> {
    let bytes = std::fs::read(path).unwrap();
    let (words, _) = bytes.as_chunks::<8>();
    let mut numbers = words.iter().map(|word| f64::from_le_bytes(*word));
    let mut next = || numbers.next().unwrap();
    let sizes = [next(), next(), next()];
    assert_eq!(sizes[..2], [N as f64, M as f64]);
    let mut qps = Vec::new();
    for _ in 0..sizes[2] as usize {
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
        qps.push(Qp {
            h,
            g,
            a,
            limits,
            bounds,
            spans,
        });
    }
    qps
}

/// One cold solve.
#[inline(never)]
fn measured<'w>(
    problem: &Problem<'_, f64, N, M>,
    workspace: &'w mut Workspace<f64, N, M>,
) -> Solution<'w, f64, N, M> {
    solve(problem, &Settings::default(), workspace).unwrap()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let qps = read(&args[1]);
    let repeat = if args.get(3).is_some() { 1 } else { REPEAT };
    let mut workspace = Workspace::<f64, N, M>::new();
    let mut out = Vec::new();
    for (k, q) in qps.iter().enumerate() {
        let [l, u] = &q.limits;
        let [lower, upper] = &q.bounds;
        let problem = Problem::new(&q.h, &q.g, &q.a, l, u)
            .with_bounds(lower, upper)
            .with_spans(&q.spans);
        let mut best = f64::INFINITY;
        for i in 1..=repeat {
            let begin = Instant::now();
            let solution = black_box(measured(black_box(&problem), &mut workspace));
            best = best.min(begin.elapsed().as_secs_f64());
            assert_eq!(solution.status, Status::Solved, "program {k}");
            if i == repeat {
                let residual = kkt_residual(
                    &problem,
                    solution.x,
                    solution.row_multipliers,
                    solution.bound_multipliers,
                );
                out.extend(solution.x);
                out.extend([f64::from(solution.iterations), best, residual.max()]);
            }
        }
    }
    let bytes: Vec<u8> = out.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(&args[2], bytes).unwrap();
}
