//! Centroidal quantities: momentum about the centre of mass, its map and bias, the locked robot.
//!
//! h_G = A_G(q) ν with h_G about the centre of mass c in world axes (Orin, Goswami, Lee 2013), paper B
//! eq. (2): the rows of A_G are its J_M^l and J_M^ω, and H_ω is `momentum.angular`. Column j is the
//! momentum of the subtree of joint j per unit joint velocity, I_c S_j, moved to c. A fixed base counts in none of
//! these, see [`algo`](crate::algo).

use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};
use so3::Scalar;

use super::com::com_in_base;
use super::crba::unit_force;
use super::gravity::gravity;
use super::jacobian::columns;
use super::motion::carried;
use super::rnea::reactions;
use super::{at, moving_base, place, put};
use crate::abreast::abreast_as;
use crate::joint::{JointKind, JointRotation};
use crate::linear::ldl_solve;
use crate::spatial::{Force, Inertia, Motion, Symmetric3, Transform, cross, product};
use crate::state::{Posture, Tangent};
use crate::tree::{At, Fold, Tree};

/// Centroidal momentum map A_G, 6 × (6 + N), and the locked robot, in world axes about the centre of
/// mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentroidalMap<T, const N: usize> {
    /// Mass, kg.
    pub mass: T,
    /// Centre of mass in the world, m.
    pub com_w: Vector3<T>,
    /// Rotational inertia of the robot with locked joints about the centre of mass, world axes, kg m².
    pub locked_inertia_w: Symmetric3<T>,
    /// Columns of the base velocity, linear first.
    pub base: [Force<T>; 6],
    /// Columns of the joints.
    pub joints: [Force<T>; N],
}

impl<T: Scalar, const N: usize> CentroidalMap<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        mass: T::ZERO,
        com_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        locked_inertia_w: Symmetric3::ZERO,
        base: [Force::ZERO; 6],
        joints: [Force::ZERO; N],
    };

    /// A_G ν: linear momentum m ċ and angular momentum about the centre of mass.
    #[must_use]
    pub fn momentum(&self, velocity: &Tangent<T, N>) -> Force<T> {
        let base = self.base.iter().zip(velocity.base.to_array());
        let sum = base.fold(Force::ZERO, |sum, (column, x)| sum + *column * x);
        let joints = self.joints.iter().zip(velocity.joints);
        joints.fold(sum, |sum, (column, x)| sum + *column * x)
    }

    /// Angular velocity that the robot would have if its joints locked at once: I_G⁻¹ H_ω, rad/s, world
    /// axes (paper B, II-C).
    #[must_use]
    pub fn locked_angular_velocity(&self, momentum: &Force<T>) -> Vector3<T> {
        let s = &self.locked_inertia_w;
        let mut m = [[s.xx, s.xy, s.xz], [s.xy, s.yy, s.yz], [s.xz, s.yz, s.zz]];
        Vector3::from(ldl_solve(&mut m, momentum.angular.into()))
    }

    /// As one dense 6 × V matrix, base first. `V` must be 6 + N; other sizes do not compile.
    #[must_use]
    pub fn to_dense<const V: usize>(&self) -> SMatrix<T, 6, V> {
        const { assert!(V == 6 + N, "a centroidal map has 6 + N columns") };
        let mut m: SMatrix<T, 6, V> = SMatrix::zeros();
        for (mut to, from) in m
            .column_iter_mut()
            .zip(self.base.iter().chain(&self.joints))
        {
            to.copy_from_slice(&from.to_array());
        }
        m
    }
}

struct Map<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    /// Columns in world axes, about the base's origin.
    columns: &'a mut [Force<T>; N],
}

impl<T: Scalar, const N: usize> Fold<T> for Map<'_, T, N> {
    /// Rotation of the body in the world, and its origin relative to the base's, world axes.
    type Down = (Matrix3<T>, Vector3<T>);
    type Keep = Transform<T>;
    type Up = Inertia<T>;

    #[inline(always)]
    fn down<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        up: &Self::Down,
    ) -> (Self::Down, Transform<T>) {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let (rot, pos) = (rotation.after(&up.0), up.1 + product(&up.0, &offset));
        (
            (rot, pos),
            Transform::new(Rotation3::from_matrix_unchecked(rot), pos),
        )
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        pose: &Transform<T>,
        children: Inertia<T>,
    ) -> Inertia<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let composite = here.body.inertia() + children;
        let column = unit_force::<J, T>(&composite) * here.body.sign;
        put(self.columns, here.index, pose.force(&column));
        composite.assembled_up(&rotation, &offset)
    }
}

/// The centroidal momentum map A_G(q).
#[inline]
pub fn centroidal_map<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    out: &mut CentroidalMap<T, N>,
) {
    let r = posture.base.rotation.matrix();
    let mut fold = Map {
        posture,
        columns: &mut out.joints,
    };
    let children = model.fold(&mut fold, &(*r, Vector3::zeros()));
    let whole = moving_base(model) + children;
    let com_b = whole.com();
    let arm_w = r * com_b;

    out.mass = whole.mass;
    out.com_w = posture.base.translation + arm_w;
    out.locked_inertia_w = whole.rotational_com().rotated(r);
    for column in &mut out.joints {
        column.angular -= cross(&arm_w, &column.linear);
    }
    out.base = base_columns(&whole, &com_b, &out.locked_inertia_w, r);
}

/// Columns of the base velocity: m R and −m R hat(c) in the linear rows; 0 and I_G R in the angular ones,
/// because a shift of the base carries no momentum about the centre of mass.
#[inline(always)]
fn base_columns<T: Scalar>(
    whole: &Inertia<T>,
    com_b: &Vector3<T>,
    locked_inertia_w: &Symmetric3<T>,
    rot_wb: &Matrix3<T>,
) -> [Force<T>; 6] {
    let [x, y, z] = columns(rot_wb);
    let (mx, my, mz) = (x * whole.mass, y * whole.mass, z * whole.mass);
    let still = Vector3::zeros();
    let c = com_b;
    // Columns of −R hat(c): R (e_j × c).
    [
        Force {
            linear: mx,
            angular: still,
        },
        Force {
            linear: my,
            angular: still,
        },
        Force {
            linear: mz,
            angular: still,
        },
        Force {
            linear: mz * c.y - my * c.z,
            angular: locked_inertia_w.mul(&x),
        },
        Force {
            linear: mx * c.z - mz * c.x,
            angular: locked_inertia_w.mul(&y),
        },
        Force {
            linear: my * c.x - mx * c.y,
            angular: locked_inertia_w.mul(&z),
        },
    ]
}

/// Momentum and moments of mass of a subtree, in the frame of its parent.
#[derive(Clone, Copy, Debug)]
struct Moving<T> {
    momentum: Force<T>,
    mass: T,
    first: Vector3<T>,
}

abreast_as!(
    Moving<T> => (Force<T>, ([T; 1], Vector3<T>)),
    |m| (m.momentum, ([m.mass], m.first)),
    |(momentum, ([mass], first))| Self { momentum, mass, first }
);

impl<T: Scalar> Default for Moving<T> {
    fn default() -> Self {
        Self {
            momentum: Force::ZERO,
            mass: T::ZERO,
            first: Vector3::zeros(),
        }
    }
}

impl<T: Scalar> core::ops::Add for Moving<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            momentum: self.momentum + o.momentum,
            mass: self.mass + o.mass,
            first: self.first + o.first,
        }
    }
}

struct Momentum<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    qd: &'a [T; N],
    kinetic_energy: T,
}

impl<T: Scalar, const N: usize> Fold<T> for Momentum<'_, T, N> {
    /// Energies add up on the way down: abreast they would in another order than limb after limb, and to other bits.
    const ABREAST: bool = false;
    type Down = Motion<T>;
    /// Momentum of the body itself.
    type Keep = Force<T>;
    type Up = Moving<T>;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Motion<T>) -> (Motion<T>, Force<T>) {
        let qd = at(self.qd, here.index) * here.body.sign;
        let velocity = carried::<J, T, N>(here, self.posture, up, qd);
        let momentum = here.body.inertia().mul(&velocity);
        let rotor = here.body.rotor_inertia * qd * qd * T::HALF;
        self.kinetic_energy += velocity.dot(&momentum) * T::HALF + rotor;
        (velocity, momentum)
    }

    #[inline(always)]
    fn up<J: JointKind>(
        &mut self,
        here: At<'_, T>,
        own: &Force<T>,
        children: Moving<T>,
    ) -> Moving<T> {
        let (rotation, offset) = place::<J, T, N>(here, self.posture);
        let mass = here.body.mass + children.mass;
        let first = rotation.up(&(Vector3::from(here.body.first) + children.first));
        let momentum = *own + children.momentum;
        let linear = rotation.up(&momentum.linear);
        let angular = rotation.up(&momentum.angular) + cross(&offset, &linear);
        Moving {
            momentum: Force { linear, angular },
            mass,
            first: first + offset * mass,
        }
    }
}

/// Momentum and energy of a moving robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentroidalState<T: Scalar> {
    /// Mass, kg.
    pub mass: T,
    /// Centre of mass in the world, m.
    pub com_w: Vector3<T>,
    /// Velocity of the centre of mass in the world, m/s.
    pub com_velocity_w: Vector3<T>,
    /// Momentum about the centre of mass, world axes.
    pub momentum_w: Force<T>,
    /// Kinetic energy, rotors included, J.
    pub kinetic_energy: T,
    /// Potential energy of gravity, zero at the world's origin, J.
    pub potential_energy: T,
}

/// Centre of mass, its velocity, centroidal momentum and energies, in one pass and without the map.
#[inline]
#[must_use]
pub fn centroidal_state<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
) -> CentroidalState<T> {
    let base = moving_base(model);
    let own = base.mul(&velocity.base);
    let mut fold = Momentum {
        posture,
        qd: &velocity.joints,
        kinetic_energy: velocity.base.dot(&own) * T::HALF,
    };
    let children = model.fold(&mut fold, &velocity.base);
    let all = children
        + Moving {
            momentum: own,
            mass: base.mass,
            first: base.first,
        };
    let per_mass = if all.mass > T::ZERO {
        T::ONE / all.mass
    } else {
        T::ZERO
    };
    let com_b = all.first * per_mass;
    let com_w = posture.base.point(&com_b);
    let momentum_w = about_com(posture, &com_b, &all.momentum);
    CentroidalState {
        mass: all.mass,
        com_w,
        com_velocity_w: momentum_w.linear * per_mass,
        momentum_w,
        kinetic_energy: fold.kinetic_energy,
        potential_energy: -com_w.dot(&gravity()) * all.mass,
    }
}

/// Rate of the centroidal momentum at zero acceleration, Ȧ_G ν: what joint and base accelerations must
/// add to, ḣ_G = A_G ν̇ + Ȧ_G ν. Its linear part over the mass is the bias acceleration of the centre
/// of mass, J̇_c ν of paper B eq. (6b).
#[inline]
#[must_use]
pub fn centroidal_bias<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
) -> Force<T> {
    momentum_rate(model, posture, velocity, None)
}

/// Rate of the centroidal momentum, ḣ_G = A_G ν̇ + Ȧ_G ν, world axes: the sum of all external forces
/// but gravity, about the centre of mass; the ground's reaction on a fixed base is one of them. Its linear part over the mass is the acceleration of the
/// centre of mass.
#[inline]
#[must_use]
pub fn centroidal_momentum_rate<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
) -> Force<T> {
    momentum_rate(model, posture, velocity, Some(acceleration))
}

#[inline(always)]
fn momentum_rate<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: Option<&Tangent<T, N>>,
) -> Force<T> {
    let still = Vector3::zeros();
    let (field, joints) = reactions(model, posture, velocity, acceleration, &still, None);
    let rate = field.force(&moving_base(model)) + joints.base;
    let com_b = com_in_base(model, posture);
    about_com(posture, &com_b, &rate)
}

/// A wrench or momentum about the base's origin in base axes, about the centre of mass in world axes.
#[inline(always)]
fn about_com<T: Scalar, const N: usize>(
    posture: &Posture<T, N>,
    com_b: &Vector3<T>,
    f: &Force<T>,
) -> Force<T> {
    let r = posture.base.rotation.matrix();
    Force {
        linear: r * f.linear,
        angular: r * (f.angular - com_b.cross(&f.linear)),
    }
}
