//! How high feet in the air must be: least after lift-off and before touchdown, more on the way between.

use crate::common::{BASES, NI, NU, NX, data, jump};
use ocp_solver::Problem as Ocp;

/// What `swing_rise` adds to the bounds of interval `k`, m, one number per foot in the air.
fn added(rise: f64, k: usize) -> Vec<f64> {
    let data = data();
    let mut problem = jump(&data, BASES[2]);
    let bounds =
        |problem: &wb_opt::Problem<'_, f64, { crate::common::N }, { crate::common::FEET }>| {
            let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
            Ocp::<f64, NX, NU, NI>::bounds(problem, k, &mut lower, &mut upper);
            lower
        };
    let plain = bounds(&problem);
    problem.swing_rise = rise;
    let raised = bounds(&problem);
    // Rows are scaled, and the plain one is the height itself.
    let rows = plain.iter().zip(&raised).filter(|(a, b)| a != b);
    rows.map(|(a, b)| (b - a) * problem.swing_height / a)
        .collect()
}

#[test]
fn feet_rise_at_half_a_metre_per_second_and_come_down_as_fast() {
    // Intervals 12 to 19 of 12 ms on the rear feet, 20 to 33 of 5 ms in flight.
    let flight = 14.0 * 0.005;
    for (k, rise, feet, nearest) in [
        (12, 0.03, 2, 0.5 * 0.012),
        (15, 0.03, 2, 3.5 * 0.012),
        (19, 0.03, 2, f64::min(7.5 * 0.012, 0.5 * 0.012 + flight)),
        (19, 1.0, 2, f64::min(7.5 * 0.012, 0.5 * 0.012 + flight)),
        (33, 0.03, 4, 0.5 * 0.005),
    ] {
        let added = added(rise, k);
        assert_eq!(added.len(), feet, "{k}");
        let wanted = f64::min(rise, 0.5 * nearest);
        assert!(added.iter().all(|x| (x - wanted).abs() < 1e-12), "{k}");
    }
    // In flight the rear feet have left later than the front feet.
    let flying = added(0.03, 22);
    assert!((flying[0] - f64::min(0.03, 0.5 * 11.5 * 0.005)).abs() < 1e-12);
    assert!((flying[3] - 0.5 * 2.5 * 0.005).abs() < 1e-12);
    assert!(added(0.03, 5).is_empty());
}
