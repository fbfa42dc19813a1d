//! A body that moves over legs whose feet roll.

use super::{JOINTS, LEGS, Quadruped, State};
use nalgebra::{Matrix3, Vector3};
use rbd_core::{
    CentroidalMap, Force, FrameJacobian, Motion, Posture, Tangent, centroidal_map, centroidal_state,
};

/// The three columns of a leg.
fn leg_columns(j: &FrameJacobian<f64, JOINTS>, leg: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| j.joints[3 * leg + column].linear[row])
}

impl Quadruped {
    /// Angular velocity, base axes, of a robot that has this angular momentum about its centre of mass, world axes, and turns as one body.
    #[must_use]
    pub fn locked(&self, q: &State, momentum_w: &Vector3<f64>) -> Vector3<f64> {
        let mut map = CentroidalMap::ZERO;
        centroidal_map(self, &Posture::new(self, q), &mut map);
        let momentum = Force::new(Vector3::zeros(), *momentum_w);
        q.base.rotation.inverse() * map.locked_angular_velocity(&momentum)
    }

    /// The velocity of the whole robot whose centre of mass moves with `com_velocity_w` and which has this angular momentum, while the
    /// balls of the feet in `stance` roll without slip and the other joints move with `swing`.
    ///
    /// Found by fixed-point steps on the base's velocity: the legs are lighter than the rest.
    ///
    /// # Errors
    /// A stretched leg, or steps that do not converge.
    pub fn rolling_velocity(
        &self,
        q: &State,
        stance: &[bool; LEGS],
        com_velocity_w: &Vector3<f64>,
        momentum_w: &Vector3<f64>,
        swing: &[f64; JOINTS],
    ) -> Result<Tangent<f64, JOINTS>, String> {
        let kinematics = self.poses(q);
        let posture = Posture::new(self, q);
        let to_base = q.base.rotation.inverse();
        let legs: Vec<_> = (0..LEGS)
            .map(|leg| {
                let j = self.jacobian(&kinematics, &self.contact_frame(&kinematics, leg));
                (j, leg_columns(&j, leg).try_inverse())
            })
            .collect();
        let mut map = CentroidalMap::ZERO;
        centroidal_map(self, &posture, &mut map);
        let mut velocity = Tangent {
            base: Motion::new(to_base * com_velocity_w, Vector3::zeros()),
            joints: *swing,
        };
        for _ in 0..200 {
            for (leg, (j, inverse)) in legs.iter().enumerate().filter(|(leg, _)| stance[*leg]) {
                let base_only = Tangent {
                    base: velocity.base,
                    joints: [0.0; JOINTS],
                };
                let inverse = inverse.ok_or("a stance leg is stretched out")?;
                let qd = -(inverse * j.mul(&base_only).linear);
                velocity.joints[3 * leg..3 * leg + 3].copy_from_slice(qd.as_slice());
            }
            let now = centroidal_state(self, &posture, &velocity);
            let missing = Force::new(Vector3::zeros(), momentum_w - now.momentum_w.angular);
            let faster = to_base * map.locked_angular_velocity(&missing);
            let shift = to_base * (com_velocity_w - now.com_velocity_w);
            if shift.norm() < 1e-9 && faster.norm() < 1e-9 {
                return Ok(velocity);
            }
            velocity.base.linear += shift;
            velocity.base.angular += faster;
        }
        Err("no whole-body velocity for this motion of the centre of mass".into())
    }
}
