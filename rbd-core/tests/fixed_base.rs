//! A fixed base is part of the world: what is welded to it counts in no quantity of the moving robot.

use crate::common::{CAP, Model, close, masked, model, state};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::{
    BaseBody, BaseKind, BodyMotions, CentroidalDerivatives, CentroidalMap, ComJacobian,
    DerivativesWorkspace, Force, Kinematics, MassMatrix, Posture, Tangent, Tree, center_of_mass,
    centroidal_bias, centroidal_derivatives, centroidal_map, centroidal_momentum_rate,
    centroidal_state, com_jacobian, com_motion, crba, forward_accelerations, forward_kinematics,
    generalized_gravity, rnea,
};

/// The same limbs on a fixed base of this inertia.
fn fixed(model: &Model, base: BaseBody<f64>) -> Model {
    let rows = &model.bodies()[..model.joint_count()];
    Model::new(BaseKind::Fixed, base, rows).unwrap()
}

/// Every centroidal number of a state, in one list.
fn numbers(
    model: &Model,
    posture: &Posture<f64, CAP>,
    [v, a]: &[Tangent<f64, CAP>; 2],
) -> Vec<f64> {
    let mut out = Vec::new();
    let com = center_of_mass(model, posture);
    out.push(com.mass);
    out.extend(com.position_w.iter());
    let mut jac = ComJacobian::ZERO;
    let _ = com_jacobian(model, posture, &mut jac);
    out.extend(jac.base_angular.iter());
    out.extend(jac.joints.iter().flat_map(|c| c.iter().copied()));
    let motion = com_motion(model, posture, v, a);
    out.extend(motion.velocity_w.iter().chain(motion.acceleration_w.iter()));
    let mut map = CentroidalMap::ZERO;
    centroidal_map(model, posture, &mut map);
    out.extend(map.locked_inertia_w.to_array());
    let columns = map.base.iter().chain(&map.joints);
    out.extend(columns.flat_map(|c| c.to_array()));
    let now = centroidal_state(model, posture, v);
    out.extend(now.momentum_w.to_array());
    out.extend([now.kinetic_energy, now.potential_energy]);
    out.extend(centroidal_bias(model, posture, v).to_array());
    out.extend(centroidal_momentum_rate(model, posture, v, a).to_array());
    let mut by = Box::new(CentroidalDerivatives::ZERO);
    let mut ws = Box::new(DerivativesWorkspace::new());
    centroidal_derivatives(model, posture, v, a, &mut ws, &mut by);
    for columns in [
        &by.momentum_by_position,
        &by.rate_by_position,
        &by.rate_by_velocity,
        &by.map,
    ] {
        let all = columns.base.iter().chain(&columns.joints);
        out.extend(all.flat_map(|c| c.to_array()));
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// To the bit: the base's own inertia is never looked at, even where the base is said to move.
    #[test]
    fn the_base_does_not_count(robot in model(), (q, motions) in state(), resting in any::<bool>()) {
        let with = fixed(&robot, *robot.base());
        let without = fixed(&robot, BaseBody::EMPTY);
        let posture = Posture::new(&with, &q);
        let motions = if resting { motions.map(|x| masked(&with, x)) } else { motions };
        prop_assert_eq!(numbers(&with, &posture, &motions), numbers(&without, &posture, &motions));
    }

    /// The definitions, body by body: c = Σ m c / m, h = Σ (I v) about c, and its rate Σ (I a + v ×* I v).
    #[test]
    fn the_sums_over_moved_bodies(robot in model(), (q, motions) in state()) {
        let robot = fixed(&robot, *robot.base());
        let [v, a] = motions.map(|x| masked(&robot, x));
        let posture = Posture::new(&robot, &q);
        let mut poses = Kinematics::IDENTITY;
        forward_kinematics(&robot, &posture, &mut poses);
        let mut moves = BodyMotions::ZERO;
        forward_accelerations(&robot, &posture, &v, &a, &mut moves);
        let (mut mass, mut first) = (0.0, Vector3::zeros());
        let (mut momentum, mut rate, mut energy) = (Force::ZERO, Force::ZERO, 0.0);
        for i in 0..robot.joint_count() {
            let (body, pose) = (&robot.bodies()[i], &poses.bodies[i]);
            let (speed, change) = (moves.velocities[i], moves.accelerations[i]);
            let inertia = body.inertia();
            mass += body.mass;
            first += pose.point(&inertia.com()) * body.mass;
            let own = inertia.mul(&speed);
            momentum += pose.force(&own);
            rate += pose.force(&(inertia.mul(&change) + speed.cross_force(&own)));
            energy += 0.5 * (speed.dot(&own) + body.rotor_inertia * v.joints[i] * v.joints[i]);
        }
        let com = first / mass;
        let about = |f: Force<f64>| Force::new(f.linear, f.angular - com.cross(&f.linear));
        let now = centroidal_state(&robot, &posture, &v);
        prop_assert!(close(now.mass, mass, mass));
        prop_assert!((now.com_w - com).norm() < 1e-12);
        prop_assert!(close(now.kinetic_energy, energy, energy));
        prop_assert!(close(now.potential_energy, 9.81 * mass * com.z, 1e3));
        let pairs = [
            (now.momentum_w, about(momentum)),
            (centroidal_momentum_rate(&robot, &posture, &v, &a), about(rate)),
        ];
        for (ours, sum) in pairs {
            let scale = sum.to_array().into_iter().fold(1e3, |m: f64, x| m.max(x.abs()));
            for (x, y) in ours.to_array().into_iter().zip(sum.to_array()) {
                prop_assert!(close(x, y, scale), "{x} {y}");
            }
        }
    }

    /// The reaction of the ground carries the base's weight as well; so does the base block of the mass matrix.
    #[test]
    fn the_ground_carries_the_base(robot in model(), (q, motions) in state()) {
        let robot = fixed(&robot, *robot.base());
        let [v, a] = motions.map(|x| masked(&robot, x));
        let posture = Posture::new(&robot, &q);
        let com = com_motion(&robot, &posture, &v, &a);
        let all = com.mass + robot.base().mass;
        let up_w = posture.base().rotation * rnea(&robot, &posture, &v, &a).base.linear;
        let scale = up_w.norm().max(1e3);
        prop_assert!(close(up_w.z, com.mass * com.acceleration_w.z + 9.81 * all, scale));
        let still_w = posture.base().rotation * generalized_gravity(&robot, &posture).base.linear;
        prop_assert!(close(still_w.z, 9.81 * all, 1e3));
        let mut mass = MassMatrix::ZERO;
        crba(&robot, &posture, &mut mass);
        prop_assert!(close(mass.base.mass, all, all));
    }
}
