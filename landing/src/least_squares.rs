//! Least squares over a limb's few joints.

use nalgebra::{Matrix3, Vector3};
use rbd_core::LimbEnd;
use so3::Scalar;

/// LDLᵀ of a symmetric positive definite 3 × 3 matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ldl3<T> {
    /// 1/D.
    d: [T; 3],
    /// L below its diagonal: (1, 0), (2, 0), (2, 1).
    l: [T; 3],
}

impl<T: Scalar> Ldl3<T> {
    /// Reads the lower triangle.
    #[inline(always)]
    pub(crate) fn new(a: &Matrix3<T>) -> Self {
        let d0 = T::ONE / a.m11;
        let (l1, l2) = (a.m21 * d0, a.m31 * d0);
        let d1 = T::ONE / (a.m22 - l1 * a.m21);
        let e = a.m32 - l1 * a.m31;
        let l3 = e * d1;
        Self {
            d: [d0, d1, T::ONE / (a.m33 - l2 * a.m31 - l3 * e)],
            l: [l1, l2, l3],
        }
    }

    /// A⁻¹ b.
    #[inline(always)]
    pub(crate) fn solve(&self, b: &Vector3<T>) -> Vector3<T> {
        let ([d0, d1, d2], [l1, l2, l3]) = (self.d, self.l);
        let y = b.y - l1 * b.x;
        let z = (b.z - l2 * b.x - l3 * y) * d2;
        let y = y * d1 - l3 * z;
        Vector3::new(b.x * d0 - l1 * y - l2 * z, y, z)
    }
}

/// (J Jᵀ + ε)⁻¹ b for the Jacobian of a limb's end; ε > 0 keeps it regular, without it a leg that is not stretched is needed. Numbers that
/// are not finite come out where such go in.
#[must_use]
pub fn solve_damped<T: Scalar, const N: usize>(
    end: &LimbEnd<T, N>,
    damping: T,
    b: &Vector3<T>,
) -> Vector3<T> {
    let mut a = Matrix3::from_diagonal_element(damping);
    for (_, c) in end.columns() {
        a.m11 += c.x * c.x;
        a.m21 += c.x * c.y;
        a.m31 += c.x * c.z;
        a.m22 += c.y * c.y;
        a.m32 += c.y * c.z;
        a.m33 += c.z * c.z;
    }
    Ldl3::new(&a).solve(b)
}

#[cfg(test)]
mod tests {
    use super::solve_damped;
    use a1_model::{A1Geared, FEET};
    use nalgebra::{Matrix3, Vector3};
    use rbd_core::{Configuration, Limbs};

    #[test]
    fn solves_the_normal_equations() {
        let q = Configuration {
            joints: [0.2; 12],
            ..Configuration::NEUTRAL
        };
        let limbs = Limbs::new(&A1Geared, &q, &FEET.map(|foot| foot.frame));
        let b = Vector3::new(1.0, -2.0, 0.5);
        for end in &limbs.ends {
            let mut square = Matrix3::from_diagonal_element(1e-3);
            for (_, c) in end.columns() {
                square += c * c.transpose();
            }
            let x = solve_damped(end, 1e-3, &b);
            assert!((square * x - b).norm() < 1e-12);
        }
    }
}
