//! Centre of mass: position, Jacobian, velocity and acceleration.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use super::crba::unit_force;
use super::rnea::Field;
use super::{at, moving_base, place, put};
use crate::abreast::abreast_as;
use crate::joint::{JointKind, JointRotation};
use crate::model::Body;
use crate::spatial::{Inertia, Symmetric3};
use crate::state::{Posture, Tangent};
use crate::tree::{At, Fold, Nothing, Tree};

/// Mass and first moment of a subtree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<T> {
    pub(crate) mass: T,
    pub(crate) first: Vector3<T>,
}

abreast_as!(
    Moments<T> => ([T; 1], Vector3<T>),
    |m| ([m.mass], m.first),
    |([mass], first)| Self { mass, first }
);

impl<T: Scalar> Moments<T> {
    #[inline(always)]
    pub(crate) fn of(body: &Body<T>) -> Self {
        Self {
            mass: body.mass,
            first: Vector3::from(body.first),
        }
    }
}

impl<T: Scalar> Default for Moments<T> {
    fn default() -> Self {
        Self {
            mass: T::ZERO,
            first: Vector3::zeros(),
        }
    }
}

impl<T: Scalar> core::ops::Add for Moments<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            mass: self.mass + o.mass,
            first: self.first + o.first,
        }
    }
}

struct Com<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    /// m ∂c/∂q_j on its way to the base; `None` when only the position is wanted.
    columns: Option<&'a mut [Vector3<T>; N]>,
}

impl<T: Scalar, const N: usize> Fold<T> for Com<'_, T, N> {
    type Down = Nothing;
    type Keep = Nothing;
    type Up = Moments<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing) -> (Nothing, Nothing) {
        (Nothing, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        _: &Nothing,
        children: Moments<T>,
    ) -> Moments<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let Moments { mass, first } = Moments::of(here.body) + children;
        if let Some(columns) = &mut self.columns {
            let subtree = Inertia {
                mass,
                first,
                second: Symmetric3::ZERO,
            };
            let column = unit_force::<J, T>(&subtree).linear * here.body.sign;
            put(*columns, here.index, column);
            for j in here.index..here.end {
                let turned = rotation.up(&at(*columns, j));
                put(*columns, j, turned);
            }
        }
        Moments {
            mass,
            first: rotation.up(&first) + offset * mass,
        }
    }
}

/// Mass and centre of mass of the whole robot; of the links that joints move if the base is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CenterOfMass<T: Scalar> {
    /// Mass, kg; without a fixed base.
    pub mass: T,
    /// Position in the world, m; the base's origin for a massless robot.
    pub position_w: Vector3<T>,
}

/// Jacobian of the centre of mass, 3 × (6 + N), world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComJacobian<T: Scalar, const N: usize> {
    /// Per base linear velocity in base axes: R_wb.
    pub base_linear: Matrix3<T>,
    /// Per base angular velocity in base axes: −R_wb hat(c_b).
    pub base_angular: Matrix3<T>,
    /// Columns of the joints.
    pub joints: [Vector3<T>; N],
}

impl<T: Scalar, const N: usize> ComJacobian<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = {
        let zero = Symmetric3::<T>::ZERO;
        let matrix = Matrix3::new(
            zero.xx, zero.xx, zero.xx, zero.xx, zero.xx, zero.xx, zero.xx, zero.xx, zero.xx,
        );
        let column = Vector3::new(zero.xx, zero.xx, zero.xx);
        Self {
            base_linear: matrix,
            base_angular: matrix,
            joints: [column; N],
        }
    };

    /// J ν: velocity of the centre of mass in the world, m/s.
    #[must_use]
    pub fn mul(&self, velocity: &Tangent<T, N>) -> Vector3<T> {
        let base =
            self.base_linear * velocity.base.linear + self.base_angular * velocity.base.angular;
        let joints = self.joints.iter().zip(velocity.joints);
        joints.fold(base, |sum, (column, x)| sum + column * x)
    }
}

/// Mass and centre of mass in the world: c = Σ mᵢ cᵢ / m, over all links but those of a fixed base.
#[inline]
#[must_use]
pub fn center_of_mass<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
) -> CenterOfMass<T> {
    let (mass, com_b) = collect(
        model,
        &mut Com {
            posture,
            columns: None,
        },
    );
    CenterOfMass {
        mass,
        position_w: posture.base.point(&com_b),
    }
}

/// Centre of mass and its Jacobian: ċ = J ν, the J_c of paper B eq. (3b).
#[inline]
pub fn com_jacobian<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    out: &mut ComJacobian<T, N>,
) -> CenterOfMass<T> {
    let (mass, com_b) = collect(
        model,
        &mut Com {
            posture,
            columns: Some(&mut out.joints),
        },
    );
    let rot_wb = posture.base.rotation.matrix();
    let per_mass = if mass > T::ZERO {
        T::ONE / mass
    } else {
        T::ZERO
    };
    for column in &mut out.joints {
        *column = rot_wb * *column * per_mass;
    }
    out.base_linear = *rot_wb;
    out.base_angular = -(rot_wb * com_b.cross_matrix());
    CenterOfMass {
        mass,
        position_w: posture.base.point(&com_b),
    }
}

/// Mass, and centre of mass in base axes.
#[inline(always)]
fn collect<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    fold: &mut Com<'_, T, N>,
) -> (T, Vector3<T>) {
    let children = model.fold(fold, &Nothing);
    let base = moving_base(model);
    let mass = base.mass + children.mass;
    let first = base.first + children.first;
    (
        mass,
        if mass > T::ZERO {
            first * (T::ONE / mass)
        } else {
            Vector3::zeros()
        },
    )
}

/// Centre of mass with its velocity and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComMotion<T: Scalar> {
    /// Mass, kg.
    pub mass: T,
    /// Position in the world, m.
    pub position_w: Vector3<T>,
    /// Velocity in the world, m/s.
    pub velocity_w: Vector3<T>,
    /// Acceleration in the world, m/s², gravity not included.
    pub acceleration_w: Vector3<T>,
}

/// Moments, momentum and its rate of a subtree, linear parts only, in its parent's axes.
#[derive(Clone, Copy, Debug)]
struct Linear<T> {
    moments: Moments<T>,
    momentum: Vector3<T>,
    rate: Vector3<T>,
}

abreast_as!(
    Linear<T> => (Moments<T>, (Vector3<T>, Vector3<T>)),
    |l| (l.moments, (l.momentum, l.rate)),
    |(moments, (momentum, rate))| Self { moments, momentum, rate }
);

impl<T: Scalar> Default for Linear<T> {
    fn default() -> Self {
        let zero = Vector3::zeros();
        Self {
            moments: Moments::default(),
            momentum: zero,
            rate: zero,
        }
    }
}

impl<T: Scalar> core::ops::Add for Linear<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            moments: self.moments + o.moments,
            momentum: self.momentum + o.momentum,
            rate: self.rate + o.rate,
        }
    }
}

impl<T: Scalar> Linear<T> {
    /// Of one body: m v + ω × h and m a + U h.
    #[inline(always)]
    fn of(moments: Moments<T>, velocity: &Vector3<T>, field: &Field<T>) -> Self {
        Self {
            moments,
            momentum: velocity * moments.mass + field.omega.cross(&moments.first),
            rate: field.acceleration * moments.mass + field.gradient * moments.first,
        }
    }
}

struct Moving<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    velocity: &'a [T; N],
    acceleration: &'a [T; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Moving<'_, T, N> {
    /// Velocity of the origin, and the acceleration field, body axes.
    type Down = (Vector3<T>, Field<T>);
    /// What the body itself adds.
    type Keep = Linear<T>;
    type Up = Linear<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Self::Down) -> (Self::Down, Linear<T>) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let sign = here.body.sign;
        let qd = at(self.velocity, here.index) * sign;
        let qdd = at(self.acceleration, here.index) * sign;
        let field = up.1.child::<J>(&rotation, &offset, qd, qdd);
        let carried = rotation.down(&(up.0 + up.1.omega.cross(&offset)));
        let velocity = if J::KIND.is_revolute() {
            carried
        } else {
            J::along_axis(carried, qd)
        };
        (
            (velocity, field),
            Linear::of(Moments::of(here.body), &velocity, &field),
        )
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        own: &Linear<T>,
        children: Linear<T>,
    ) -> Linear<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let Linear {
            moments,
            momentum,
            rate,
        } = *own + children;
        let first = rotation.up(&moments.first) + offset * moments.mass;
        Linear {
            moments: Moments { first, ..moments },
            momentum: rotation.up(&momentum),
            rate: rotation.up(&rate),
        }
    }
}

/// Position, velocity and acceleration of the centre of mass, in one pass; without the links of a fixed base.
#[inline]
#[must_use]
pub fn com_motion<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
) -> ComMotion<T> {
    let still = Vector3::zeros();
    let field = Field::base(posture, &velocity.base, &acceleration.base, &still);
    let mut fold = Moving {
        posture,
        velocity: &velocity.joints,
        acceleration: &acceleration.joints,
    };
    let children = model.fold(&mut fold, &(velocity.base.linear, field));
    let base = moving_base(model);
    let moments = Moments {
        mass: base.mass,
        first: base.first,
    };
    let all = Linear::of(moments, &velocity.base.linear, &field) + children;
    let mass = all.moments.mass;
    let per_mass = if mass > T::ZERO {
        T::ONE / mass
    } else {
        T::ZERO
    };
    let r = posture.base.rotation.matrix() * per_mass;
    ComMotion {
        mass,
        position_w: posture.base.translation + r * all.moments.first,
        velocity_w: r * all.momentum,
        acceleration_w: r * all.rate,
    }
}

/// Centre of mass in base axes.
#[inline(always)]
pub(crate) fn com_in_base<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
) -> Vector3<T> {
    collect(
        model,
        &mut Com {
            posture,
            columns: None,
        },
    )
    .1
}
