//! One call from a guess to a motion.

use crate::error::Error;
use crate::problem::Problem;
use crate::rows::row_capacity;
use crate::state::State;
use core::ops::ControlFlow;
use ocp_solver::{Progress, Settings, Solution, Solver, SparseStage};
use so3::Scalar;

/// Settings for whole-body problems: the solver's defaults with a tighter primal tolerance, because a row of
/// the force on the base is in units of 50 N, and a barrier that follows quickly: with the exact Hessian
/// a barrier problem need not be solved closely before the next. Of a thousand rows one is always near its bound, so each takes a
/// step of its own.
#[must_use]
pub fn settings<T: Scalar>() -> Settings<T> {
    let mut settings = Settings::new();
    settings.primal_tolerance = T::of(2e-8);
    settings.initial_mu = T::of(0.005);
    settings.mu_margin = T::of(1e3);
    settings.individual_steps = true;
    settings
}

impl<T: Scalar, const N: usize, const FEET: usize> Problem<'_, T, N, FEET> {
    /// Plans from the guess in the stages ([`Problem::write_guess`]) and leaves the motion there.
    ///
    /// # Errors
    /// [`Error::Parameter`] for unusable data, [`Error::Capacity`] for const sizes that are too small,
    /// [`Error::Solver`] for what the solver refuses.
    pub fn plan<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        settings: &Settings<T>,
        stages: &mut [SparseStage<T, State<T, N>, NX, NU, NI>],
        observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        self.check()?;
        let lines = self.robot.motors.iter().any(Option::is_some);
        let fits = NX >= N.saturating_mul(2)
            && NU >= N.saturating_add(FEET.saturating_mul(3))
            && NI >= row_capacity(N, FEET, self.friction.sides(), self.points(), lines);
        if !fits {
            return Err(Error::Capacity);
        }
        Ok(Solver::new(*settings).solve(self, stages, observer)?)
    }
}
