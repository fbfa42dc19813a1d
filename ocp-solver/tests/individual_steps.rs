//! Slacks and falling multipliers that take steps of their own arrive where common steps do.

use crate::common::{BrysonDenham, LeastTime, config};
use core::ops::ControlFlow;
use ocp_solver::{Problem, Settings, Solution, Solver, Stage, Status};
use proptest::prelude::*;

/// Solves with common steps and with individual ones.
fn both<P, const NX: usize, const NU: usize, const NI: usize>(
    problem: &P,
    guess: &[Stage<f64, P::State, NX, NU, NI>],
) -> [Solution<f64>; 2]
where
    P: Problem<f64, NX, NU, NI>,
{
    [false, true].map(|individual_steps| {
        let mut settings = Settings::new();
        settings.individual_steps = individual_steps;
        let observer = |_: &_| ControlFlow::Continue(());
        Solver::new(settings)
            .solve(problem, &mut guess.to_vec(), observer)
            .unwrap()
    })
}

/// On the central path every bound that holds costs µ more than at the optimum, so a cost is known to the sum of the products that a solver
/// leaves: at most `bounds` times what the residual says of the largest. (Seed 33: 54 bounds of 9·10⁻⁷ cost 4.8·10⁻⁵.) A hundredth more is
/// for the second order in µ, and 2·10⁻⁷ for the violation that is allowed.
fn same(solutions: &[Solution<f64>; 2], bounds: usize) -> Result<(), TestCaseError> {
    let [common, individual] = solutions;
    prop_assert_eq!(common.status, Status::Solved);
    prop_assert_eq!(individual.status, Status::Solved, "{:?}", individual);
    let off = (individual.cost - common.cost).abs();
    let products = solutions.each_ref().map(|s| s.residual.complementarity);
    let most = 1.01 * bounds as f64 * products[0].max(products[1]);
    prop_assert!(off < most + 2e-7 * (1.0 + common.cost), "{:?}", solutions);
    Ok(())
}

/// Of every row that an interval has, and of the time, one bound may hold.
fn least_time_arrives(intervals: usize, longest: f64, speed: f64) -> Result<(), TestCaseError> {
    let problem = LeastTime { intervals, longest };
    let mut guess = vec![Stage::new([0.0; 3]); intervals + 1];
    for (k, stage) in guess.iter_mut().enumerate() {
        let place = k as f64 / intervals as f64;
        stage.state = [place, if k == 0 { 0.0 } else { speed }, 1.0];
    }
    same(&both(&problem, &guess), intervals + 1)
}

/// Individual steps end with the adaptive rule here, at nine times the µ of common steps.
#[test]
fn least_time_under_another_rule() -> Result<(), TestCaseError> {
    least_time_arrives(54, 4.811_537_122_469_796, 0.040_184_507_007_832_32)
}

proptest! {
    #![proptest_config(config(40, 1))]
    /// From walls that stop nearly everything to one that nothing touches.
    #[test]
    fn bryson_and_denham(wall in 0.03..0.3_f64, intervals in 10..120_usize) {
        let problem = BrysonDenham { intervals, wall };
        let mut guess = vec![Stage::new([0.0, 0.0]); intervals + 1];
        guess[0].state = [0.0, 1.0];
        same(&both(&problem, &guess), intervals)?;
    }

    #[test]
    fn least_time(intervals in 4..60_usize, longest in 2.5..20.0_f64, speed in 0.0..2.0_f64) {
        least_time_arrives(intervals, longest, speed)?;
    }
}
