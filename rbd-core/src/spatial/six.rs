//! What motions and forces have in common: six coordinates that add and scale.

/// Constructors and vector-space operators of a pair of a linear and an angular part.
macro_rules! six_vector {
    ($Type:ident) => {
        impl<T: Scalar> $Type<T> {
            /// All six coordinates zero.
            pub const ZERO: Self = Self {
                linear: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
                angular: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
            };

            /// From its linear and angular parts.
            #[inline(always)]
            #[must_use]
            pub const fn new(linear: Vector3<T>, angular: Vector3<T>) -> Self {
                Self { linear, angular }
            }

            /// From six coordinates, linear first.
            #[inline(always)]
            #[must_use]
            pub const fn from_array([x, y, z, rx, ry, rz]: [T; 6]) -> Self {
                Self {
                    linear: Vector3::new(x, y, z),
                    angular: Vector3::new(rx, ry, rz),
                }
            }

            /// Its six coordinates, linear first.
            #[inline(always)]
            #[must_use]
            pub fn to_array(self) -> [T; 6] {
                let (l, a) = (self.linear, self.angular);
                [l.x, l.y, l.z, a.x, a.y, a.z]
            }
        }

        impl<T: Scalar> Default for $Type<T> {
            fn default() -> Self {
                Self::ZERO
            }
        }

        impl<T: Scalar> Add for $Type<T> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self {
                    linear: self.linear + other.linear,
                    angular: self.angular + other.angular,
                }
            }
        }

        impl<T: Scalar> AddAssign for $Type<T> {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<T: Scalar> Sub for $Type<T> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self {
                    linear: self.linear - other.linear,
                    angular: self.angular - other.angular,
                }
            }
        }

        impl<T: Scalar> Neg for $Type<T> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self {
                    linear: -self.linear,
                    angular: -self.angular,
                }
            }
        }

        impl<T: Scalar> Mul<T> for $Type<T> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, factor: T) -> Self {
                Self {
                    linear: self.linear * factor,
                    angular: self.angular * factor,
                }
            }
        }
    };
}
pub(super) use six_vector;
