//! Roll, pitch and yaw in the two orders that paper A's generalised coordinates need.
//!
//! q = [x, y, z, roll, pitch, yaw, joints] (paper A, eq. 4). Angles always stand as the vector
//! (roll, pitch, yaw) = turns about (x, y, z), whichever order they are applied in:
//!
//! | order | `rot_wb` | middle angle, singular at ±π/2 | for |
//! |---|---|---|---|
//! | [`RollPitchYaw::Zyx`] | Rz(yaw) Ry(pitch) Rx(roll) | pitch | jumps and barrel rolls |
//! | [`RollPitchYaw::Zxy`] | Rz(yaw) Rx(roll) Ry(pitch) | roll | backflips, whose pitch passes ±π/2 |
//!
//! # At gimbal lock
//! Where the middle angle is ±π/2 only the sum or difference of the other two is determined. [`RollPitchYaw::angles`]
//! sets the innermost (roll in zyx, pitch in zxy) from whatever the two vanishing elements say, zero if they are
//! exactly zero, and computes yaw *after* that choice; so the angles always reproduce the rotation to rounding
//! error, there and near there. The rates do not exist there; [`RollPitchYaw::rates_from_omega`] says so.

use crate::{Error, Matrix3, Rotation3, Scalar, Vector3, math};

/// Order of the three turns; the variant's letters are the axes from left to right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RollPitchYaw {
    /// Rz(yaw) Ry(pitch) Rx(roll).
    Zyx,
    /// Rz(yaw) Rx(roll) Ry(pitch).
    Zxy,
}

/// Rotation about x by `angle` in rad: y turns towards z.
#[must_use]
pub fn rotation_x<T: Scalar>(angle: T) -> Rotation3<T> {
    let ((s, c), o, i) = (math::sin_cos(angle), T::ZERO, T::ONE);
    Rotation3::from_matrix_unchecked(Matrix3::new(i, o, o, o, c, -s, o, s, c))
}

/// Rotation about y by `angle` in rad: z turns towards x.
#[must_use]
pub fn rotation_y<T: Scalar>(angle: T) -> Rotation3<T> {
    let ((s, c), o, i) = (math::sin_cos(angle), T::ZERO, T::ONE);
    Rotation3::from_matrix_unchecked(Matrix3::new(c, o, s, o, i, o, -s, o, c))
}

/// Rotation about z by `angle` in rad: x turns towards y.
#[must_use]
pub fn rotation_z<T: Scalar>(angle: T) -> Rotation3<T> {
    let ((s, c), o, i) = (math::sin_cos(angle), T::ZERO, T::ONE);
    Rotation3::from_matrix_unchecked(Matrix3::new(c, -s, o, s, c, o, o, o, i))
}

/// Multiple of 2π away from `angle` that is nearest to `near`.
fn unwrap<T: Scalar>(angle: T, near: T) -> T {
    let turn = T::TWO * T::PI;
    angle + turn * math::floor((near - angle) / turn + T::HALF)
}

impl RollPitchYaw {
    /// Rotation `rot_wb` of the angles (roll, pitch, yaw) in rad, of any size.
    ///
    /// Test: `angles_round_trip`, `matches_products_of_elementary_rotations`.
    #[must_use]
    pub fn rotation<T: Scalar>(self, rpy: &Vector3<T>) -> Rotation3<T> {
        let ([sr, sp, sy], [cr, cp, cy]) = math::sin_cos_array(&[rpy.x, rpy.y, rpy.z]);
        Rotation3::from_matrix_unchecked(match self {
            Self::Zyx => Matrix3::new(
                cy * cp,
                cy * sp * sr - sy * cr,
                cy * sp * cr + sy * sr,
                sy * cp,
                sy * sp * sr + cy * cr,
                sy * sp * cr - cy * sr,
                -sp,
                cp * sr,
                cp * cr,
            ),
            Self::Zxy => Matrix3::new(
                cy * cp - sy * sr * sp,
                -sy * cr,
                cy * sp + sy * sr * cp,
                sy * cp + cy * sr * sp,
                cy * cr,
                sy * sp - cy * sr * cp,
                -cr * sp,
                sr,
                cr * cp,
            ),
        })
    }

    /// Angles (roll, pitch, yaw) of a rotation `rot_wb`, in rad: middle angle in [−π/2, π/2], others in [−π, π].
    ///
    /// # Accuracy
    /// `rotation(angles(R))` = R within 8 ε, at gimbal lock too (tests `angles_round_trip`, `at_gimbal_lock`).
    #[must_use]
    pub fn angles<T: Scalar>(self, rot: &Rotation3<T>) -> Vector3<T> {
        let m = rot.matrix();
        match self {
            Self::Zyx => {
                // Third row: (−sin p, cos p sin r, cos p cos r). Then R Rx(−r) = Rz(y) Ry(p), second column.
                let roll = math::atan2(m.m32, m.m33);
                let pitch = math::atan2(-m.m31, math::hypot(m.m32, m.m33));
                let (s, c) = math::sin_cos(roll);
                let yaw = math::atan2(s * m.m13 - c * m.m12, c * m.m22 - s * m.m23);
                Vector3::new(roll, pitch, yaw)
            }
            Self::Zxy => {
                // Third row: (−cos r sin p, sin r, cos r cos p). Then R Ry(−p) = Rz(y) Rx(r), first column.
                let pitch = math::atan2(-m.m31, m.m33);
                let roll = math::atan2(m.m32, math::hypot(m.m31, m.m33));
                let (s, c) = math::sin_cos(pitch);
                let yaw = math::atan2(c * m.m21 + s * m.m23, c * m.m11 + s * m.m13);
                Vector3::new(roll, pitch, yaw)
            }
        }
    }

    /// Of all angles of a rotation the ones nearest to `hint`: continuous through whole turns.
    ///
    /// A rotation has two families of angles, (inner, middle, yaw) and (inner + π, π − middle, yaw + π), each modulo 2π
    /// per angle. Feeding each result as the next hint unwraps a trajectory: a double barrel roll ends at
    /// roll = 4π. Near gimbal lock the angles of neighbouring rotations are far apart by nature.
    ///
    /// Test: `angles_near_unwrap_a_double_roll`.
    #[must_use]
    pub fn angles_near<T: Scalar>(self, rot: &Rotation3<T>, hint: &Vector3<T>) -> Vector3<T> {
        let direct = self.angles(rot);
        let flipped = match self {
            Self::Zyx => Vector3::new(direct.x + T::PI, T::PI - direct.y, direct.z + T::PI),
            Self::Zxy => Vector3::new(T::PI - direct.x, direct.y + T::PI, direct.z + T::PI),
        };
        let direct = direct.zip_map(hint, unwrap);
        let flipped = flipped.zip_map(hint, unwrap);
        if (direct - hint).norm_squared() <= (flipped - hint).norm_squared() {
            direct
        } else {
            flipped
        }
    }

    /// Matrix E with ω_b = E (roll˙, pitch˙, yaw˙), 3×3; ω_b the body's angular velocity in the body frame, rad/s.
    ///
    /// Columns are the axes of the three turns seen from the body. In the world frame the matrix is R E.
    ///
    /// Test: `rates_are_the_derivative`.
    #[must_use]
    pub fn omega_from_rates<T: Scalar>(self, rpy: &Vector3<T>) -> Matrix3<T> {
        let ([sr, sp], [cr, cp]) = math::sin_cos_array(&[rpy.x, rpy.y]);
        let (o, i) = (T::ZERO, T::ONE);
        match self {
            Self::Zyx => Matrix3::new(i, o, -sp, o, cr, sr * cp, o, -sr, cr * cp),
            Self::Zxy => Matrix3::new(cp, o, -sp * cr, o, i, sr, sp, o, cp * cr),
        }
    }

    /// Ė (roll˙, pitch˙, yaw˙): what angular acceleration is left when the second derivatives of the angles vanish.
    ///
    /// ω̇_b = E (roll¨, pitch¨, yaw¨) + Ė (roll˙, pitch˙, yaw˙), in rad/s², body frame.
    ///
    /// Test: `acceleration_is_the_derivative`.
    #[must_use]
    pub fn omega_bias<T: Scalar>(self, rpy: &Vector3<T>, rates: &Vector3<T>) -> Vector3<T> {
        let ([sr, sp], [cr, cp]) = math::sin_cos_array(&[rpy.x, rpy.y]);
        let (r, p, y) = (rates.x, rates.y, rates.z);
        match self {
            Self::Zyx => Vector3::new(
                -cp * p * y,
                -sr * r * p + (cr * cp * r - sr * sp * p) * y,
                -cr * r * p - (sr * cp * r + cr * sp * p) * y,
            ),
            Self::Zxy => Vector3::new(
                -sp * p * r + (sp * sr * r - cp * cr * p) * y,
                cr * r * y,
                cp * p * r - (sp * cr * p + cp * sr * r) * y,
            ),
        }
    }

    /// Matrix E⁻¹ with (roll˙, pitch˙, yaw˙) = E⁻¹ ω_b, 3×3.
    ///
    /// # Errors
    /// [`Error::GimbalLock`] where the cosine of the middle angle is below √ε in magnitude (elements above 6.7e7
    /// in f64, 2.9e3 in f32); [`Error::NotFinite`] for NaN or infinite angles.
    ///
    /// Test: `rates_are_the_derivative`, `at_gimbal_lock`.
    pub fn rates_from_omega<T: Scalar>(self, rpy: &Vector3<T>) -> Result<Matrix3<T>, Error> {
        if !(rpy.x.is_finite_number() && rpy.y.is_finite_number()) {
            return Err(Error::NotFinite { parameter: "rpy" });
        }
        let ([sr, sp], [cr, cp]) = math::sin_cos_array(&[rpy.x, rpy.y]);
        let (o, i) = (T::ZERO, T::ONE);
        let cos_middle = match self {
            Self::Zyx => cp,
            Self::Zxy => cr,
        };
        if math::abs(cos_middle) < math::sqrt(T::EPSILON) {
            return Err(Error::GimbalLock);
        }
        Ok(match self {
            Self::Zyx => Matrix3::new(
                i,
                sr * sp / cp,
                cr * sp / cp,
                o,
                cr,
                -sr,
                o,
                sr / cp,
                cr / cp,
            ),
            Self::Zxy => Matrix3::new(
                cp,
                o,
                sp,
                sp * sr / cr,
                i,
                -cp * sr / cr,
                -sp / cr,
                o,
                cp / cr,
            ),
        })
    }
}
