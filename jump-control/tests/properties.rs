//! Laws of motions and limits for any numbers.
#![allow(missing_docs, reason = "tests")]

use jump_control::{MinimumJerk, Slew};
use proptest::prelude::*;

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
}
