//! Laws of motions and limits for any numbers.
#![allow(missing_docs, reason = "tests")]

use a1_model::{A1, BUILD, FEET};
use jump_control::{CartesianGains, CartesianPd, Measurement, MinimumJerk, Reference, Slew};
use proptest::prelude::*;
use rbd_core::nalgebra::Vector3;
use rbd_core::{Configuration, Kinematics, Motion, Posture, Transform, forward_kinematics};

const N: usize = 3;

fn motion() -> impl Strategy<Value = MinimumJerk<f64, N>> {
    let posture = || prop::array::uniform3(-3.0..3.0_f64);
    (
        posture(),
        prop::array::uniform3(-20.0..20.0_f64),
        posture(),
        0.02..2.0_f64,
    )
        .prop_map(|(from, velocity, to, duration)| MinimumJerk {
            from,
            velocity,
            to,
            duration,
        })
}

fn joints(most: f64) -> impl Strategy<Value = [f64; 12]> {
    prop::array::uniform12(-most..most)
}

fn gains() -> impl Strategy<Value = CartesianGains<f64>> {
    let each = |most: f64| prop::array::uniform3(0.0..most);
    (each(500.0), each(20.0)).prop_map(|(stiffness, damping)| CartesianGains { stiffness, damping })
}

/// A1's feet seen from its base.
fn feet(joints: &[f64; 12]) -> [Vector3<f64>; 4] {
    let q = Configuration {
        joints: *joints,
        ..Configuration::NEUTRAL
    };
    let mut bodies = Kinematics::IDENTITY;
    forward_kinematics(&A1, &Posture::new(&A1, &q), &mut bodies);
    FEET.map(|foot| bodies.frame(&foot.frame).translation)
}

/// The torques of A1's foot controller.
fn torques(
    gains: CartesianGains<f64>,
    (joints, joint_velocities): ([f64; 12], [f64; 12]),
    reference: &Reference<f64, 12>,
) -> [f64; 12] {
    let mut pd = CartesianPd::<f64, 12, 4>::new(&BUILD, FEET.map(|foot| foot.frame));
    pd.gains = gains;
    let measured = Measurement {
        base: Transform::IDENTITY,
        base_velocity: Motion::ZERO,
        joints,
        joint_velocities,
        foot_forces: [0.0; 4],
        age: 0.0,
    };
    pd.command(&A1, &measured, reference).feed_forward
}

fn near(a: &[f64; N], b: &[f64; N], bound: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= bound)
}

proptest! {
    /// It begins as it was told, ends at rest, and is held there.
    #[test]
    fn a_motion_has_its_ends(m in motion(), later in 0.0..5.0_f64) {
        prop_assert_eq!(m.at(0.0), (m.from, m.velocity));
        let (q, qd) = m.at(m.duration + later);
        prop_assert!(near(&q, &m.to, 1e-12) && near(&qd, &[0.0; N], 1e-9));
    }

    /// Velocities are the derivatives of positions.
    #[test]
    fn velocities_are_derivatives(m in motion(), x in 0.01..0.99_f64) {
        let (t, h) = (x * m.duration, 1e-6 * m.duration);
        let ((ahead, _), (behind, _)) = (m.at(t + h), m.at(t - h));
        let slope = core::array::from_fn(|i| (ahead[i] - behind[i]) / (2.0 * h));
        prop_assert!(near(&slope, &m.at(t).1, 1e-6 * (1.0 + 20.0 / m.duration)));
    }

    /// Twice as long and half as fast is the same path.
    #[test]
    fn time_has_no_unit(m in motion(), x in 0.0..1.2_f64, factor in 0.1..10.0_f64) {
        let slow = MinimumJerk {
            velocity: m.velocity.map(|v| v / factor),
            duration: m.duration * factor,
            ..m
        };
        let t = x * m.duration;
        let ((q, qd), (p, pd)) = (m.at(t), slow.at(t * factor));
        prop_assert!(near(&q, &p, 1e-9) && near(&qd, &pd.map(|v| v * factor), 1e-9 * (1.0 + 100.0 / m.duration)));
    }

    /// Backwards from rest to rest it is itself.
    #[test]
    fn rest_to_rest_is_symmetric(m in motion(), x in 0.0..1.0_f64) {
        let there = MinimumJerk { velocity: [0.0; N], ..m };
        let back = MinimumJerk { from: m.to, to: m.from, ..there };
        let (q, p) = (there.at(x * m.duration).0, back.at((1.0 - x) * m.duration).0);
        prop_assert!(near(&q, &p, 1e-12));
    }

    /// No step is larger than allowed whatever is asked, a larger allowance comes nearer, and nothing is overshot.
    #[test]
    fn slew_is_bounded_and_monotone(
        asked in prop::collection::vec(prop::array::uniform3(prop_oneof![-50.0..50.0_f64, Just(f64::NAN), Just(f64::INFINITY)]), 1..20),
        rate in 0.0..1e5_f64,
        dt in 1e-5..1e-2_f64,
    ) {
        for law in [Slew::limit, Slew::limit_together] {
            let mut slew = Slew::<f64, N>::new(rate);
            let mut last = [0.0; N];
            for wanted in &asked {
                let mut quicker = slew;
                quicker.rate *= 2.0;
                let (now, sooner) = (law(&mut slew, wanted, dt), law(&mut quicker, wanted, dt));
                for i in 0..N {
                    let goal = if wanted[i].is_finite() { wanted[i] } else { 0.0 };
                    prop_assert!((now[i] - last[i]).abs() <= rate * dt * (1.0 + 1e-12) + 1e-12);
                    let (low, high) = (last[i].min(goal) - 1e-12, last[i].max(goal) + 1e-12);
                    prop_assert!((low..=high).contains(&now[i]));
                    prop_assert!((sooner[i] - goal).abs() <= (now[i] - goal).abs() + 1e-12);
                }
                last = now;
            }
        }
    }

    /// The power that goes into the joints, beyond the plan's torques, is what the springs between the feet and where they are wanted lose
    /// of their energy, less what their dampers take.
    #[test]
    fn feet_hang_on_springs_and_dampers(
        gains in gains(),
        (q, qd) in (joints(1.0), joints(3.0)),
        (wanted, planned) in (joints(1.0), joints(30.0)),
    ) {
        let reference = Reference { joints: wanted, torques: planned, ..Reference::ZERO };
        let tau = torques(gains, (q, qd), &reference);
        let power: f64 = (0..12).map(|i| (tau[i] - planned[i]) * qd[i]).sum();
        let h = 1e-5;
        let ends = [-h, h].map(|t| feet(&core::array::from_fn(|i| q[i] + t * qd[i])));
        let (mut gained, mut taken) = (0.0, 0.0);
        for (foot, goal) in feet(&wanted).iter().enumerate() {
            for axis in 0..3 {
                let [before, after] = ends.map(|feet| feet[foot][axis]);
                let stretched = [before, after].map(|p| goal[axis] - p);
                let [was, is] = stretched.map(|x| 0.5 * gains.stiffness[axis] * x * x);
                let speed = (after - before) / (2.0 * h);
                gained += (is - was) / (2.0 * h);
                taken += gains.damping[axis] * speed * speed;
            }
        }
        let scale = 1.0 + gained.abs() + taken;
        prop_assert!((power + gained + taken).abs() < 1e-6 * scale, "{power} {gained} {taken}");
    }

    /// Legs that are where the plan has them and move as it says are given its torques and no others.
    #[test]
    fn nothing_is_added_on_the_plan(
        gains in gains(),
        (q, qd, planned) in (joints(2.0), joints(20.0), joints(30.0)),
    ) {
        let reference = Reference { joints: q, joint_velocities: qd, torques: planned, node: 0 };
        prop_assert_eq!(torques(gains, (q, qd), &reference), planned);
    }
}
