//! What to tell when there is no plan: what blocks, and the least change with which one is found.
//!
//! Only [`bounds`](super::bounds) prove that there is none. A solver that ends elsewhere proves nothing, so the answer is "not found",
//! with the point of least violation that it came to and the rows that are violated there. The relaxations are not guessed from those
//! rows: each is a task that was planned.

use super::Observe;
use super::audit::Audit;
use super::bounds::Impossible;
use super::task::{SrbPlan, Task};
use super::whole_body::{Blocked, WholeBodyPlan};
use core::ops::ControlFlow;
use core::time::Duration;
use nalgebra::Vector3;
use ocp_solver::{Progress, Settings, Status, blocking_rows};
use serde_json::{Value, json};
use srb_opt::Row;

/// Who hears every iteration of a solver, and stops it by `Break`.
pub trait Observer: FnMut(&Progress<f64>) -> ControlFlow<()> {}

impl<F: FnMut(&Progress<f64>) -> ControlFlow<()>> Observer for F {}

/// Why there is no plan.
pub struct Answer {
    /// `Infeasible` where that is proven, else `NotFound`, `AuditFailed`, `OutOfTime` or `Cancelled`.
    pub status: &'static str,
    /// What blocks.
    pub because: String,
    /// Changes with which there would be a plan, each on its own.
    pub relaxations: Vec<String>,
}

impl Answer {
    /// As text.
    #[must_use]
    pub fn text(&self) -> String {
        let head = match self.status {
            "Infeasible" => "infeasible",
            "AuditFailed" => "planned, but the audit refuses the plan",
            "OutOfTime" => "out of time",
            "Cancelled" => "cancelled",
            _ => "not found",
        };
        let mut text = format!("{head}: {}", self.because);
        for (i, change) in self.relaxations.iter().enumerate() {
            text += if i == 0 { "\n  " } else { "\n  or " };
            text += change;
        }
        text
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({ "because": self.because, "relaxations": self.relaxations })
    }

    /// From a proof.
    #[must_use]
    pub fn proven(proof: Impossible) -> Self {
        Self {
            status: "Infeasible",
            because: proof.to_string(),
            relaxations: vec![proof.relaxation],
        }
    }

    /// From an audit that the plan did not pass.
    pub(crate) fn failed(audit: &Audit) -> Self {
        Self {
            status: "AuditFailed",
            because: audit.complaint(),
            relaxations: Vec::new(),
        }
    }

    /// From an observer that did not want to wait.
    pub(crate) fn cancelled() -> Self {
        Self {
            status: "Cancelled",
            because: "stopped before a plan was found".to_owned(),
            relaxations: Vec::new(),
        }
    }

    /// Of a search that the end of the time there was cut short: the rows are those that it had still to meet.
    pub(crate) fn out_of_time(self, within: Duration) -> Self {
        Self {
            status: "OutOfTime",
            because: format!("after {} s {}", within.as_secs_f64(), self.because),
            ..self
        }
    }

    /// From a rigid-body plan that was not found: what blocks.
    #[must_use]
    pub fn no_body_plan(task: &Task, plan: &SrbPlan) -> Self {
        let rows = blocking_rows::<4, _, _, _, _, _, _>(&plan.stages);
        let worst = rows[0].map_or(0.0, |row| row.violation.abs());
        let counts = |violation: f64| violation.abs() >= 0.05 * worst && violation.abs() > 1e-4;
        let rows = rows.iter().flatten().filter(|row| counts(row.violation));
        let rows = rows.filter_map(|row| {
            let (kind, unit) = task.problem.row(row.stage, row.row)?;
            Some(sentence(task, kind, (row.violation * unit).abs()))
        });
        Self {
            status: "NotFound",
            because: not_found(
                "the body's motion",
                plan.status,
                plan.max_violation,
                rows.collect(),
            ),
            relaxations: Vec::new(),
        }
    }

    /// From a whole-body plan that was not found: what blocks.
    #[must_use]
    pub fn no_whole_body_plan(task: &Task, plan: &WholeBodyPlan) -> Self {
        let rows = plan
            .blocked
            .iter()
            .map(|row| whole_body_sentence(task, row));
        let because = not_found(
            "the whole body's motion",
            plan.outcome.status,
            plan.judged.max_violation,
            rows.collect(),
        );
        Self {
            status: "NotFound",
            because,
            relaxations: (plan.stronger.iter())
                .map(|stronger| stronger.told(&task.robot))
                .collect(),
        }
    }

    /// With the changes of the task that give the rigid body a plan. `observe` hears every iteration of the easier tasks, and stops by
    /// `Break`: what was found until then is told.
    #[must_use]
    pub fn with_easier_tasks(mut self, task: &Task, mut observe: impl Observer) -> Self {
        self.relaxations = relaxations(task, &mut observe);
        if !self.relaxations.is_empty() {
            self.because += "; what would help was tried on the body alone, without its legs";
        }
        self
    }
}

/// "not found, least violation …" with the rows, each kind once: rows come worst first.
fn not_found(what: &str, status: Status, violation: f64, rows: Vec<String>) -> String {
    let mut told: Vec<String> = Vec::new();
    for row in rows {
        let kind = |row: &str| row.replace(|c: char| c.is_ascii_digit(), "");
        if told.iter().all(|other| kind(other) != kind(&row)) {
            told.push(row);
        }
    }
    let mut text = format!("{what}, least violation {violation:.1e} ({status:?})");
    if !told.is_empty() {
        text += &format!("; {}", told.join("; "));
    }
    text
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// A row of the rigid body in words; `by` in its own unit.
fn sentence(task: &Task, row: Row, by: f64) -> String {
    let place = |foot: usize| task.robot.place(foot);
    match row {
        Row::Reach { foot, axis } => format!(
            "leg {} would have to reach {by:.3} m farther along {}",
            place(foot),
            AXES[axis.min(2)]
        ),
        Row::Clearance { .. } if task.edge.is_some_and(|edge| edge.drop < 0.0) => {
            format!("the box would have to be {by:.3} m lower")
        }
        Row::Clearance { .. } => format!("the trunk comes {by:.3} m too near to the ground"),
        Row::Duration { phase } => format!("phase {} is {by:.3} s off its bounds", phase + 1),
        Row::Total => format!("the whole is {by:.3} s off its bounds"),
        Row::Goal { axis } => format!(
            "{by:.3} m are missing to the goal along {}",
            AXES[axis.min(2)]
        ),
        Row::Rotation => format!("{:.1} deg are missing to the turn", by.to_degrees()),
        Row::Friction { foot } => format!("foot {} needs {by:.0} N more friction", place(foot)),
        Row::Force { foot } => format!("foot {} needs {by:.0} N more force", place(foot)),
    }
}

/// A row of the whole body in words.
fn whole_body_sentence(task: &Task, blocked: &Blocked) -> String {
    use wb_opt::Row as R;
    let by = blocked.violation;
    let joint = |i: usize| super::stored::joint_name(&task.robot, i.saturating_sub(wb_opt::BASE));
    let place = |foot: usize| task.robot.place(foot);
    match blocked.row {
        R::Landing => "the pre-landing posture is not reached".to_owned(),
        R::Friction { foot } => format!("foot {} needs {by:.0} N more friction", place(foot)),
        R::Dynamics => format!("the base lacks {by:.1} N or N m"),
        R::Slip { foot } => format!("foot {} slips", place(foot)),
        R::Effort { joint: i } => format!("{} needs {by:.1} N m more torque", joint(i)),
        R::Line { joint: i } => {
            format!("{} needs {by:.1} N m more torque at its speed", joint(i))
        }
        R::Drift { foot } => format!("foot {} rolls {by:.3} m too far", place(foot)),
        R::Clearance { .. } => format!("trunk or knees come {by:.3} m too near to the ground"),
        R::Swing { foot } => format!(
            "foot {} comes {by:.3} m too near to the ground",
            place(foot)
        ),
        R::Apart { .. } => format!("two links come {by:.3} m too near to each other"),
        R::Position { joint: i } => format!("{} needs {by:.3} rad more room", joint(i)),
        R::Speed { joint: i } => format!("{} needs {by:.1} rad/s more speed", joint(i)),
        R::Goal { axis } if axis < 3 => {
            format!("{by:.3} m are missing to the goal along {}", AXES[axis])
        }
        R::Goal { .. } => format!("{:.1} deg are missing to the turn", by.to_degrees()),
    }
}

/// A way to make a task easier: at 0 it is the task, at 1 as easy as this way makes it.
struct Easing {
    /// Whether it changes this task.
    applies: fn(&Task) -> bool,
    /// The task at this share.
    at: fn(&Task, f64) -> Task,
    /// What was changed, in words; the last argument is the plan that was found.
    tell: fn(&Task, &Task, &SrbPlan) -> String,
}

/// Halvings between a share that is solved and one that is not.
const HALVINGS: usize = 5;
/// Iterations after which an easier task counts as not solved.
const PATIENCE: usize = 150;

const EASINGS: [Easing; 5] = [
    Easing {
        applies: |task| task.goal.z > 0.0 || task.edge.is_some_and(|edge| edge.drop < 0.0),
        at: |task, share| {
            let mut eased = task.clone();
            let less = share * task.goal.z;
            eased.goal.z -= less;
            eased.problem.goal_w.z -= less;
            if let Some(edge) = &mut eased.problem.edge {
                edge.drop += less;
            }
            eased
        },
        tell: |task, eased, _| {
            let what = task.edge.map_or("goal", |_| "box");
            format!(
                "the {what} would have to be {:.3} m lower",
                task.goal.z - eased.goal.z
            )
        },
    },
    Easing {
        applies: |task| so3::math::hypot(task.goal.x, task.goal.y) > 1e-6,
        at: |task, share| {
            let mut eased = task.clone();
            let less = Vector3::new(task.goal.x, task.goal.y, 0.0) * share;
            eased.goal -= less;
            eased.problem.goal_w -= less;
            eased
        },
        tell: |task, eased, _| {
            format!(
                "the goal would have to be {:.3} m nearer",
                (task.goal - eased.goal).norm()
            )
        },
    },
    Easing {
        applies: |_| true,
        at: |task, share| {
            let mut eased = task.clone();
            let count = eased.problem.phase_count;
            let mut total = 0.0;
            for phase in &mut eased.problem.phases[..count] {
                phase.min_duration += share * (phase.min_duration.min(0.1) - phase.min_duration);
                phase.max_duration += share * (phase.max_duration.max(1.5) - phase.max_duration);
                total += phase.max_duration;
            }
            eased.problem.max_total += share * (total - eased.problem.max_total).max(0.0);
            eased.problem.min_total -= share * (eased.problem.min_total - 0.1).max(0.0);
            eased
        },
        tell: |task, _, plan| {
            let count = task.problem.phase_count;
            let durations = plan.stages.first().map(|stage| stage.state.durations);
            let durations: Vec<String> = (durations.iter().flatten().take(count))
                .map(|t| format!("{t:.3}"))
                .collect();
            format!("the phases would have to last {} s", durations.join(", "))
        },
    },
    Easing {
        applies: |_| true,
        at: |task, share| {
            let mut eased = task.clone();
            eased.problem.friction += share * (1.5 - task.problem.friction).max(0.0);
            eased
        },
        tell: |_, eased, _| {
            let ground = eased.problem.friction / eased.limits.friction_share;
            format!("the ground's friction would have to be {ground:.3}")
        },
    },
    Easing {
        applies: |_| true,
        at: |task, share| {
            let mut eased = task.clone();
            eased.problem.max_force *= 1.0 + 3.0 * share;
            eased
        },
        tell: |_, eased, _| {
            let problem = &eased.problem;
            format!(
                "the legs would have to push with {:.0} N per foot, {:.3} weights of the robot",
                problem.max_force,
                problem.max_force / (problem.mass * problem.gravity)
            )
        },
    },
];

/// Every easing with which the rigid body finds a plan, as little of it as halving finds.
fn relaxations(task: &Task, observe: Observe<'_>) -> Vec<String> {
    let mut settings = Settings::new();
    (settings.max_iterations, settings.restoration_iterations) = (PATIENCE, 0);
    settings.attempt_iterations = PATIENCE;
    let mut solve = |eased: &Task| {
        let plan = eased.attempt(&settings, &mut *observe).ok()?;
        let possible = super::bounds::impossible(eased).is_none();
        (plan.status == Status::Solved && possible).then_some(plan)
    };
    let mut told = Vec::new();
    for easing in EASINGS.iter().filter(|easing| (easing.applies)(task)) {
        let (mut low, mut high) = (0.0, 1.0);
        let mut eased = (easing.at)(task, high);
        let Some(mut plan) = solve(&eased) else {
            continue;
        };
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let candidate = (easing.at)(task, middle);
            match solve(&candidate) {
                Some(found) => (high, eased, plan) = (middle, candidate, found),
                None => low = middle,
            }
        }
        told.push((easing.tell)(task, &eased, &plan));
    }
    told
}
