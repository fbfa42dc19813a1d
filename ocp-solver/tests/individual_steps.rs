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

fn same(solutions: &[Solution<f64>; 2]) -> Result<(), TestCaseError> {
    let [common, individual] = solutions;
    prop_assert_eq!(common.status, Status::Solved);
    prop_assert_eq!(individual.status, Status::Solved, "{:?}", individual);
    let off = (individual.cost - common.cost).abs();
    prop_assert!(off < 1e-5 * (1.0 + common.cost), "{:?}", solutions);
    Ok(())
}

proptest! {
    #![proptest_config(config(40, 1))]
    /// From walls that stop nearly everything to one that nothing touches.
    #[test]
    fn bryson_and_denham(wall in 0.03..0.3_f64, intervals in 10..120_usize) {
        let problem = BrysonDenham { intervals, wall };
        let mut guess = vec![Stage::new([0.0, 0.0]); intervals + 1];
        guess[0].state = [0.0, 1.0];
        same(&both(&problem, &guess))?;
    }

    #[test]
    fn least_time(intervals in 4..60_usize, longest in 2.5..20.0_f64, speed in 0.0..2.0_f64) {
        let problem = LeastTime { intervals, longest };
        let mut guess = vec![Stage::new([0.0; 3]); intervals + 1];
        for (k, stage) in guess.iter_mut().enumerate() {
            stage.state = [k as f64 / intervals as f64, if k == 0 { 0.0 } else { speed }, 1.0];
        }
        same(&both(&problem, &guess))?;
    }
}
