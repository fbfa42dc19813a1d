//! What a robot carries that its model does not know: a computer, a camera, a battery, bolted onto its trunk.
//!
//! Torques of a robot that weighs κ times as much are κ times the plan's ([`PayloadEstimate`](jump_control::PayloadEstimate)), which gives its centre of
//! mass the planned acceleration. They turn it too much: a load of the share p of the model's mass m pushes with −p F against its trunk, where F = Σ f_i are
//! the planned forces, so about the model's centre of mass the angular momentum L grows by
//!
//! ```text
//! L̇ = Σ (p_i − c) × (1 + p) f_i − (l − c) × p F = L̇_plan + p Σ (p_i − l) × f_i
//! ```
//!
//! the moment of the planned forces about the load, where p_i are the feet and l is its place. And the centre of mass of both is p/(1 + p) (l − c) from the
//! model's: a robot that turns at 10 rad/s flies 5 cm/s faster sideways than its model if that is 5 mm.
//!
//! What is carried across the trunk shows in the hold ([`balance`](crate::balance)); how high it is does not, but what is bolted to a robot is bolted onto
//! its trunk.

use nalgebra::Vector3;
use so3::Scalar;

/// A load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<T> {
    /// Its mass over the model's.
    pub share: T,
    /// Its height over the origin of the base, m.
    pub height: T,
}

impl<T: Scalar> Load<T> {
    /// How far the centre of mass is above the model's, which is at `com_b`; base axes, m.
    pub(crate) fn raises(&self, com_b: &Vector3<T>) -> Vector3<T> {
        Vector3::z() * ((self.height - com_b.z) * self.share / (T::ONE + self.share))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::Load;
    use a1_model::A1Geared;
    use nalgebra::Vector3;
    use rbd_core::{
        BaseBody, BaseKind, Body, Configuration, Posture, TableModel, Transform, Tree,
        center_of_mass,
    };

    #[test]
    fn the_centre_of_mass_rises_as_that_of_a_robot_with_a_load_on_its_trunk() {
        let q: Configuration<f64, 12> = Configuration {
            base: Transform::new(
                so3::exp(&Vector3::new(0.3, -0.5, 1.0)),
                Vector3::new(1.0, 2.0, 0.4),
            ),
            joints: core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3]),
        };
        let com_b = |mass, moment: Vector3<f64>| {
            let mut trunk: BaseBody<f64> = *A1Geared.base();
            trunk.mass += mass;
            trunk.first = (Vector3::from(trunk.first) + moment).into();
            let bodies: &[Body<f64>; 12] = A1Geared.bodies();
            let robot = TableModel::with_any_inertia(BaseKind::Floating, trunk, bodies).unwrap();
            let com = center_of_mass(&robot, &Posture::new(&robot, &q));
            let place_b = q.base.rotation.inverse() * (com.position_w - q.base.translation);
            (com.mass, place_b)
        };
        let (mass, before) = com_b(0.0, Vector3::zeros());
        for share in [0.0, 0.07, 0.25] {
            let (load, height) = (share * mass, 0.06);
            let place = Vector3::new(before.x, before.y, height);
            let (_, after) = com_b(load, place * load);
            let raises = Load { share, height }.raises(&before);
            assert!((before + raises - after).norm() < 1e-12, "{raises}");
        }
    }
}
