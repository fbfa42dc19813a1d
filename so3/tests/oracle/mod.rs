//! Numbers with 106 bits, as unevaluated sums: error-free transformations after Dekker and Knuth.

#[derive(Clone, Copy)]
pub(crate) struct Dd(pub(crate) f64, pub(crate) f64);

fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let t = s - a;
    Dd(s, (a - (s - t)) + (b - t))
}

fn split(a: f64) -> (f64, f64) {
    let t = a * 134_217_729.0;
    let high = t - (t - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> Dd {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Dd {
    pub(crate) fn add(self, o: Dd) -> Dd {
        let (s, t) = (two_sum(self.0, o.0), two_sum(self.1, o.1));
        let s = two_sum(s.0, s.1 + t.0);
        two_sum(s.0, s.1 + t.1)
    }
    pub(crate) fn mul(self, o: Dd) -> Dd {
        let p = two_product(self.0, o.0);
        two_sum(p.0, p.1 + (self.0 * o.1 + self.1 * o.0))
    }
    pub(crate) fn minus(self) -> Dd {
        Dd(-self.0, -self.1)
    }
    /// The quotient of two double-doubles.
    pub(crate) fn over(self, o: Dd) -> Dd {
        let q = Dd(self.0 / o.0, 0.0);
        let r = self.add(q.mul(o).minus());
        q.add(Dd(r.0 / o.0, 0.0))
    }
    pub(crate) fn div(self, d: f64) -> Dd {
        let q = self.0 / d;
        let r = self.add(two_product(-q, d));
        two_sum(q, (r.0 + r.1) / d)
    }
}

/// π/2 to about 200 bits.
const HALF_PI: [f64; 4] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
    5.562_271_104_316_826e-50,
];

/// Taylor series of the sine (from r) or the cosine (from 1) on |r| ≤ π/4.
fn series(first: Dd, r: Dd, mut n: f64) -> Dd {
    let z = r.mul(r);
    let (mut term, mut sum) = (first, first);
    while n < 40.0 {
        term = term.mul(z).div(-(n + 1.0) * (n + 2.0));
        sum = sum.add(term);
        n += 2.0;
    }
    sum
}

/// (sin x, cos x) to about 100 bits, |x| < 10⁴.
pub(crate) fn sin_cos(x: f64) -> (Dd, Dd) {
    let k = (x / HALF_PI[0]).round();
    let r = HALF_PI
        .iter()
        .fold(Dd(x, 0.0), |r, &part| r.add(two_product(-k, part)));
    let (s, c) = (series(r, r, 1.0), series(Dd(1.0, 0.0), r, 0.0));
    match k.rem_euclid(4.0) as u8 {
        0 => (s, c),
        1 => (c, s.minus()),
        2 => (s.minus(), c.minus()),
        _ => (c.minus(), s),
    }
}

/// atan x, |x| < 10¹⁰⁰: one Newton step from the nearest double, with tan(a − y) = (x cos y − sin y)/(cos y + x sin y).
pub(crate) fn atan(x: f64) -> Dd {
    let y = libm::atan(x);
    let ((sin, cos), x) = (sin_cos(y), Dd(x, 0.0));
    let rest = x.mul(cos).add(sin.minus()).over(cos.add(x.mul(sin)));
    Dd(y, 0.0).add(rest)
}

/// Distance from `value` to the exact number in units in its last place.
pub(crate) fn ulps(value: f64, exact: Dd) -> f64 {
    let near = exact.0.abs();
    let unit = f64::from_bits(near.to_bits() + 1) - near;
    (((value - exact.0) - exact.1) / unit).abs()
}

/// Σ (−z)ᵏ/(2k + n)!: cos θ, sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ for n = 0, 1, 2, 3 at z = θ² < 200.
pub(crate) fn even_series(z: Dd, n: u32) -> Dd {
    let factorial = (1..=n).map(f64::from).product::<f64>();
    let mut term = Dd(1.0, 0.0).div(factorial);
    let mut sum = term;
    for k in 0..100 {
        let m = f64::from(2 * k + n);
        term = term.mul(z.minus()).div((m + 1.0) * (m + 2.0));
        sum = sum.add(term);
    }
    sum
}

/// (1 − (θ/2) cot(θ/2))/θ² at z = θ².
pub(crate) fn inverse_coefficient(z: Dd) -> Dd {
    if z.0 < 1e-10 {
        return Dd(1.0, 0.0).div(12.0).add(z.div(720.0));
    }
    let quarter = z.div(4.0);
    let cot = even_series(quarter, 0).over(even_series(quarter, 1));
    Dd(1.0, 0.0).add(cot.minus()).over(z)
}

/// I + p A + q A², A = hat(w), rounded to f64 at the end; w must be exact in f64.
pub(crate) fn polynomial(w: [f64; 3], coefficients: impl Fn(Dd) -> (Dd, Dd)) -> [[f64; 3]; 3] {
    let w = w.map(|c| Dd(c, 0.0));
    let z = w.iter().fold(Dd(0.0, 0.0), |z, c| z.add(c.mul(*c)));
    let (p, q) = coefficients(z);
    let o = Dd(0.0, 0.0);
    let hat = [
        [o, w[2].minus(), w[1]],
        [w[2], o, w[0].minus()],
        [w[1].minus(), w[0], o],
    ];
    let element = |i: usize, j: usize| {
        let diagonal = if i == j {
            Dd(1.0, 0.0).add(q.mul(z).minus())
        } else {
            o
        };
        diagonal.add(p.mul(hat[i][j])).add(q.mul(w[i].mul(w[j])))
    };
    core::array::from_fn(|i| core::array::from_fn(|j| element(i, j).0))
}
