//! Unit quaternions at the edge of the house: conversions, storage orders, exp, log, slerp.
//!
//! Inside, orientations are matrices; quaternions come from sensors, simulators and files. `UnitQuaternion` is
//! nalgebra's, stored x, y, z, w. A unit quaternion (v, s) = (a sin(θ/2), cos(θ/2)) and its negative are the same
//! rotation by θ about a; what this module makes of a matrix has s ≥ 0. Products are Hamilton's: q_ac = q_ab q_bc.
//!
//! | who | order | function |
//! |---|---|---|
//! | this workspace, ROS, Pinocchio | x, y, z, w | [`from_xyzw`], [`to_xyzw`] |
//! | MuJoCo (`qpos`), Unitree (IMU message) | w, x, y, z | [`from_wxyz`], [`to_wxyz`] |

use nalgebra::Quaternion;

use crate::{Error, Matrix3, Rotation3, Scalar, UnitQuaternion, Vector3, hat, math, small_angle};

/// The quaternion [x, y, z, w] of a matrix times four times its largest component.
///
/// For a rotation, 4x² = 1 + R₁₁ − R₂₂ − R₃₃ and its three sisters, 4xw = R₃₂ − R₂₃, 4xy = R₁₂ + R₂₁ and so on; the row
/// with the largest square is taken. The four squares add to 4 for any matrix, so that one is at least 1.
pub(crate) fn unnormalized<T: Scalar>(m: &Matrix3<T>) -> [T; 4] {
    let (xy, yz, zx) = (m.m12 + m.m21, m.m23 + m.m32, m.m31 + m.m13);
    let (xw, yw, zw) = (m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12);
    let one = T::ONE;
    if m.m11 + m.m22 + m.m33 >= math::max(m.m11, math::max(m.m22, m.m33)) {
        [xw, yw, zw, one + (m.m11 + m.m22 + m.m33)]
    } else if m.m11 >= m.m22 && m.m11 >= m.m33 {
        [one + (m.m11 - m.m22 - m.m33), xy, zx, xw]
    } else if m.m22 >= m.m33 {
        [xy, one + (m.m22 - m.m33 - m.m11), yz, yw]
    } else {
        [zx, yz, one + (m.m33 - m.m11 - m.m22), zw]
    }
}

/// θ/|v| = 2 atan2(|v|, s)/|v| for a quaternion (v, s) of any length with s ≥ 0: times v, its rotation vector; times
/// s/2, the half angle times its cotangent.
#[inline(always)]
pub(crate) fn angle_per_length<T: Scalar>(v: &Vector3<T>, s: T) -> T {
    let length_squared = v.norm_squared();
    let negligible = T::EPSILON * s;
    if length_squared <= negligible * negligible {
        // atan(u)/u = 1 − u²/3 + …, u ≤ ε; also where |v|² underflows.
        return T::TWO / s;
    }
    let length = math::sqrt(length_squared);
    let per_length = T::TWO / length;
    math::quadrant(length, s) * per_length
}

/// The same rotation with s ≥ 0.
#[inline(always)]
pub(crate) fn short_way<T: Scalar>(v: &Vector3<T>, s: T) -> (Vector3<T>, T) {
    if s < T::ZERO { (-v, -s) } else { (*v, s) }
}

/// 2 atan2(|v|, s)/|v| v for a quaternion (v, s) of any length; (−v, −s) where s < 0.
pub(crate) fn rotation_vector<T: Scalar>(v: &Vector3<T>, s: T) -> Vector3<T> {
    let (v, s) = short_way(v, s);
    v * angle_per_length(&v, s)
}

/// Unit quaternion of a rotation matrix, with w ≥ 0.
///
/// The matrix may be slightly not a rotation. NaN if an element is NaN.
///
/// # Accuracy
/// `to_rotation(from_rotation(R))` = R within 8 ε (test `quaternion_round_trip`).
///
/// # References
/// Shepperd 1978, Journal of Guidance and Control 1(3).
#[must_use]
pub fn from_rotation<T: Scalar>(rot: &Rotation3<T>) -> UnitQuaternion<T> {
    let q = unnormalized(rot.matrix());
    let norm = math::sqrt(q.iter().fold(T::ZERO, |sum, &c| sum + c * c));
    let scale = if q[3] < T::ZERO {
        -T::ONE / norm
    } else {
        T::ONE / norm
    };
    let [x, y, z, w] = q.map(|c| c * scale);
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// Rotation matrix of a unit quaternion: I + 2/|q|² (s hat(v) + hat(v)²).
///
/// Dividing by |q|² makes the result orthonormal to rounding error even where |q| has drifted from 1.
///
/// Test: `quaternion_round_trip`, `drifted_quaternions_give_rotations`.
#[must_use]
pub fn to_rotation<T: Scalar>(quat: &UnitQuaternion<T>) -> Rotation3<T> {
    let (v, s) = (quat.imag(), quat.w);
    let scale = T::TWO / (v.norm_squared() + s * s);
    let diagonal = T::ONE - scale * v.norm_squared();
    Rotation3::from_matrix_unchecked(hat::combination(&v, diagonal, scale * s, scale))
}

/// Unit quaternion from numbers in the order x, y, z, w, normalised.
///
/// # Errors
/// [`Error::NotFinite`] for NaN or infinities, [`Error::ZeroQuaternion`] where the length is below 10⁻⁶: a message
/// that was never filled must not pass for an orientation.
pub fn from_xyzw<T: Scalar>([x, y, z, w]: [T; 4]) -> Result<UnitQuaternion<T>, Error> {
    if ![x, y, z, w].iter().all(|c| c.is_finite_number()) {
        return Err(Error::NotFinite {
            parameter: "quaternion",
        });
    }
    // Scaled by the largest component, the squares cannot overflow.
    let largest = [x, y, z, w]
        .iter()
        .fold(T::ZERO, |m, &c| math::max(m, math::abs(c)));
    if largest < T::of(1e-6) {
        return Err(Error::ZeroQuaternion);
    }
    let q = Quaternion::new(w / largest, x / largest, y / largest, z / largest);
    Ok(UnitQuaternion::new_unchecked(
        q / math::sqrt(q.norm_squared()),
    ))
}

/// Unit quaternion from numbers in the order w, x, y, z of MuJoCo and Unitree, normalised.
///
/// # Errors
/// Those of [`from_xyzw`].
pub fn from_wxyz<T: Scalar>([w, x, y, z]: [T; 4]) -> Result<UnitQuaternion<T>, Error> {
    from_xyzw([x, y, z, w])
}

/// Components in the order x, y, z, w.
#[must_use]
pub fn to_xyzw<T: Scalar>(quat: &UnitQuaternion<T>) -> [T; 4] {
    [quat.i, quat.j, quat.k, quat.w]
}

/// Components in the order w, x, y, z of MuJoCo and Unitree.
#[must_use]
pub fn to_wxyz<T: Scalar>(quat: &UnitQuaternion<T>) -> [T; 4] {
    [quat.w, quat.i, quat.j, quat.k]
}

/// Unit quaternion of the rotation vector `w`, in rad: (½ (sin h/h) w, cos h), h = |w|/2.
///
/// Not folded to s ≥ 0: it is continuous in w and changes sign after a whole turn.
///
/// Test: `quaternion_exp_and_log`.
#[must_use]
pub fn exp<T: Scalar>(w: &Vector3<T>) -> UnitQuaternion<T> {
    let half = w * T::HALF;
    let h_squared = half.norm_squared();
    let (a, b) = small_angle::sine_and_versine(h_squared);
    let v = half * a;
    UnitQuaternion::new_unchecked(Quaternion::new(T::ONE - b * h_squared, v.x, v.y, v.z))
}

/// Rotation vector of a unit quaternion, in rad, |w| ≤ π: 2 atan2(|v|, s)/|v| v; equal for q and −q.
///
/// Test: `quaternion_exp_and_log`.
#[must_use]
pub fn log<T: Scalar>(quat: &UnitQuaternion<T>) -> Vector3<T> {
    rotation_vector(&quat.imag().into_owned(), quat.w)
}

/// The shortest way from `start` (fraction 0) to `end` (fraction 1) at constant speed: q₀ exp(f log(q₀⁻¹ q₁)).
///
/// Fractions outside [0, 1] extrapolate. For whole turns use [`crate::Geodesic`].
///
/// Test: `slerp_is_the_geodesic`.
#[must_use]
pub fn slerp<T: Scalar>(
    start: &UnitQuaternion<T>,
    end: &UnitQuaternion<T>,
    fraction: T,
) -> UnitQuaternion<T> {
    start * exp(&(log(&(start.inverse() * end)) * fraction))
}
