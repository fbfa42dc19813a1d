//! Least squares over a limb's few joints.

use nalgebra::Vector3;
use rbd_core::LimbEnd;
use so3::Scalar;

/// (J Jᵀ + ε)⁻¹ b for the Jacobian of a limb's end: LDLᵀ of a 3 × 3 matrix, which ε > 0 keeps regular. Numbers that are not
/// finite come out where such go in.
pub(crate) fn solve_damped<T: Scalar, const N: usize>(
    end: &LimbEnd<T, N>,
    damping: T,
    b: &Vector3<T>,
) -> Vector3<T> {
    let (mut xx, mut yy, mut zz) = (damping, damping, damping);
    let (mut xy, mut xz, mut yz) = (T::ZERO, T::ZERO, T::ZERO);
    for (_, c) in end.columns() {
        xx += c.x * c.x;
        xy += c.x * c.y;
        xz += c.x * c.z;
        yy += c.y * c.y;
        yz += c.y * c.z;
        zz += c.z * c.z;
    }
    let d0 = T::ONE / xx;
    let (l1, l2) = (xy * d0, xz * d0);
    let d1 = T::ONE / (yy - l1 * xy);
    let e = yz - l1 * xz;
    let l3 = e * d1;
    let d2 = T::ONE / (zz - l2 * xz - l3 * e);
    let y = b.y - l1 * b.x;
    let z = (b.z - l2 * b.x - l3 * y) * d2;
    let y = y * d1 - l3 * z;
    Vector3::new(b.x * d0 - l1 * y - l2 * z, y, z)
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
