//! Writes families of made-up, controller-like programs to files, so that this crate (the example `recorded`) and its peers
//! (`tests/peers/dense_qp.py`) solve the same numbers.
//!
//! `cargo run --release -p dense-qp --features bench --example peers -- FOLDER` writes `FOLDER/NAME.qps` of each family: little-endian f64, sizes N, M
//! and count, then per program H, g, A, l, u and the bounds of the variables, which are infinite.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "a measuring program"
)]

use dense_qp::{Problem, Settings, Status, Workspace, solve};
use std::path::Path;

const INF: f64 = f64::INFINITY;

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn sym(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }
}

#[derive(Clone)]
struct Qp<const N: usize, const M: usize> {
    h: [[f64; N]; N],
    g: [f64; N],
    a: [[f64; N]; M],
    l: [f64; M],
    u: [f64; M],
}

impl<const N: usize, const M: usize> Qp<N, M> {
    fn zero() -> Self {
        Self {
            h: [[0.0; N]; N],
            g: [0.0; N],
            a: [[0.0; N]; M],
            l: [-INF; M],
            u: [INF; M],
        }
    }
    /// Adds w·|row·x − target|²/2 to the cost.
    fn task(&mut self, row: &[f64; N], w: f64, target: f64) {
        for i in 0..N {
            for j in 0..N {
                self.h[i][j] += w * row[i] * row[j];
            }
            self.g[i] -= w * row[i] * target;
        }
    }
}

/// Stance forces of a quadruped: track a wrench under friction pyramids (20 rows) and, for M = 32,
/// joint torques (12 rows). Drifts at 1 kHz; the demand exceeds the limits now and then.
fn landing<const M: usize>(count: usize) -> Vec<Qp<12, M>> {
    let mut r = Rng(7);
    let mut out = Vec::new();
    for k in 0..count {
        let t = k as f64 * 1e-2;
        let mut q = Qp::<12, M>::zero();
        let feet: [[f64; 3]; 4] = core::array::from_fn(|f| {
            let (sx, sy) = ([1.0, 1.0, -1.0, -1.0][f], [1.0, -1.0, 1.0, -1.0][f]);
            [
                0.18 * sx + 0.02 * (t + f as f64).sin(),
                0.13 * sy,
                -0.28 + 0.03 * (2.0 * t).cos(),
            ]
        });
        let wrench = [
            40.0 * (1.3 * t).sin(),
            60.0 * (0.7 * t).cos(),
            135.0 * (1.0 + 0.9 * (0.9 * t).sin()),
            12.0 * (1.1 * t).sin(),
            9.0 * (1.7 * t).cos(),
            3.0 * t.sin(),
        ];
        let weight = [1.0, 1.0, 2.0, 10.0, 10.0, 5.0];
        for (axis, (target, w)) in wrench.iter().zip(weight).enumerate() {
            let mut row = [0.0; 12];
            for (f, p) in feet.iter().enumerate() {
                let cross = [[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]];
                for c in 0..3 {
                    row[3 * f + c] = if axis < 3 {
                        f64::from(u8::from(axis == c))
                    } else {
                        cross[axis - 3][c]
                    };
                }
            }
            q.task(&row, w, *target);
        }
        for i in 0..12 {
            q.h[i][i] += 1e-3;
        }
        for f in 0..4 {
            for s in 0..4 {
                let i = 5 * f + s;
                q.a[i][3 * f + s / 2] = if s % 2 == 0 { 1.0 } else { -1.0 };
                q.a[i][3 * f + 2] = -0.6;
                q.u[i] = 0.0;
            }
            q.a[5 * f + 4][3 * f + 2] = 1.0;
            (q.l[5 * f + 4], q.u[5 * f + 4]) = (5.0, 150.0);
        }
        for i in 20..M {
            let f = (i - 20) / 3;
            for c in 0..3 {
                q.a[i][3 * f + c] = 0.2 * r.sym();
            }
            (q.l[i], q.u[i]) = (-33.5, 33.5);
        }
        out.push(q);
    }
    out
}

/// Whole-body control in shape: 23 accelerations and 12 contact forces, 18 equalities (6 of the
/// base, 12 of the contacts), 80 inequalities of friction cones and torques.
fn humanoid(count: usize) -> Vec<Qp<35, 98>> {
    let mut r = Rng(11);
    let fixed: Vec<f64> = (0..98 * 35 + 30 * 35).map(|_| r.sym()).collect();
    let drift: Vec<f64> = (0..98 * 35 + 30 * 35).map(|_| r.sym()).collect();
    let mut out = Vec::new();
    for k in 0..count {
        let t = k as f64 * 1e-3;
        let at = |i: usize| fixed[i] + t * drift[i];
        let mut q = Qp::<35, 98>::zero();
        for i in 0..30 {
            let row = core::array::from_fn(|j| at(i * 35 + j));
            q.task(&row, 1.0 + (i % 5) as f64, 8.0 * at(i * 35 + 17));
        }
        for i in 0..35 {
            q.h[i][i] += if i < 23 { 1e-2 } else { 1e-3 };
        }
        for i in 0..98 {
            let base = (30 + i) * 35;
            let sparse = (18..58).contains(&i);
            for j in 0..35 {
                let keep = !sparse || (j >= 23 && (j - 23) / 6 == (i - 18) / 20);
                q.a[i][j] = if keep { at(base + j) } else { 0.0 };
            }
            if i < 18 {
                (q.l[i], q.u[i]) = (at(base + 3), at(base + 3));
            } else if sparse {
                q.u[i] = 0.6 + 0.5 * at(base + 5);
            } else {
                let c = 4.0 + at(base + 7);
                (q.l[i], q.u[i]) = (-c, c);
            }
        }
        out.push(q);
    }
    out
}

/// Jerk MPC of a linear inverted pendulum over 16 samples: zero-moment point between moving limits.
fn pendulum(count: usize) -> Vec<Qp<16, 16>> {
    let (dt, height) = (0.1, 0.8 / 9.81);
    let mut out = Vec::new();
    for k in 0..count {
        let t = k as f64 * 0.02;
        let mut q = Qp::<16, 16>::zero();
        let start = [0.02 * (3.0 * t).sin(), 0.3 * (2.0 * t).cos(), 0.4 * t.sin()];
        for i in 0..16 {
            // ZMP after i+1 steps: free response and the effect of each jerk.
            let n = (i + 1) as f64 * dt;
            let free = start[0] + n * start[1] + (0.5 * n * n - height) * start[2];
            let mut row = [0.0; 16];
            for j in 0..=i {
                let m = (i - j) as f64;
                row[j] = (1.0 + 3.0 * m + 3.0 * m * m) * dt * dt * dt / 6.0 - dt * height;
            }
            let foot = if (((t + n) / 0.8) as usize).is_multiple_of(2) {
                0.08
            } else {
                -0.08
            };
            q.task(&row, 1e3, foot - free);
            q.a[i] = row;
            (q.l[i], q.u[i]) = (foot - 0.04 - free, foot + 0.04 - free);
        }
        for i in 0..16 {
            q.h[i][i] += 1e-2;
        }
        out.push(q);
    }
    out
}

/// Jerk control of a linear inverted pendulum that walks forward, in closed loop, as the public LIPMWALK programs state it: the end
/// of the horizon at rest over a foot, the zero-moment point in the foot that stands, anywhere while both do.
fn lipm(count: usize) -> Vec<Qp<16, 16>> {
    const N: usize = 16;
    let (dt, tick, height) = (0.1, 0.02, 0.8 / 9.81);
    let foot = |t: f64| 0.2 * (t / 0.8).floor();
    let mut state = [0.0; 3];
    let mut out = Vec::new();
    for k in 0..count {
        let t = k as f64 * tick;
        let mut q = Qp::<N, N>::zero();
        for i in 0..N {
            // Position, speed, acceleration after i + 1 samples: free response, and the effect of each jerk.
            let n = (i + 1) as f64 * dt;
            let free = [
                state[0] + n * state[1] + 0.5 * n * n * state[2],
                state[1] + n * state[2],
                state[2],
            ];
            let mut rows = [[0.0; N]; 3];
            for j in 0..=i {
                let m = (i - j) as f64;
                rows[0][j] = (1.0 + 3.0 * m + 3.0 * m * m) * dt * dt * dt / 6.0;
                rows[1][j] = (m + 0.5) * dt * dt;
                rows[2][j] = dt;
            }
            let point = free[0] - height * free[2];
            q.a[i] = core::array::from_fn(|j| rows[0][j] - height * rows[2][j]);
            let both_stand = (t + n) % 0.8 >= 0.7;
            let reach = if both_stand { 1000.0 } else { 0.05 };
            let centre = foot(t + n) - point;
            (q.l[i], q.u[i]) = (centre - reach, centre + reach);
            if i == N - 1 {
                let goal = [foot(t + n), 0.0, 0.0];
                for (row, (goal, free)) in rows.iter().zip(goal.iter().zip(free)) {
                    q.task(row, 1.0, goal - free);
                }
            }
        }
        for i in 0..N {
            q.h[i][i] += 1e-3;
        }
        let jerk = first_input(&q);
        state = [
            state[0] + tick * (state[1] + tick * (0.5 * state[2] + tick * jerk / 6.0)),
            state[1] + tick * (state[2] + 0.5 * tick * jerk),
            state[2] + tick * jerk,
        ];
        out.push(q);
    }
    out
}

/// What a controller would do next.
fn first_input<const N: usize, const M: usize>(q: &Qp<N, M>) -> f64 {
    let problem = Problem::new(&q.h, &q.g, &q.a, &q.l, &q.u);
    let mut workspace = Workspace::new();
    let solution = solve(&problem, &Settings::default(), &mut workspace).unwrap();
    assert_eq!(solution.status, Status::Solved);
    solution.x[0]
}

fn write<const N: usize, const M: usize>(folder: &Path, name: &str, qps: &[Qp<N, M>]) {
    let mut numbers = vec![N as f64, M as f64, qps.len() as f64];
    for q in qps {
        numbers.extend(q.h.iter().flatten().chain(&q.g));
        numbers.extend(q.a.iter().flatten().chain(&q.l).chain(&q.u));
        numbers.extend([-INF; N]);
        numbers.extend([INF; N]);
    }
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.join(name).with_extension("qps"), bytes).unwrap();
}

fn main() {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("usage: peers FOLDER");
        std::process::exit(2)
    };
    let folder = Path::new(&folder);
    write(folder, "landing20", &landing::<20>(400));
    write(folder, "landing32", &landing::<32>(400));
    write(folder, "humanoid", &humanoid(200));
    write(folder, "pendulum", &pendulum(400));
    write(folder, "lipm", &lipm(400));
}
