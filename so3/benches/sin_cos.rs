//! Wall time of `math::sin_cos` beside `libm::sincos` and std, 12 joints per call, in one run.
//!
//! `cargo bench -p so3 --bench sin_cos`. Medians; read the ratios, not the nanoseconds.
#![allow(missing_docs, reason = "bench")]
#![allow(
    clippy::disallowed_methods,
    reason = "std is the peer that is measured"
)]
#![allow(clippy::unwrap_used, reason = "bench")]

use core::hint::black_box;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::time::Instant;

const JOINTS: usize = 12;
/// Different configurations, so that branches cannot be learnt by heart.
const CONFIGURATIONS: usize = 1024;
const ROUNDS: usize = 301;

/// Median nanoseconds of `call` over all configurations.
fn nanoseconds<I, O>(inputs: &[I], out: &mut O, mut call: impl FnMut(&I, &mut O)) -> f64 {
    let mut rounds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            for input in inputs {
                call(input, out);
                black_box(&mut *out);
            }
            start.elapsed().as_secs_f64() * 1e9 / inputs.len() as f64
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    rounds[ROUNDS / 2]
}

/// Configurations, the same on every machine.
fn drawn<S: Strategy>(configuration: &S) -> Vec<S::Value> {
    let mut runner = TestRunner::deterministic();
    let draw = |_| configuration.new_tree(&mut runner).unwrap().current();
    (0..CONFIGURATIONS).map(draw).collect()
}

macro_rules! table {
    ($t:ident, $libm:path, $spread:expr) => {{
        let inputs: Vec<[$t; JOINTS]> = drawn(&prop::array::uniform(-$spread as $t..$spread as $t));
        let mut out = ([0.0; JOINTS], [0.0; JOINTS]);
        let mut each = |f: fn($t) -> ($t, $t)| {
            nanoseconds(&inputs, &mut out, |x, out| {
                for (i, &x) in x.iter().enumerate() {
                    (out.0[i], out.1[i]) = f(x);
                }
            })
        };
        let (libm, std) = (each($libm), each($t::sin_cos));
        let single = nanoseconds(&inputs, &mut out, |x, out| {
            for (i, &x) in x.iter().enumerate() {
                (out.0[i], out.1[i]) = so3::math::sin_cos(x);
            }
        });
        let array = nanoseconds(&inputs, &mut out, |x, out| {
            *out = so3::math::sin_cos_array(x)
        });
        println!(
            "{} x {JOINTS}, |x| < {}     ns   / libm",
            stringify!($t),
            $spread
        );
        for (name, time) in [
            ("libm", libm),
            ("std", std),
            ("sin_cos", single),
            ("sin_cos_array", array),
        ] {
            println!("{name:<20} {time:7.1} {:7.2}", time / libm);
        }
    }};
}

fn main() {
    table!(f64, libm::sincos, 0.75);
    table!(f64, libm::sincos, 3.0);
    table!(f32, libm::sincosf, 0.75);
    table!(f32, libm::sincosf, 3.0);
}
