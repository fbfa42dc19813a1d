//! Rotations as problem (2) of paper A uses them: the Taylor-4 exponential and the smoothed logarithm error.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::{atan2, sin_cos, sqrt};
pub(crate) use so3::{hat, vee};

/// Derivative of [`vee`] of `E Exp(θ)` at θ = 0: `½ (tr(E) I − Eᵀ)`.
#[inline(always)]
pub(crate) fn vee_derivative<T: Scalar>(e: &Matrix3<T>) -> Matrix3<T> {
    (Matrix3::from_diagonal_element(e.trace()) - e.transpose()) * T::HALF
}

/// Right Jacobian of the Taylor-4 exponential to its order: `E4(w + δ) ≈ E4(w) Exp(J δ)`.
#[inline(always)]
pub(crate) fn exp4_jacobian<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    let (a, s) = (hat(w), w.norm_squared());
    let linear = s / T::of(24.0) - T::HALF;
    let square = (T::ONE - s / T::of(20.0)) / T::of(6.0);
    Matrix3::identity() + a * linear + (a * a) * square
}

/// Exact exponential.
#[inline(always)]
pub(crate) fn exp<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    let s = w.norm_squared();
    let (linear, square) = if s < T::of(1e-8) {
        (T::ONE - s / T::of(6.0), T::HALF - s / T::of(24.0))
    } else {
        let angle = sqrt(s);
        let (sin, cos) = sin_cos(angle);
        (sin / angle, (T::ONE - cos) / s)
    };
    let a = hat(w);
    Matrix3::identity() + a * linear + (a * a) * square
}

/// Logarithm of a matrix that is a rotation up to a small drift, angle below π.
#[inline(always)]
pub(crate) fn log<T: Scalar>(e: &Matrix3<T>) -> Vector3<T> {
    let v = vee(e);
    let s = v.norm_squared();
    let cos = (e.trace() - T::ONE) * T::HALF;
    if s < T::of(1e-12) && cos > T::ZERO {
        return v * (T::ONE + s / T::of(6.0));
    }
    let sin = sqrt(s);
    v * (atan2(sin, cos) / sin)
}

/// Rotation by the angle whose sine and cosine are given about a unit axis.
#[inline(always)]
pub(crate) fn about_axis<T: Scalar>(axis: &Vector3<T>, sin: T, cos: T) -> Matrix3<T> {
    let a = hat(axis);
    Matrix3::identity() + a * sin + (a * a) * (T::ONE - cos)
}

/// Inverse of a matrix near a rotation: the adjugate over the determinant.
#[inline(always)]
pub(crate) fn inverse<T: Scalar>(m: &Matrix3<T>) -> Matrix3<T> {
    let (a, b, c) = (m.column(0), m.column(1), m.column(2));
    let (x, y, z) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let inverse = T::ONE / a.dot(&x);
    Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]) * inverse
}

/// Smoothed logarithm error of `E`: `e = s atan2(r, c)/r`, `s = vee((E − Eᵀ)/2)`, `c = (tr E − 1)/2`,
/// `r = √(s·s + ε)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogError<T> {
    /// The error vector.
    pub(crate) error: Vector3<T>,
    s: Vector3<T>,
    c: T,
    r: T,
    angle: T,
}

impl<T: Scalar> LogError<T> {
    #[inline(always)]
    pub(crate) fn new(e: &Matrix3<T>, epsilon: T) -> Self {
        let s = vee(e);
        let c = (e.trace() - T::ONE) * T::HALF;
        let r = sqrt(s.norm_squared() + epsilon);
        let angle = atan2(r, c);
        Self {
            error: s * (angle / r),
            s,
            c,
            r,
            angle,
        }
    }

    /// Derivative of the error of `E Exp(θ)` at θ = 0.
    #[inline(always)]
    pub(crate) fn derivative(&self, e: &Matrix3<T>) -> Matrix3<T> {
        let Self { s, c, r, angle, .. } = *self;
        let ds = vee_derivative(e);
        // h = atan2(r, c)/r;  dr = sᵀ ds / r,  dc = −sᵀ θ.
        let square = r * r + c * c;
        let by_r = (c / square - angle / r) / r;
        let by_c = -T::ONE / square;
        let dh = (s.transpose() * ds) * (by_r / r) - s.transpose() * by_c;
        ds * (angle / r) + s * dh
    }

    /// Second derivative of the squared error of `E Exp(θ)` at θ = 0.
    ///
    /// The square is `F = h(q) atan2(r, c)²` with `q = s·s` and `h = q/(q + ε)`, so with `D = r² + c²`
    ///
    /// ```text
    /// F'' = F_qq q' q'ᵀ + F_qc (q' c'ᵀ + c' q'ᵀ) + F_cc c' c'ᵀ + F_q q'' + F_c c''
    /// q' = 2 dsᵀ s,   q'' = 2 dsᵀ ds + sym(hat(s)ᵀ E) − 2 q I
    /// c' = −s,        c'' = ½ (sym(E) − tr(E) I)
    /// ```
    ///
    /// Without it (Gauss–Newton) Newton's method diverges slowly at solutions that leave the reference far.
    #[inline(always)]
    pub(crate) fn curvature(&self, e: &Matrix3<T>, epsilon: T) -> Matrix3<T> {
        let Self { s, c, r, angle, .. } = *self;
        let two = T::TWO;
        let (q, rho) = (s.norm_squared(), r * r);
        let d = rho + c * c;
        // The angle and its derivatives in q and c.
        let a_q = c / (two * r * d);
        let a_c = -r / d;
        let a_qq = -c * (d + two * rho) / (T::of(4.0) * r * rho * d * d);
        let a_qc = (rho - c * c) / (two * r * d * d);
        let a_cc = two * r * c / (d * d);
        let (h, h_q, h_qq) = (
            q / rho,
            epsilon / (rho * rho),
            -two * epsilon / (rho * rho * rho),
        );
        let f_q = h_q * angle * angle + two * h * angle * a_q;
        let f_c = two * h * angle * a_c;
        let f_qq = h_qq * angle * angle
            + T::of(4.0) * h_q * angle * a_q
            + two * h * (a_q * a_q + angle * a_qq);
        let f_qc = two * h_q * angle * a_c + two * h * (a_q * a_c + angle * a_qc);
        let f_cc = two * h * (a_c * a_c + angle * a_cc);
        let ds = vee_derivative(e);
        let (in_q, in_c) = (ds.transpose() * s * two, -s);
        let symmetric = |m: Matrix3<T>| (m + m.transpose()) * T::HALF;
        let identity = Matrix3::identity();
        let by_q =
            ds.transpose() * ds * two + symmetric(hat(&s).transpose() * e) - identity * (two * q);
        let by_c = (symmetric(*e) - identity * e.trace()) * T::HALF;
        let mixed = in_q * in_c.transpose();
        in_q * in_q.transpose() * f_qq
            + (mixed + mixed.transpose()) * f_qc
            + in_c * in_c.transpose() * f_cc
            + by_q * f_q
            + by_c * f_c
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use so3::exp_taylor4 as exp4;

    #[test]
    fn the_log_error_derivative_matches_differences() {
        let e = exp(&Vector3::new(0.4f64, -0.9, 1.3));
        let h = 1e-6;
        let exact = LogError::new(&e, 1e-6).derivative(&e);
        for j in 0..3 {
            let mut w = Vector3::zeros();
            w[j] = h;
            let plus = LogError::new(&(e * exp(&w)), 1e-6).error;
            let minus = LogError::new(&(e * exp(&-w)), 1e-6).error;
            let column = (plus - minus) / (2.0 * h);
            assert!((column - exact.column(j)).norm() < 1e-8);
        }
    }

    #[test]
    fn the_curvature_of_the_squared_error_matches_differences() {
        for turn in [
            Vector3::new(0.4f64, -0.9, 1.3),
            Vector3::new(1.9, 1.7, 1.2),
            Vector3::new(1e-3, 2e-3, -1e-3),
            Vector3::zeros(),
        ] {
            let e = exp(&turn);
            let h = 1e-5;
            let exact = LogError::new(&e, 1e-6).curvature(&e, 1e-6);
            let square = |w: Vector3<f64>| LogError::new(&(e * exp(&w)), 1e-6).error.norm_squared();
            for i in 0..3 {
                for j in 0..3 {
                    let at = |a: f64, b: f64| {
                        let mut w = Vector3::zeros();
                        w[i] += a;
                        w[j] += b;
                        square(w)
                    };
                    let numeric = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4.0 * h * h);
                    assert!(
                        (numeric - exact[(i, j)]).abs() < 2e-4,
                        "{turn:?} {i} {j}: {numeric} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn exp_and_log_are_inverse_and_taylor_is_close() {
        let w = Vector3::new(0.1f64, -0.2, 0.15);
        assert!((log(&exp(&w)) - w).norm() < 1e-14);
        assert!((exp4(&w) - exp(&w)).norm() < 1e-4);
        assert!((inverse(&exp4(&w)) * exp4(&w) - Matrix3::identity()).norm() < 1e-14);
        let h = 1e-5;
        for j in 0..3 {
            let mut step = Vector3::zeros();
            step[j] = h;
            let difference = log(&(inverse(&exp(&(w - step))) * exp(&(w + step)))) / (2.0 * h);
            assert!((difference - exp4_jacobian(&w).column(j)).norm() < 1e-5);
        }
    }
}
