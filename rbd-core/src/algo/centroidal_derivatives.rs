//! Derivatives of the centroidal momentum h_G = A_G ν and of its rate ḣ_G = A_G ν̇ + Ȧ_G ν.
//!
//! About the base's origin in base axes, with the axes S, Ṡ, S̈ and the subtree quantities I, B of
//! `sweep.rs`, h and f the momentum of the subtree of joint j and its rate, gravity left out:
//!
//! - ∂h/∂q_j = I Ṡ + S ×* h, ∂h/∂q̇_j = I S;
//! - ∂ḣ/∂q_j = I S̈ + B Ṡ + S ×* f, ∂ḣ/∂q̇_j = 2 I Ṡ + B S, ∂ḣ/∂q̈_j = I S.
//!
//! About the centre of mass c, which itself moves by ∂c/∂q_j = (I S)_linear / m, the angular part of x
//! becomes x_ang − c × x_lin, hence ∂x_ang − c × ∂x_lin − ∂c × x_lin. World axes add e × x for a turn e of
//! the base; a shift of the base changes nothing.
//!
//! A fixed base is part of the world and counts in none of these.
//!
//! The centre of mass itself has ∂c/∂q = J_c, see [`com_jacobian`](crate::com_jacobian).

use nalgebra::{Matrix3, SMatrix, Vector3};
use so3::Scalar;

use super::rnea_derivatives::DerivativesWorkspace;
use super::sweep::{Moves, sweep};
use super::{moving_base, put};
use crate::spatial::{Force, Motion};
use crate::state::{Posture, Tangent, basis};
use crate::tree::Tree;

/// One force or momentum per coordinate of the robot: a 6 × (6 + N) matrix by columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceColumns<T, const N: usize> {
    /// Columns of the base, linear first.
    pub base: [Force<T>; 6],
    /// Columns of the joints.
    pub joints: [Force<T>; N],
}

impl<T: Scalar, const N: usize> ForceColumns<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        base: [Force::ZERO; 6],
        joints: [Force::ZERO; N],
    };

    /// The matrix times a motion of the robot.
    #[must_use]
    pub fn mul(&self, motion: &Tangent<T, N>) -> Force<T> {
        let base = self.base.iter().zip(motion.base.to_array());
        let sum = base.fold(Force::ZERO, |sum, (column, x)| sum + *column * x);
        let joints = self.joints.iter().zip(motion.joints);
        joints.fold(sum, |sum, (column, x)| sum + *column * x)
    }

    /// As one dense 6 × V matrix, base first. `V` must be 6 + N; other sizes do not compile.
    #[must_use]
    pub fn to_dense<const V: usize>(&self) -> SMatrix<T, 6, V> {
        const { assert!(V == 6 + N, "there are 6 + N columns") };
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

/// The centroidal momentum, its rate, and their derivatives; world axes, about the centre of mass.
///
/// To first order, dh = `momentum_by_position` dq + `map` dν and dḣ = `rate_by_position` dq +
/// `rate_by_velocity` dν + `map` dν̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentroidalDerivatives<T, const N: usize> {
    /// h_G, kg m/s and kg m²/s.
    pub momentum: Force<T>,
    /// ḣ_G, N and N m.
    pub rate: Force<T>,
    /// ∂h/∂ν = ∂ḣ/∂ν̇ = A_G.
    pub map: ForceColumns<T, N>,
    /// ∂h/∂q.
    pub momentum_by_position: ForceColumns<T, N>,
    /// ∂ḣ/∂q.
    pub rate_by_position: ForceColumns<T, N>,
    /// ∂ḣ/∂ν.
    pub rate_by_velocity: ForceColumns<T, N>,
}

impl<T: Scalar, const N: usize> CentroidalDerivatives<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        momentum: Force::ZERO,
        rate: Force::ZERO,
        map: ForceColumns::ZERO,
        momentum_by_position: ForceColumns::ZERO,
        rate_by_position: ForceColumns::ZERO,
        rate_by_velocity: ForceColumns::ZERO,
    };
}

/// From the base's origin and axes to the centre of mass and world axes.
struct Centroidal<T> {
    rotation: Matrix3<T>,
    com_b: Vector3<T>,
    per_mass: T,
}

impl<T: Scalar> Centroidal<T> {
    /// About the centre of mass, still in base axes.
    #[inline(always)]
    fn about(&self, f: &Force<T>) -> Force<T> {
        Force::new(f.linear, f.angular - self.com_b.cross(&f.linear))
    }

    #[inline(always)]
    fn turned(&self, f: &Force<T>) -> Force<T> {
        Force::new(self.rotation * f.linear, self.rotation * f.angular)
    }

    /// A column that does not move the centre of mass.
    #[inline(always)]
    fn column(&self, f: &Force<T>) -> Force<T> {
        self.turned(&self.about(f))
    }

    /// A column of the derivative of `total` that moves the centre of mass as momentum `map` does.
    #[inline(always)]
    fn moving_column(&self, f: &Force<T>, map: &Force<T>, total: &Force<T>) -> Force<T> {
        let mut about = self.about(f);
        about.angular -= map.linear.cross(&total.linear) * self.per_mass;
        self.turned(&about)
    }
}

/// Derivatives of the centroidal momentum and of its rate with respect to configuration, velocity and
/// acceleration.
///
/// `acceleration.base` is spatial, as everywhere; gravity is left out, as in
/// [`centroidal_momentum_rate`](crate::centroidal_momentum_rate).
#[inline]
pub fn centroidal_derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    ws: &mut DerivativesWorkspace<T, N>,
    out: &mut CentroidalDerivatives<T, N>,
) {
    let moves = Moves {
        base_inertia: moving_base(model),
        base_velocity: velocity.base,
        base_acceleration: acceleration.base,
        velocity: &velocity.joints,
        acceleration: &acceleration.joints,
        applied: None,
    };
    let whole = sweep(model, posture, &moves, ws);
    ws.answer();
    let mass = whole.inertia.mass;
    let to = Centroidal {
        rotation: *posture.base.rotation.matrix(),
        com_b: whole.inertia.com(),
        per_mass: if mass > T::ZERO {
            T::ONE / mass
        } else {
            T::ZERO
        },
    };

    let (momentum, rate) = (whole.momentum_wrench(), whole.force);
    for i in 0..N {
        let (joint, subtree) = (ws.joint(i), ws.subtree(i));
        let by_q =
            subtree.inertia.mul(&joint.rate) + joint.axis.cross_force(&subtree.momentum_wrench());
        out.momentum_by_position.joints[i] = to.moving_column(&by_q, &joint.by_a, &momentum);
        out.rate_by_position.joints[i] = to.moving_column(&joint.by_q, &joint.by_a, &rate);
        out.rate_by_velocity.joints[i] = to.column(&joint.by_v);
        out.map.joints[i] = to.column(&joint.by_a);
    }
    let (momentum, rate) = (to.about(&momentum), to.about(&rate));
    for (k, unit) in basis::<T>().iter().enumerate() {
        let turn = Motion::new(Vector3::zeros(), unit.angular);
        let mut column = to.column(&whole.inertia.mul(unit));
        if k < 3 {
            // A shift of the base carries no momentum about the centre of mass.
            column.angular = Vector3::zeros();
        }
        put(&mut out.map.base, k, column);
        put(
            &mut out.momentum_by_position.base,
            k,
            to.turned(&turn.cross_force(&momentum)),
        );
        put(
            &mut out.rate_by_position.base,
            k,
            to.turned(&turn.cross_force(&rate)),
        );
        let by_v = whole.inertia.mul(&velocity.base.cross(unit)) + whole.coriolis(&unit.angular);
        put(&mut out.rate_by_velocity.base, k, to.column(&by_v));
    }
    out.momentum = to.turned(&momentum);
    out.rate = to.turned(&rate);
}
