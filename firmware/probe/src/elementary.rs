//! `so3::math`: the elementary functions.

use so3::math;

use crate::inputs::Stream;
use crate::{Real, Recorder, Subject};

/// Where elementary functions change their method: zeros, subnormals, the ends of the reduced range, huge arguments,
/// and what is not a number.
const EDGES: [f64; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-310,
    1e-40,
    -1e-8,
    core::f64::consts::FRAC_PI_4,
    core::f64::consts::FRAC_PI_2,
    -core::f64::consts::PI,
    100.0,
    -1e5,
    402.0,
    3217.0,
    1e22,
    -1e300,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// Random arguments per range.
const DRAWS: usize = 24;

pub(crate) fn run<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>) {
    on.name = "math";
    for x in EDGES {
        functions(on, T::of(x));
    }
    let mut stream = Stream::new(1);
    for _ in 0..DRAWS {
        functions(on, stream.next(1.0));
        functions(on, stream.next(7.0));
        functions(on, stream.next(2000.0));
        let angles = stream.array::<T, 12>(500.0);
        on.call("sin_cos_array", &angles, math::sin_cos_array);
        on.call("sin_cos_into", &angles, |angles| {
            let (mut sin, mut cos) = ([T::ZERO; 12], [T::ZERO; 12]);
            math::sin_cos_into(angles, &mut sin, &mut cos);
            (sin, cos)
        });
        let (y, x): (T, T) = (stream.next(3.0), stream.next(3.0));
        on.call("atan2", (y, x), |(y, x)| math::atan2(y, x));
    }
    for y in EDGES {
        for x in EDGES {
            let (y, x) = (T::of(y), T::of(x));
            on.call("atan2", (y, x), |(y, x)| math::atan2(y, x));
            on.call("min", (y, x), |(y, x)| math::min(y, x));
            on.call("max", (y, x), |(y, x)| math::max(y, x));
            on.call("hypot", (y, x), |(y, x)| math::hypot(y, x));
            on.call("clamp", (y, x), |(y, x)| math::clamp(y, -T::ONE, x));
            on.call("copysign", (y, x), |(y, x)| math::copysign(y, x));
            on.call("mul_add", (y, x), |(y, x)| math::mul_add(y, x, T::HALF));
        }
    }
}

fn functions<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, x: T) {
    on.call("sqrt", x, math::sqrt);
    on.call("sin", x, math::sin);
    on.call("cos", x, math::cos);
    on.call("sin_cos", x, math::sin_cos);
    on.call("tan", x, math::tan);
    on.call("asin", x, math::asin);
    on.call("acos", x, math::acos);
    on.call("atan", x, math::atan);
    on.call("exp", x, math::exp);
    on.call("log", x, math::log);
    on.call("tanh", x, math::tanh);
    on.call("floor", x, math::floor);
    on.call("abs", x, math::abs);
    on.call("powi", (x, 7), |(x, n)| math::powi(x, n));
}
