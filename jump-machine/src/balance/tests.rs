//! Stances in equilibrium, made with inverse dynamics: what stands still must be seen as it is.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::{Balance, Found};
use crate::Centring;
use a1_model::{A1Geared, BUILD, FEET};
use landing::solve_damped;
use nalgebra::{Matrix3x4, Vector3, Vector4};
use proptest::prelude::{ProptestConfig, prop_assert, proptest};
use rbd_core::{
    BaseBody, BaseKind, Body, Configuration, GRAVITY, Limbs, TableModel, Transform, Tree,
    center_of_mass, generalized_gravity,
};

type Legs = Limbs<f64, 12, 4>;

/// A robot that stands still on a floor, with a trunk that leans.
struct Stance {
    limbs: Legs,
    up_b: Vector3<f64>,
    weight: f64,
    /// Centre of mass of the model.
    com_b: Vector3<f64>,
    /// Jᵀ f.
    felt: [f64; 12],
    /// f·u.
    sensed: [f64; 4],
}

fn legs(q: &Configuration<f64, 12>) -> Legs {
    Limbs::new(&A1Geared, q, &FEET.map(|foot| foot.frame))
}

/// Feet on a plane across `up_b`, by Newton's method from a crouch.
fn on_a_plane(base: Transform<f64>, up_b: &Vector3<f64>) -> Configuration<f64, 12> {
    let mut q = Configuration {
        base,
        joints: core::array::from_fn(|i| [0.05, 0.8, -1.6][i % 3]),
    };
    let under = legs(&q).ends.map(|end| end.position);
    for _ in 0..20 {
        for (end, under) in legs(&q).ends.iter().zip(&under) {
            // As far below the base's origin along up, on the vertical of the body through its first place.
            let lower = (0.25 + under.dot(up_b)) / up_b.z;
            let to = under - Vector3::z() * lower;
            let way = solve_damped(end, 1e-9, &(to - end.position));
            end.add_tr_mul(&way, &mut q.joints);
        }
    }
    q
}

/// `offset_b` is by how much the centre of mass is not where the model has it. Forces along the ground hold each other.
fn stand(lean: &Vector3<f64>, offset_b: &Vector3<f64>, squeeze: f64) -> Stance {
    let base = Transform::new(so3::exp(lean), Vector3::new(0.1, -0.2, 0.3));
    let up_b = base.rotation.inverse() * Vector3::z();
    let q = on_a_plane(base, &up_b);
    let limbs = legs(&q);
    let com = center_of_mass(&A1Geared, &limbs.posture);
    let com_b = base.rotation.inverse() * (com.position_w - base.translation);
    let weight = com.mass * -GRAVITY[2];
    let mut trunk: BaseBody<f64> = *A1Geared.base();
    trunk.first = (Vector3::from(trunk.first) + offset_b * com.mass).into();
    let bodies: &[Body<f64>; 12] = A1Geared.bodies();
    let robot = TableModel::with_any_inertia(BaseKind::Floating, trunk, bodies).unwrap();
    // Least forces along up with Σ φ = m g and Σ φ p = m g c across it.
    let across = base.rotation;
    let arms = limbs
        .ends
        .each_ref()
        .map(|end| across * (end.position - com_b - offset_b));
    let rows = Matrix3x4::from_fn(|row, foot| [arms[foot].x, arms[foot].y, 1.0][row]);
    let inverse = (rows * rows.transpose()).try_inverse().unwrap();
    let normal: Vector4<f64> = rows.transpose() * (inverse * Vector3::new(0.0, 0.0, weight));
    let middle = limbs
        .ends
        .iter()
        .map(|end| end.position)
        .sum::<Vector3<f64>>()
        / 4.0;
    let mut felt = [0.0; 12];
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (foot, end) in limbs.ends.iter().enumerate() {
        let f = up_b * normal[foot] + (end.position - middle) * squeeze;
        end.add_tr_mul(&f, &mut felt);
        force += f;
        moment += end.position.cross(&f);
    }
    // It does stand still: the feet hold the base of the robot that is, its limbs with it.
    let held = generalized_gravity(&robot, &limbs.posture).base;
    assert!((held.linear - force).norm() < 1e-6 && (held.angular - moment).norm() < 1e-6);
    Stance {
        limbs,
        up_b,
        weight,
        com_b,
        felt,
        sensed: normal.into(),
    }
}

impl Stance {
    fn found(&self, felt: &[f64; 12], sensed: &[f64; 4], most: f64) -> Option<Found<f64>> {
        let mut balance = Balance::new();
        for _ in 0..3 {
            balance.add(felt, sensed);
        }
        // What is not finite is left out.
        balance.add(&[f64::NAN; 12], sensed);
        balance.add(felt, &[f64::INFINITY; 4]);
        let limits = Centring {
            most,
            ..Centring::new(&BUILD)
        };
        balance.found(
            (&self.limbs, &self.up_b),
            (self.weight, &self.com_b),
            &limits,
        )
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// Either witness alone, and both, see the offset across the vertical exactly; gains that all motors or all sensors have in common,
    /// and feet that push against each other, change nothing of that. The weight is the mean of what they say.
    #[test]
    fn what_stands_still_is_seen_as_it_is(
        roll in -0.2..0.2, pitch in -0.2..0.2, yaw in -3.0..3.0,
        x in -0.02..0.02, y in -0.015..0.015, z in -0.02..0.02,
        squeeze in -30.0..30.0, gain in 0.8..1.2,
    ) {
        let offset_b = Vector3::new(x, y, z);
        let stance = stand(&Vector3::new(roll, pitch, yaw), &offset_b, squeeze);
        let across = offset_b - stance.up_b * offset_b.dot(&stance.up_b);
        let (felt, sensed) = (stance.felt.map(|x| gain * x), stance.sensed.map(|x| x / gain));
        let both = 0.5 * (gain + 1.0 / gain);
        let seen = [(felt, sensed, both), (felt, [0.0; 4], gain), ([0.0; 12], sensed, 1.0 / gain)];
        for (felt, sensed, weighs) in seen {
            let found = stance.found(&felt, &sensed, 0.04).unwrap();
            prop_assert!((found.offset_b - across).norm() < 1e-9, "{found:?} {across}");
            prop_assert!(f64::abs(1.0 + found.heavier - weighs) < 1e-9, "{found:?} {weighs}");
        }
    }
}

#[test]
fn what_cannot_be_is_not_believed() {
    let offset_b = Vector3::new(0.01, -0.005, 0.0);
    let stance = stand(&Vector3::new(0.05, -0.03, 0.2), &offset_b, 5.0);
    let (felt, sensed) = (&stance.felt, &stance.sensed);
    assert!(stance.found(felt, sensed, 0.04).is_some());
    // It is switched off, or the offset is implausible.
    assert!(stance.found(felt, sensed, 0.0).is_none());
    assert!(stance.found(felt, sensed, 0.01).is_none());
    // It hangs, and was never measured.
    let half = (felt.map(|x| 0.5 * x), sensed.map(|x| 0.5 * x));
    assert!(stance.found(&half.0, &half.1, 0.04).is_none());
    assert!(stance.found(&[f64::NAN; 12], sensed, 0.04).is_none());
    // Sensors that contradict the joints: neither is believed. A dead one makes the middle of the feet impossible, and the joints are believed alone.
    let mut drifted = *sensed;
    drifted[0] -= 7.5;
    drifted[3] += 7.5;
    assert!(stance.found(felt, &drifted, 0.04).is_none());
    let mut dead = *sensed;
    dead[2] = 0.0;
    let found = stance.found(felt, &dead, 0.04).unwrap();
    let across = offset_b - stance.up_b * offset_b.dot(&stance.up_b);
    assert!((found.offset_b - across).norm() < 1e-9);
}
