//! Inverse dynamics and its derivatives against a textbook implementation over dual numbers.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::dual::inverse_dynamics;
use crate::common::{CAP, masked, model, state};
use proptest::prelude::*;
use rbd_core::{
    BaseKind, DerivativesWorkspace, Posture, RneaDerivatives, Tangent, Tree, rnea, rnea_derivatives,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn inverse_dynamics_is_the_textbooks(
        model in model(), (q, [v, a]) in state(), (_, [dq, dv]) in state(), (_, [da, _]) in state(),
    ) {
        let [v, a, dq, dv, da] = [v, a, dq, dv, da].map(|x| masked(&model, x));
        let posture = Posture::new(&model, &q);
        let tau = rnea(&model, &posture, &v, &a);
        let (mut ws, mut d) = (DerivativesWorkspace::new(), RneaDerivatives::ZERO);
        rnea_derivatives(&model, &posture, &v, &a, &mut ws, &mut d);
        let change = |m: &rbd_core::BlockMatrix<f64, CAP>, x: &Tangent<f64, CAP>| {
            let (base, joints) = m.mul(x.base.to_array(), &x.joints);
            base.into_iter().chain(joints).collect::<Vec<_>>()
        };
        let (by_q, by_v) = (change(&d.by_position, &dq), change(&d.by_velocity, &dv));
        let by_a = d.by_acceleration.mul(&da);

        let oracle = inverse_dynamics(&model, &q, [&v, &a], [&dq, &dv, &da]);
        let size = oracle.iter().map(|x| x.value.abs()).fold(1.0, f64::max);
        let speed = oracle.iter().map(|x| x.rate.abs()).fold(1.0, f64::max);
        let first = if model.base_kind() == BaseKind::Fixed { 6 } else { 0 };
        for i in first..6 + model.joint_count() {
            let x = oracle[i];
            let value = tau.coordinate(i);
            prop_assert!((x.value - value).abs() <= 1e-11 * size, "row {i}: {} {value}", x.value);
            let rate = by_q[i] + by_v[i] + by_a.coordinate(i);
            prop_assert!((x.rate - rate).abs() <= 1e-10 * speed, "rate of row {i}: {} {rate}", x.rate);
        }
    }
}
