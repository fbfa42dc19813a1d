//! The jump machine as a task wants it, and what its programs did.

use super::{JOINTS, Landing, Level, State, Task, landing_posture};
use icub_model::profile::{self, Jump, Settings};
use jump_machine::Tick;
use jump_machine::humanoid::{self, PushOff, Solved, Work};
use rbd_core::Tree;
use wbc_qp::Yielded;
use wbc_qp::jump::Residuals;

/// Residuals up to which an equality of the paper counts as held: m/s and kg m²/s.
const HELD_VELOCITY: Residuals<f64> = Residuals {
    com: 0.02,
    momentum: 0.05,
};
/// The same at the level of torques: m/s² and N m.
const HELD_TORQUE: Residuals<f64> = Residuals {
    com: 0.1,
    momentum: 0.5,
};

/// iCub's profile with what the task changes.
#[must_use]
pub fn settings(task: &Task) -> Settings {
    let weight = |weight: f64| if task.momentum { weight } else { 0.0 };
    Settings {
        push_off: match task.level {
            Level::Velocity => PushOff::Velocity(wbc_qp::jump::VelocityJumpSettings {
                momentum_weight: weight(profile::VELOCITY.momentum_weight),
                ..profile::VELOCITY
            }),
            Level::Torque => PushOff::Torque(wbc_qp::jump::TorqueJumpSettings {
                momentum_weight: weight(profile::TORQUE.momentum_weight),
                ..profile::TORQUE
            }),
        },
        landing: match task.landing {
            Landing::Qp => humanoid::Landing::Program(profile::LANDING),
            Landing::Hold => humanoid::Landing::Servos(profile::COMPLIANT_SERVOS),
            Landing::Stiff => humanoid::Landing::Servos(profile::SERVOS),
        },
        motors: task.motors(),
        ..profile::SETTINGS
    }
}

/// The task's jump from this state.
///
/// # Errors
/// A height that is not positive.
pub fn jump(task: &Task, start: &State) -> Result<Jump, String> {
    Ok(Jump {
        profile: task.profile()?,
        start: *start,
        landing_joints: landing_posture(),
    })
}

/// Mass of a robot, kg.
pub fn mass(robot: &impl Tree<f64, JOINTS>) -> f64 {
    let bodies = robot.bodies().iter();
    robot.base().mass + bodies.map(|body| body.mass).sum::<f64>()
}

/// What the programs did.
#[derive(Clone, Copy, Debug, Default)]
pub struct QpLog {
    /// Ticks that solved one.
    pub solves: u64,
    /// Those without an answer, or without the optimum.
    pub failures: u64,
    /// Most iterations of one.
    pub max_iterations: u32,
    /// Ticks in which an equality of the paper gave way.
    pub relaxed_ticks: u64,
    /// Largest residuals in the push-off.
    pub residuals: Residuals<f64>,
}

impl QpLog {
    /// Books a tick of the machine.
    pub fn count(&mut self, task: &Task, tick: &Tick<Work<f64>>) {
        let (solved, held) = match (tick.work, task.level) {
            (Work::PushOff(solved), Level::Velocity) => (solved, Some(HELD_VELOCITY)),
            (Work::PushOff(solved), Level::Torque) => (solved, Some(HELD_TORQUE)),
            // Nothing has to hold the equalities there.
            (Work::Landing(solved), _) => (solved, None),
            (Work::Servos | Work::Damping, _) => return,
        };
        self.solves += 1;
        match solved {
            Ok(solved) => self.note(&solved, task.momentum, held),
            Err(_) => self.failures += 1,
        }
    }

    /// Books an answer. `held` says up to which residuals the paper's equalities count as held.
    fn note(&mut self, solved: &Solved<f64>, momentum: bool, held: Option<Residuals<f64>>) {
        // A command, but not the program's optimum.
        self.failures += u64::from(solved.capped);
        self.max_iterations = self.max_iterations.max(solved.iterations);
        let mut relaxed = solved.yielded != Yielded::Nothing;
        if let Some(held) = held {
            let residuals = solved.residuals;
            let momentum = if momentum { residuals.momentum } else { 0.0 };
            relaxed |= residuals.com > held.com || momentum > held.momentum;
            self.residuals.com = self.residuals.com.max(residuals.com);
            self.residuals.momentum = self.residuals.momentum.max(momentum);
        }
        self.relaxed_ticks += u64::from(relaxed);
    }
}
