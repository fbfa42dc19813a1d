//! What a ball foot adds to a point foot.
//!
//! A ball of radius r around the point touches the ground at `arm = (0, 0, −r)` from it, in world axes however the
//! foot turns. Its force acts there: beside the force F on the point there is the couple M = arm × F, fixed in
//! the world. It rolls: the material point at the contact is at rest, v + ω × arm = 0, so a + α × arm = 0, and
//! the multiplier μ of that row pulls the angular acceleration with m = arm × μ.
//!
//! With s, ṡ, s̈ the angular parts of S, Ṡ, S̈, and ω, α, l those of V, A, Λ of the foot's body i, for j on its path and
//! k = j or an ancestor:
//!
//! ```text
//! ∂α/∂q_k = s̈_k + ṡ_k × ω + s_k × α,   ∂α/∂q̇_k = 2 ṡ_k + s_k × ω,   ∂α/∂q̈_k = s_k
//! −M·l:  q_j q_k: s_k · (M × (s_j × (l − l_p(j))))
//! m·α:   q_j q_k: ṡ_k · (e × m) − s_k · (m × ∂α/∂q_j),   e = ṡ_j + s_j × ω
//!        q̇_j q_k: ṡ_k · (s_j × m) − s_k · (m × ∂α/∂q̇_j),  q̈_j q_k: −s_k · (m × s_j)
//!        q_j q̇_k: s_k · (e × m),  q̇_j q̇_k: s_k · (s_j × m)
//! ```

use nalgebra::Vector3;
use so3::Scalar;

use super::{EffortJacobian, Hessian, PointMotion, Sweep};
use crate::model::Link;
use crate::spatial::Motion;

/// ∂α/∂q_k, ∂α/∂q̇_k, ∂α/∂q̈_k of the body of a point.
pub(super) struct AngularColumns<T: Scalar> {
    pub(super) by_q: Vector3<T>,
    pub(super) by_v: Vector3<T>,
    pub(super) by_a: Vector3<T>,
}

impl<T: Scalar, const N: usize> Sweep<'_, T, N> {
    /// How the angular acceleration of body `link` changes with coordinate `k` on its path.
    #[inline(always)]
    pub(super) fn angular_columns(&self, link: usize, k: usize) -> AngularColumns<T> {
        let (body, joint) = (self.body(link), self.body(k));
        let (s, rate, second) = (
            &joint.axis.angular,
            &joint.rate.angular,
            &joint.second.angular,
        );
        let (omega, alpha) = (&body.velocity.angular, &body.acceleration.angular);
        AngularColumns {
            by_q: second + rate.cross(omega) + s.cross(alpha),
            by_v: rate * T::TWO + s.cross(omega),
            by_a: *s,
        }
    }

    /// Adds what the couple of a ball foot's force does to the Jacobian of the efforts.
    pub(super) fn differentiate_couple<const CONTACTS: usize>(
        &self,
        point: &PointMotion<T>,
        force: &Vector3<T>,
        out: &mut EffortJacobian<T, N, CONTACTS>,
    ) {
        let couple = point.arm.cross(force);
        for j in self.path(point.link) {
            let turned = couple.cross(&self.joints[j].axis.angular);
            for k in self.path(j) {
                out.by_q[j][k] += self.joints[k].axis.angular.dot(&turned);
            }
        }
    }

    /// Adds the second derivatives of −M·l + m·α of one foot.
    pub(super) fn rolling_curvature<const CONTACTS: usize>(
        &self,
        (point, force): (&PointMotion<T>, &Vector3<T>),
        mu: &Vector3<T>,
        virtuals: &[Motion<T>; N],
        out: &mut Hessian<T, N, CONTACTS>,
    ) {
        let (couple, m) = (point.arm.cross(force), point.arm.cross(mu));
        let i = point.link;
        let tip = virtuals.get(i).map_or(Vector3::zeros(), |x| x.angular);
        let omega = &self.body(i).velocity.angular;
        for j in self.path(i) {
            let (s, rate) = (&self.joints[j].axis.angular, &self.joints[j].rate.angular);
            let above = match self.bodies[j].parent {
                Link::Joint(p) => virtuals.get(p).map_or(Vector3::zeros(), |x| x.angular),
                Link::Base => Vector3::zeros(),
            };
            let columns = self.angular_columns(i, j);
            let of_rate = (rate + s.cross(omega)).cross(&m);
            let of_axis = couple.cross(&s.cross(&(tip - above))) - m.cross(&columns.by_q);
            let of_speed = s.cross(&m);
            let of_speed_axis = -m.cross(&columns.by_v);
            let of_acceleration = -m.cross(s);
            for k in self.path(j) {
                let (s_k, rate_k) = (&self.joints[k].axis.angular, &self.joints[k].rate.angular);
                let qq = rate_k.dot(&of_rate) + s_k.dot(&of_axis);
                let vv = s_k.dot(&of_speed);
                out.qq[j][k] += qq;
                out.vv[j][k] += vv;
                out.vq[j][k] += rate_k.dot(&of_speed) + s_k.dot(&of_speed_axis);
                out.aq[j][k] += s_k.dot(&of_acceleration);
                if k != j {
                    out.qq[k][j] += qq;
                    out.vv[k][j] += vv;
                    out.vq[k][j] += s_k.dot(&of_rate);
                }
            }
        }
    }
}
