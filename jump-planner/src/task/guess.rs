//! Where planning starts.

use super::{PHASES, SrbPlan, Task};
use crate::FOOT_COUNT;
use ocp_solver::{Stage, Status};
use srb_opt::{Problem, Reference};

impl Task {
    /// The guess of the single-rigid-body problem, not solved: where planning straight on the whole body starts.
    ///
    /// # Errors
    /// A problem that cannot be, with its row.
    pub fn guess(&self) -> Result<SrbPlan, String> {
        let problem = &self.problem;
        problem
            .check()
            .map_err(|error| format!("task {}: {error}", self.name))?;
        let mut stages = vec![Stage::new(srb_opt::State::new()); problem.intervals() + 1];
        turning_in_flight(problem).write_guess(&mut stages, || 0.0);
        problem.write_reference(&mut stages);
        Ok(SrbPlan {
            stages,
            status: Status::IterationLimit,
            iterations: 0,
            wall_ms: 0.0,
            cost: f64::NAN,
            max_violation: f64::NAN,
        })
    }
}

/// The problem whose guess is taken: one that turns by more than half a turn turns in its flight alone.
///
/// The paper's reference goes evenly from the start to the goal, and has turned far while the feet still stand. A rotation matrix does not
/// know of whole turns either, so beyond half a turn log(R_refᵀ R) pulls the other way round: how often the body turns is decided by
/// where the solver begins.
fn turning_in_flight(
    problem: &Problem<f64, FOOT_COUNT, PHASES>,
) -> Problem<f64, FOOT_COUNT, PHASES> {
    let mut guess = *problem;
    if problem.reference == Reference::Linear && problem.angle.abs() > core::f64::consts::PI {
        guess.reference = Reference::PerPhase;
        for phase in &mut guess.phases {
            let flies = !phase.contacts.contains(&true);
            phase.reference_angle = if flies { problem.angle } else { 0.0 };
        }
    }
    guess
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use crate::task::Task;
    use nalgebra::Rotation3;
    use srb_opt::Reference;

    /// How far the guess has turned at a node, rad, up to half a turn.
    fn turned(task: &Task, node: usize) -> f64 {
        let rotation = task.guess().unwrap().stages[node].state.rot_wb;
        so3::log(&Rotation3::from_matrix_unchecked(rotation)).norm()
    }

    /// The reference of a flip is the paper's, and has turned by 240° where the feet leave the ground; its guess has not turned there.
    #[test]
    fn a_flip_is_guessed_to_turn_in_its_flight() {
        let task = Task::load("a1/barrel-roll").unwrap();
        assert_eq!(task.problem.reference, Reference::Linear);
        assert!((task.problem.reference_angle(80).to_degrees() - 240.0).abs() < 1e-9);
        assert!(turned(&task, 80) < 1e-6);
        // The middle of the flight is half a roll.
        assert!((turned(&task, 100) - core::f64::consts::PI).abs() < 1e-3);
    }

    /// Up to half a turn the guess is the reference.
    #[test]
    fn a_spin_is_guessed_to_turn_evenly() {
        let task = Task::load("a1/spin-90").unwrap();
        let node = task.problem.intervals() / 2;
        let wanted = task.problem.reference_angle(node).abs();
        assert!((turned(&task, node) - wanted).abs() < 1e-3);
    }
}
