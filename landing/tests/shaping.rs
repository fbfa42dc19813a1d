//! Turning on time: what the legs do about a body that is late.
#![allow(missing_docs, reason = "tests")]

use crate::common::{Case, config, smooth};
use a1_model::{A1Geared, BUILD, FEET};
use landing::{InertiaShaping, Turning};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::Limbs;

fn vector(half: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-half..half).prop_map(Vector3::from)
}

fn axis() -> impl Strategy<Value = Vector3<f64>> {
    vector(1.0).prop_map(|x| x.try_normalize(1e-3).unwrap_or_else(Vector3::z))
}

/// Turning about `axis` with `rate`, as planned, in the middle of a flight that lasts.
fn turning(axis: &Vector3<f64>, rate: f64) -> Turning<f64> {
    Turning {
        missing_b: Vector3::zeros(),
        planned_b: axis * rate,
        omega_b: axis * rate,
        since: 10.0,
        left: 10.0,
    }
}

fn limbs(case: &Case) -> Limbs<f64, 12, 4> {
    Limbs::new(&A1Geared, &case.q, &FEET.map(|foot| foot.frame))
}

proptest! {
    #![proptest_config(config(128, 21))]

    /// To first order every foot goes by the share σ of its distance straight towards the axis of turning, and not along it; less within the
    /// ramp after take-off and before the legs are needed.
    #[test]
    fn feet_go_towards_the_axis(case in smooth(0.3), axis in axis(), share in -0.2..0.2_f64, since in 0.0..2.0_f64, left in 0.0..2.0_f64) {
        let shaping = InertiaShaping { damping: 1e-12, ..InertiaShaping::new(&BUILD) };
        let now = Turning {
            since: since * shaping.ramp,
            left: left * shaping.ramp,
            ..turning(&axis, 2.0 * shaping.slowest)
        };
        let limbs = limbs(&case);
        let joints = shaping.joints(share, &now, &limbs);
        let ramp = since.min(left).min(1.0);
        for end in &limbs.ends {
            let foot = end.position;
            let to_axis = axis * foot.dot(&axis) - foot;
            let off = end.mul(&joints) - to_axis * (share * ramp);
            prop_assert!(off.amax() < 1e-6, "{off}");
        }
    }

    /// σ̇ = k (θ/T + ω_d − ω)/ω, of the parts along the turning alone, and never beyond the largest share.
    #[test]
    fn the_share_makes_up_for_what_is_missing(
        axis in axis(), rate in 1.1..10.0_f64, planned in -30.0..30.0_f64, missing in -1.0..1.0_f64, left in 1.1..9.0_f64,
        share in -0.2..0.2_f64, aside in [vector(1.0), vector(1.0)],
    ) {
        let shaping = InertiaShaping::new(&BUILD);
        let (rate, left, dt) = (rate * shaping.slowest, left * shaping.ramp, 1e-3);
        let across = |x: &Vector3<f64>| x - axis * x.dot(&axis);
        let late = Turning {
            missing_b: axis * missing + across(&aside[0]),
            planned_b: axis * planned + across(&aside[1]),
            left,
            ..turning(&axis, rate)
        };
        let next = share + shaping.gain * dt * (missing / left + planned - rate) / rate;
        let expected = next.clamp(-shaping.most, shaping.most);
        prop_assert!((shaping.share(share, &late, dt) - expected).abs() < 1e-12);
    }

    /// Slow bodies, those whose legs are needed at once, and numbers that are none leave the share and the legs alone.
    #[test]
    fn what_cannot_be_helped_is_left_alone(case in smooth(0.3), axis in axis(), share in 0.01..0.2_f64, slow in 0.0..1.0_f64) {
        let shaping = InertiaShaping::new(&BUILD);
        let limbs = limbs(&case);
        let fast = turning(&axis, 2.0 * shaping.slowest);
        let late = Turning { missing_b: axis, ..fast };
        prop_assert!(shaping.share(share, &late, 1e-3) > share);
        prop_assert!(shaping.joints(share, &late, &limbs) != [0.0; 12]);
        let slow = Turning { missing_b: axis, ..turning(&axis, slow * shaping.slowest) };
        let needed = Turning { left: slow.omega_b.norm() / shaping.slowest * shaping.ramp, ..late };
        let none = [slow, Turning { omega_b: axis * f64::NAN, ..late }];
        for left_alone in none {
            prop_assert_eq!(shaping.share(share, &left_alone, 1e-3), share);
            prop_assert_eq!(shaping.joints(share, &left_alone, &limbs), [0.0; 12]);
        }
        for left_alone in [needed, Turning { missing_b: axis * f64::NAN, ..late }] {
            prop_assert_eq!(shaping.share(share, &left_alone, 1e-3), share);
        }
        prop_assert_eq!(shaping.joints(f64::NAN, &late, &limbs), [0.0; 12]);
        prop_assert_eq!(shaping.joints(0.0, &late, &limbs), [0.0; 12]);
    }
}
