//! The base on SO(3): how what is differentiated in three joint angles becomes derivatives in a rotation, an angular
//! velocity and an angular acceleration.
//!
//! Over an interval of length 2 h the base turns with the angular velocity of the middle,
//!
//! ```text
//! ω_m = ω + h α,   R_m = R Exp(h ω_m),   R⁺ = R Exp(2 h ω_m),   ω⁺ = ω + 2 h α,
//! ```
//!
//! the midpoint rule on the group: no chart, so nothing is singular. Dynamics are differentiated along a chain of joints
//! ([`rbd_core::second_order`]) whose last three base joints, about x, y and z, turn from R_m: their angles a are zero there and their
//! rates and accelerations are known. Near a = 0, with R_m Exp(θ), x = a₂ and z = a₃,
//!
//! ```text
//! a  = θ − ½ (θ₂θ₃, −θ₁θ₃, θ₁θ₂)
//! ȧ₁ = ω₁ − z ω₂ + ½ (x² − z²) ω₁,   ȧ₂ = ω₂ + z ω₁ − ½ z² ω₂,   ȧ₃ = ω₃ − x ω₁ + x z ω₂
//! ä₁ = A₁ + x W − z A₂ + ½ (x² − z²) A₁ + 2 x z D,               A₁ = α₁ − ω₂ω₃,   A₂ = α₂ + ω₁ω₃
//! ä₂ = A₂ + z A₁ − x ω₁² − ½ z² A₂ + x z W,                      W = 2 ω₁ω₂
//! ä₃ = α₃ − ½ W − z D − x A₁ + (z² − x²) W + x z A₂,             D = ω₁² − ω₂²
//! ```
//!
//! up to third order (Tait–Bryan rates and their derivative, expanded). Steps of a node reach the middle by
//! θ_m = Exp(−ξ) θ + J(ξ) δξ + ½ (DJ[δξ] δξ + Exp(−ξ) θ × J(ξ) δξ), ξ = h ω_m, J the right Jacobian of Exp (Magnus and
//! Baker–Campbell–Hausdorff to second order). All of this is exact where it is used, at a = 0.

use crate::robot::{BASE, TURN};
use crate::state::Units;
use nalgebra::{Matrix3, Vector3};
use ocp_solver::Derivatives;
use so3::{Scalar, hat};

/// Three coordinates from `at` on.
#[inline(always)]
pub(crate) fn triple<T: Scalar>(x: &[T], at: usize) -> Vector3<T> {
    let entry = |i: usize| x.get(at.saturating_add(i)).copied().unwrap_or(T::ZERO);
    Vector3::new(entry(0), entry(1), entry(2))
}

/// Writes three coordinates from `at` on.
#[inline(always)]
pub(crate) fn set_triple<T: Scalar>(x: &mut [T], at: usize, v: &Vector3<T>) {
    for (slot, value) in x.iter_mut().skip(at).zip(v) {
        *slot = *value;
    }
}

/// Joint accelerations ä at a = 0 from ω and α, and back with the other sign.
#[inline(always)]
fn coupling<T: Scalar>(omega: &Vector3<T>) -> Vector3<T> {
    Vector3::new(-omega.y * omega.z, omega.x * omega.z, -omega.x * omega.y)
}

/// Accelerations of the joints about x, y and z at zero angles.
#[inline(always)]
pub(crate) fn joint_acceleration<T: Scalar>(omega: &Vector3<T>, alpha: &Vector3<T>) -> Vector3<T> {
    alpha + coupling(omega)
}

/// The angular acceleration that [`joint_acceleration`] came from.
#[inline(always)]
pub(crate) fn angular_acceleration<T: Scalar>(
    omega: &Vector3<T>,
    joint: &Vector3<T>,
) -> Vector3<T> {
    joint - coupling(omega)
}

/// Exp(ξ) with the first and second derivatives of ξ ↦ R Exp(ξ), seen from its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T: Scalar> {
    xi: Vector3<T>,
    /// Exp(ξ).
    pub(crate) exp: Matrix3<T>,
    /// J(ξ).
    pub(crate) jacobian: Matrix3<T>,
}

impl<T: Scalar> Step<T> {
    #[inline(always)]
    pub(crate) fn new(xi: Vector3<T>) -> Self {
        let (exp, left) = so3::exp_with_jacobian(&xi);
        Self {
            xi,
            exp: exp.into_inner(),
            jacobian: left.transpose(),
        }
    }

    /// Second derivatives of g · θ_m in (θ, ξ) and in (ξ, ξ).
    fn curvature(&self, g: &Vector3<T>) -> [Matrix3<T>; 2] {
        let xi = &self.xi;
        let mixed = self.exp * hat(g) * self.jacobian * -T::HALF;
        // J = I − b hat(ξ) + c hat(ξ)²; b and c change with ξ by b' and c' times ξ.
        let z = xi.norm_squared();
        let so3::small_angle::Coefficients { a, b, c } = so3::small_angle::coefficients(z);
        let (by_b, by_c) = if z < T::of(0.01) {
            // Series: −(1/12 − z/180 + z²/6720), −(1/60 − z/1260 + z²/60480).
            (
                -(T::of(1.0 / 12.0) - z * (T::of(1.0 / 180.0) - z * T::of(1.0 / 6720.0))),
                -(T::of(1.0 / 60.0) - z * (T::of(1.0 / 1260.0) - z * T::of(1.0 / 60480.0))),
            )
        } else {
            ((a - T::TWO * b) / z, (b - T::of(3.0) * c) / z)
        };
        let pair =
            |u: &Vector3<T>, v: &Vector3<T>| (u * v.transpose() + v * u.transpose()) * T::HALF;
        let square = pair(xi, &g.cross(xi)) * -by_b
            + pair(xi, &xi.cross(&xi.cross(g))) * by_c
            + (Matrix3::from_diagonal_element(g.dot(xi)) - pair(g, xi)) * c;
        [mixed, square]
    }
}

/// The middle of an interval, as far as the base turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn<T: Scalar> {
    /// Half of the interval, s.
    half: T,
    omega: Vector3<T>,
    alpha: Vector3<T>,
    /// From the node to the middle.
    to_middle: Step<T>,
    /// Derivatives of (a, ȧ, ä) by rows in (θ, ω, α) of the node.
    blocks: [[Matrix3<T>; 3]; 3],
    by_theta: [Matrix3<T>; 2],
    /// Derivative of ä in ω_m.
    by_omega: Matrix3<T>,
}

impl<T: Scalar> Turn<T> {
    /// From half the length of the interval and the motion at its middle.
    pub(crate) fn new(half: T, omega: &Vector3<T>, joint_acceleration: &Vector3<T>) -> Self {
        let alpha = angular_acceleration(omega, joint_acceleration);
        let o = T::ZERO;
        let (x, y, z) = (omega.x, omega.y, omega.z);
        let [a1, a2, w, d] = Self::terms(omega, &alpha);
        let rate_by_theta = Matrix3::new(o, o, -y, o, o, x, o, -x, o);
        let by_theta = Matrix3::new(o, w, -a2, o, -x * x, a1, o, -a1, -d);
        let by_omega = Matrix3::new(o, -z, -y, z, o, x, -y, -x, o);
        let to_middle = Step::new(omega * half);
        let back = to_middle.exp.transpose();
        let jacobian = to_middle.jacobian * half;
        let one = Matrix3::identity();
        let row = |theta: Matrix3<T>, direct: Matrix3<T>, last: Matrix3<T>| {
            let by_speed = theta * jacobian + direct;
            [theta * back, by_speed, by_speed * half + last]
        };
        let zero = Matrix3::zeros();
        Self {
            half,
            omega: *omega,
            alpha,
            to_middle,
            blocks: [
                row(one, zero, zero),
                row(rate_by_theta, one, zero),
                row(by_theta, by_omega, one),
            ],
            by_theta: [rate_by_theta, by_theta],
            by_omega,
        }
    }

    /// ω_m.
    pub(crate) const fn omega(&self) -> &Vector3<T> {
        &self.omega
    }

    /// α.
    pub(crate) const fn alpha(&self) -> &Vector3<T> {
        &self.alpha
    }

    /// ω at the end of the interval: how ξ = h ω_m grows with h.
    pub(crate) fn end_omega(&self) -> Vector3<T> {
        self.omega + self.alpha * self.half
    }

    /// Derivatives of (a, ȧ, ä) in h, half the length of the interval.
    pub(crate) fn by_half(&self) -> [Vector3<T>; 3] {
        let moved = self.to_middle.jacobian * self.end_omega();
        let [rate_by_theta, by_theta] = &self.by_theta;
        [
            moved,
            rate_by_theta * moved + self.alpha,
            by_theta * moved + self.by_omega * self.alpha,
        ]
    }

    /// What the Lagrangian bends in h and (θ, ω, α), and in h twice; arguments as of [`Self::add_curvature`].
    ///
    /// In θ, ξ = h ω + h² α and ω_m = ω + h α the middle does not know h; the whole interval's step is 2 ξ.
    pub(crate) fn half_curvature(
        &self,
        g: &[Vector3<T>; 3],
        (step, reach): (&Step<T>, &Vector3<T>),
    ) -> ([Vector3<T>; 3], T) {
        let h = self.half;
        let [tt, tw, ta, ww] = self.joint_curvature(g);
        let g_theta = self.pull_on_theta(g);
        let g_omega = g[1] + self.by_omega.tr_mul(&g[2]);
        let [bent, square] = self.to_middle.curvature(&g_theta);
        let [far_bent, far_square] = step.curvature(reach);
        let jacobian = &self.to_middle.jacobian;
        let (by_xi, by_omega) = (self.end_omega(), self.alpha);
        let pull = jacobian.tr_mul(&g_theta) + step.jacobian.tr_mul(reach) * T::TWO;
        let moved = jacobian * by_xi;
        let on_theta = tt * moved + tw * by_omega;
        let theta = self.to_middle.exp * on_theta + bent * by_xi + far_bent * (by_xi * T::TWO);
        let xi = jacobian.tr_mul(&on_theta) + (square + far_square * T::of(4.0)) * by_xi;
        let omega = tw.tr_mul(&moved) + ww * by_omega;
        let alpha = ta.tr_mul(&moved) + g_omega + (omega + xi * h + pull * T::TWO) * h;
        let twice = by_xi.dot(&xi) + by_omega.dot(&omega) + by_omega.dot(&pull) * T::TWO;
        ([theta, xi * h + omega + pull, alpha], twice)
    }

    /// Gradient of g · (a, ȧ, ä) in θ at the middle.
    fn pull_on_theta(&self, g: &[Vector3<T>; 3]) -> Vector3<T> {
        let [rate_by_theta, by_theta] = &self.by_theta;
        g[0] + rate_by_theta.tr_mul(&g[1]) + by_theta.tr_mul(&g[2])
    }

    /// A₁, A₂, W, D of the module documentation.
    #[inline(always)]
    fn terms(omega: &Vector3<T>, alpha: &Vector3<T>) -> [T; 4] {
        let (x, y, z) = (omega.x, omega.y, omega.z);
        [
            alpha.x - y * z,
            alpha.y + x * z,
            T::TWO * x * y,
            x * x - y * y,
        ]
    }

    /// A gradient in (a, ȧ, ä) as one in (θ, ω, α) of the node.
    #[inline(always)]
    pub(crate) fn gradient(&self, g: &[Vector3<T>; 3]) -> [Vector3<T>; 3] {
        let [p, v, r] = &self.blocks;
        core::array::from_fn(|c| p[c].tr_mul(&g[0]) + v[c].tr_mul(&g[1]) + r[c].tr_mul(&g[2]))
    }

    /// Derivative of entry `k` of the joints' triple `r` (a, ȧ, ä) in entry `i` of the node's triple `c` (θ, ω, α).
    #[inline(always)]
    pub(crate) fn entry(&self, (r, k): (usize, usize), (c, i): (usize, usize)) -> T {
        self.blocks[r][c][(k, i)]
    }

    /// Second derivatives of g · (a, ȧ, ä) in (θ, ω_m, α) at the middle: blocks θθ, θω, θα, ωω.
    fn joint_curvature(&self, [p, v, r]: &[Vector3<T>; 3]) -> [Matrix3<T>; 4] {
        let (o, half) = (T::ZERO, T::HALF);
        let (x, y, z) = (self.omega.x, self.omega.y, self.omega.z);
        let [a1, a2, w, d] = Self::terms(&self.omega, &self.alpha);
        // What φ gains per x and per z.
        let by_x = -v.z * x + r.x * w - r.y * x * x - r.z * a1;
        let by_z = -v.x * y + v.y * x - r.x * a2 + r.y * a1 - r.z * d;
        let xx = v.x * x + r.x * a1 - T::TWO * r.z * w;
        let zz = -xx - v.y * y - r.y * a2;
        let xz = v.z * y + T::TWO * r.x * d + r.y * w + r.z * a2 - half * p.x;
        let t12 = -half * (p.z + by_z);
        let t13 = half * (p.y + by_x);
        let theta_theta = Matrix3::new(o, t12, t13, t12, xx, xz, t13, xz, zz);
        let two = T::TWO;
        let theta_omega = Matrix3::new(
            o,
            o,
            o,
            -v.z + two * (r.x * y - r.y * x),
            two * r.x * x + r.z * z,
            r.z * y,
            v.y - r.x * z - two * r.z * x,
            -v.x - r.y * z + two * r.z * y,
            -r.x * x - r.y * y,
        );
        let theta_alpha = Matrix3::new(o, o, o, -r.z, o, o, r.y, -r.x, o);
        let omega_omega = Matrix3::new(o, -r.z, r.y, -r.z, o, -r.x, r.y, -r.x, o);
        [theta_theta, theta_omega, theta_alpha, omega_omega]
    }

    /// Adds what the Lagrangian bends because (a, ȧ, ä) and the next rotation bend in (θ, ω, α): `g` is its gradient in
    /// (a, ȧ, ä), `reach` the multiplier of the gap of the rotation, in base axes at the end, and `step` the whole interval's.
    pub(crate) fn add_curvature<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        g: &[Vector3<T>; 3],
        (step, reach): (&Step<T>, &Vector3<T>),
        speeds: usize,
        d: &mut Derivatives<T, NX, NU, NI>,
    ) {
        let h = self.half;
        let [tt, tw, ta, ww] = self.joint_curvature(g);
        let [bent, square] = self.to_middle.curvature(&self.pull_on_theta(g));
        let [far_bent, far_square] = step.curvature(reach);
        let dt = h * T::TWO;
        let (exp, jacobian) = (self.to_middle.exp, self.to_middle.jacobian * h);

        // In (θ, ω_m, α), where ω_m = ω + h α.
        let theta_omega = exp * (tt * jacobian + tw) + bent * h + far_bent * dt;
        let theta_alpha = exp * ta;
        let cross = jacobian.tr_mul(&tw);
        let omega_omega = jacobian.tr_mul(&(tt * jacobian))
            + cross
            + cross.transpose()
            + ww
            + square * (h * h)
            + far_square * (dt * dt);
        let omega_alpha = jacobian.tr_mul(&ta);

        let units = Units::<T>::new();
        let (speed, acceleration) = (units.speed, units.acceleration);
        let by_alpha = |omega: &Matrix3<T>, alpha: &Matrix3<T>| (alpha + omega * h) * acceleration;
        let x_u = [
            by_alpha(&theta_omega, &theta_alpha),
            by_alpha(&omega_omega, &omega_alpha) * speed,
        ];
        let alpha_omega = omega_alpha.transpose() + omega_omega * h;
        let u_u = (omega_alpha * h + alpha_omega * h) * (acceleration * acceleration);
        let (theta, omega) = (TURN, speeds.saturating_add(TURN));
        let mixed = theta_omega * speed;
        add_block(
            &mut d.hessian_xx,
            theta,
            theta,
            &(exp * tt * exp.transpose()),
        );
        add_block(&mut d.hessian_xx, theta, omega, &mixed);
        add_block(&mut d.hessian_xx, omega, theta, &mixed.transpose());
        add_block(
            &mut d.hessian_xx,
            omega,
            omega,
            &(omega_omega * (speed * speed)),
        );
        add_block(&mut d.hessian_xu, theta, TURN, &x_u[0]);
        add_block(&mut d.hessian_xu, omega, TURN, &x_u[1]);
        add_block(&mut d.hessian_uu, TURN, TURN, &u_u);
    }
}

/// Adds a block at row `row`, column `column` of a column-major matrix.
#[inline(always)]
fn add_block<T: Scalar, const R: usize, const C: usize>(
    out: &mut [[T; R]; C],
    row: usize,
    column: usize,
    block: &Matrix3<T>,
) {
    for (slots, values) in out.iter_mut().skip(column).zip(block.column_iter()) {
        for (slot, value) in slots.iter_mut().skip(row).zip(values.iter()) {
            *slot += *value;
        }
    }
}

/// Writes a block at row `row`, column `column` of a column-major matrix.
#[inline(always)]
pub(crate) fn set_block<T: Scalar, const R: usize, const C: usize>(
    out: &mut [[T; R]; C],
    row: usize,
    column: usize,
    block: &Matrix3<T>,
) {
    for (slots, values) in out.iter_mut().skip(column).zip(block.column_iter()) {
        for (slot, value) in slots.iter_mut().skip(row).zip(values.iter()) {
            *slot = *value;
        }
    }
}

const _: () = assert!(
    TURN + 3 == BASE,
    "the base's last three coordinates turn it"
);
