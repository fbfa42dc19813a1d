//! The disturbed robot: its masses, its payload, where its centre of mass is, and its rotors.

use super::{Disturbance, Key};
use nalgebra::Vector3;
use rbd_core::{BaseBody, BaseKind, Body, Symmetric3, TableError, TableModel, Tree};

/// The robot that stands in the lab where `planned` was planned with.
///
/// The payload is a point on the base. The centre of mass of the whole robot is moved by `com_x`, `com_y` with the base's own, about
/// which the base's mass keeps its distribution.
///
/// # Errors
/// What stands against the disturbed robot.
pub fn robot<M: Tree<f64, N>, const N: usize>(
    disturbance: &Disturbance,
    planned: &M,
) -> Result<TableModel<f64, N>, TableError> {
    let mut base: BaseBody<f64> = *planned.base();
    let mut bodies: [Body<f64>; N] = *planned.bodies();
    let scale = disturbance.get(Key::Mass);
    base.mass *= scale;
    base.first = base.first.map(|x| x * scale);
    base.second = base.second.map(|x| x * scale);
    for body in &mut bodies {
        body.mass *= scale;
        body.first = body.first.map(|x| x * scale);
        body.second = body.second.map(|x| x * scale);
        body.rotor_inertia *= disturbance.get(Key::Rotor);
    }
    let total = base.mass + bodies.iter().map(|body| body.mass).sum::<f64>();
    let shift = Vector3::new(disturbance.get(Key::ComX), disturbance.get(Key::ComY), 0.0) * total;
    move_com(&mut base, &shift);
    let place = [Key::PayloadX, Key::PayloadY, Key::PayloadZ].map(|key| disturbance.get(key));
    add_point(
        &mut base,
        disturbance.get(Key::Payload),
        &Vector3::from(place),
    );
    TableModel::new(BaseKind::Floating, base, &bodies)
}

/// Moves the centre of mass by `shift` over the base's mass, kg m; what the mass does about it stays.
fn move_com(base: &mut BaseBody<f64>, shift: &Vector3<f64>) {
    if shift.norm() == 0.0 {
        return;
    }
    let old = Vector3::from(base.first);
    let new = old + shift;
    add_second(base, &Symmetric3::outer(&old, -1.0 / base.mass));
    add_second(base, &Symmetric3::outer(&new, 1.0 / base.mass));
    base.first = new.into();
}

/// Adds a point mass, kg, at a place, m.
fn add_point(base: &mut BaseBody<f64>, mass: f64, place: &Vector3<f64>) {
    base.mass += mass;
    base.first = (Vector3::from(base.first) + place * mass).into();
    add_second(base, &Symmetric3::outer(place, mass));
}

fn add_second(base: &mut BaseBody<f64>, more: &Symmetric3<f64>) {
    for (sum, x) in base.second.iter_mut().zip(more.to_array()) {
        *sum += x;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::robot;
    use crate::lab::{Disturbance, Lab, PlantArgument};
    use a1_model::A1Geared;
    use rbd_core::{Configuration, Posture, Tree, center_of_mass};

    fn disturbed(text: &str) -> Disturbance {
        PlantArgument::plant(Some(&text.parse().unwrap()), Lab::A1, 0)
    }

    fn com(text: &str) -> (f64, nalgebra::Vector3<f64>) {
        let model = robot(&disturbed(text), &A1Geared).unwrap();
        let q = Configuration::<f64, 12>::NEUTRAL;
        let found = center_of_mass(&model, &Posture::new(&model, &q));
        (found.mass, found.position_w)
    }

    #[test]
    fn the_centre_of_mass_moves_as_far_as_it_says() {
        let (mass, before) = com("");
        let (same, after) = com("com_x=0.02,com_y=-0.01");
        assert!((mass - same).abs() < 1e-12);
        assert!((after - before - nalgebra::Vector3::new(0.02, -0.01, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn a_payload_weighs_and_pulls_where_it_is() {
        let (mass, before) = com("");
        let (more, after) = com("payload=2@0.1,0,0.05");
        assert!((more - mass - 2.0).abs() < 1e-12);
        let wanted = (before * mass + nalgebra::Vector3::new(0.2, 0.0, 0.1)) / more;
        assert!((after - wanted).norm() < 1e-12);
    }

    /// About its own centre the trunk is as hard to turn as before.
    #[test]
    fn a_moved_trunk_keeps_its_central_inertia() {
        let central = |text: &str| {
            let model = robot(&disturbed(text), &A1Geared).unwrap();
            let base = *Tree::<f64, 12>::base(&model);
            let first = nalgebra::Vector3::from(base.first);
            base.inertia().second.to_matrix() - first * first.transpose() / base.mass
        };
        assert!((central("com_x=0.02") - central("")).norm() < 1e-12);
    }
}
