//! What errors and forces of the push-off cost.

use nalgebra::Vector3;
use rbd_core::Build;
use so3::{Scalar, math};

/// Errors that weigh as much as each other, σ: a cost is Σ (error/σ)².
///
/// They are what a jump tolerates, the same for every jump: a flight of 0.3 s makes 0.03 m and 0.05 rad of 0.1 m/s and 0.15 rad/s, and the
/// judge of A1's jumps allows 0.10 m and 0.17 rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<T> {
    /// At take-off: place, m; rotation, rad; velocity, m/s; angular momentum over the inertia, rad/s.
    pub takeoff: [T; 4],
    /// At touchdown, if nothing is done in flight: place, m, and rotation, rad.
    pub touchdown: [T; 2],
    /// During [`Weights::time`] in the push-off, likewise.
    pub running: [T; 4],
    /// Time after which a running error, or a force, has cost as much as one at take-off, s.
    pub time: T,
    /// Change of a foot's normal force over its planned normal force; zero switches the feedback off.
    pub normal: T,
    /// Change of its tangential force over the same.
    pub tangential: T,
    /// Least share of its planned normal force with which a foot goes on pushing.
    pub least_normal: T,
    /// Tangential over normal force that may be asked for; the plan may ask for more.
    pub friction: T,
    /// Share of the motors' torques up to which forces are changed: the joint loop needs the rest.
    pub torque: T,
}

impl<T: Scalar> Weights<T> {
    /// Weights for a robot of this size, by [dynamic similarity](rbd_core::similarity) from those of a robot of 13.741 kg with legs of 0.4 m.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        let of = T::of;
        Self {
            takeoff: [
                build.length(0.03),
                of(0.05),
                build.speed(0.03),
                build.rate(0.15),
            ],
            touchdown: [build.length(0.03), of(0.1)],
            running: [
                build.length(0.1),
                of(0.15),
                build.speed(0.3),
                build.rate(1.0),
            ],
            time: build.time(0.1),
            normal: of(0.3),
            tangential: of(0.15),
            least_normal: of(0.3),
            friction: of(0.5),
            torque: of(0.85),
        }
    }

    /// g of a foot with this planned normal force, along the world's axes, N² s: a force u costs u²/g per second. None for a foot that does not push.
    pub(super) fn per_cost(&self, normal: T) -> Vector3<T> {
        let shares = Vector3::new(self.tangential, self.tangential, self.normal);
        let sigma = shares * math::max(normal, T::ZERO);
        sigma.component_mul(&sigma) * self.time
    }

    /// The force that is nearest to `planned` + `change` in what a foot may be asked for: its normal force not below the least share of the planned
    /// one, its tangential force within the cone of friction, or of the plan.
    pub(super) fn within_cone(&self, planned: &Vector3<T>, change: &Vector3<T>) -> Vector3<T> {
        let pushing = planned.z > T::ZERO;
        if !pushing {
            return *planned;
        }
        let squared = |force: &Vector3<T>| force.x * force.x + force.y * force.y;
        let ratio = math::max(
            self.friction * self.friction,
            squared(planned) / (planned.z * planned.z),
        );
        let mut force = planned + change;
        force.z = math::max(force.z, planned.z * self.least_normal);
        let (size, most) = (squared(&force), ratio * force.z * force.z);
        if size > most {
            let share = math::sqrt(most / size);
            force.x *= share;
            force.y *= share;
        }
        force
    }
}
