//! A task as it is written down: one TOML file. The nine tasks of the project are such files too, in `jump-planner/tasks`.

use crate::robot::{Quadruped, RobotError};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The tasks that the program brings along.
pub const BUILT_IN: [(&str, &str); 9] = [
    ("a1/lateral", include_str!("../../tasks/a1/lateral.toml")),
    (
        "a1/lateral-down",
        include_str!("../../tasks/a1/lateral-down.toml"),
    ),
    ("a1/spin-90", include_str!("../../tasks/a1/spin-90.toml")),
    ("a1/diagonal", include_str!("../../tasks/a1/diagonal.toml")),
    (
        "a1/barrel-roll",
        include_str!("../../tasks/a1/barrel-roll.toml"),
    ),
    (
        "a1/double-barrel-roll",
        include_str!("../../tasks/a1/double-barrel-roll.toml"),
    ),
    (
        "a1/double-backflip",
        include_str!("../../tasks/a1/double-backflip.toml"),
    ),
    (
        "a1/forward-60",
        include_str!("../../tasks/a1/forward-60.toml"),
    ),
    (
        "a1/barrel-roll-box",
        include_str!("../../tasks/a1/barrel-roll-box.toml"),
    ),
];

/// A task file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskFile {
    /// `a1`, or the path of a URDF, seen from the file.
    pub robot: String,
    /// Joints of the URDF that are locked, `JOINT=VALUE`.
    #[serde(default)]
    pub lock: Vec<String>,
    /// Displacement of the centre of mass, m.
    pub goal_m: [f64; 3],
    /// Where the feet FL, FR, RL, RR stand at the start, seen from below the centre of mass, m; below the hips without it.
    pub feet_m: Option<[[f64; 2]; 4]>,
    /// Turn of the body; without it the body ends as it began.
    pub turn: Option<TurnTable>,
    /// A box to jump off or onto.
    pub r#box: Option<BoxTable>,
    /// The trunk may touch the ground in the landing.
    #[serde(default)]
    pub trunk_may_touch: bool,
    /// Contact phases in order; the last one is the flight.
    #[serde(rename = "phase")]
    pub phases: Vec<PhaseTable>,
    /// Bounds of the whole duration.
    #[serde(default)]
    pub total: TotalTable,
    /// What the plan may use.
    #[serde(default)]
    pub limits: LimitsTable,
    /// Weights of the costs.
    #[serde(default)]
    pub weights: WeightsTable,
}

/// The turn of the body.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurnTable {
    /// Axis in the world at the start, of any length.
    pub axis: [f64; 3],
    /// May exceed 360.
    pub angle_deg: f64,
}

/// A step of the ground.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxTable {
    /// Height of the start over the landing, m; negative jumps up.
    pub drop_m: f64,
    /// Axis across the edge.
    pub axis: Across,
    /// Side of the landing along the axis, 1 or -1.
    pub side: i8,
    /// Distance of the edge from the feet that stand nearest, m. Either this or `distance_m`.
    pub beyond_feet_m: Option<f64>,
    /// Distance of the edge from the middle of the robot, m.
    pub distance_m: Option<f64>,
}

/// Axis across an edge.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Across {
    /// Forwards.
    X,
    /// To the left.
    Y,
}

/// One contact phase.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseTable {
    /// Feet on the ground: FL, FR, RL, RR.
    pub feet: Vec<String>,
    /// Intervals of the rigid body's plan.
    #[serde(default = "default_intervals")]
    pub intervals: usize,
    /// Guess of the duration, s: within the bounds that are given, and moved into those that are not.
    pub guess_s: f64,
    /// Shortest duration, s; the default depends on the feet.
    pub min_s: Option<f64>,
    /// Longest duration, s; the default depends on the feet.
    pub max_s: Option<f64>,
    /// Turn at the end of the phase that the body should follow, degrees: in all phases or in none. Without it the turn is even.
    pub turn_deg: Option<f64>,
}

const fn default_intervals() -> usize {
    40
}

/// Bounds of the whole duration, s.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TotalTable {
    /// Shortest, s.
    pub min_s: f64,
    /// Longest, s.
    pub max_s: f64,
}

impl Default for TotalTable {
    fn default() -> Self {
        Self {
            min_s: 0.5,
            max_s: 1.5,
        }
    }
}

/// What the plan may use. Defaults leave about a third to the controller.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsTable {
    /// Friction of the ground.
    pub friction: f64,
    /// Share of it that the plan may use.
    pub friction_share: f64,
    /// Largest normal force per foot in weights of the robot; by default the rigid body, which knows no torques, has paper A's, and the whole body
    /// what its joints give.
    pub force_weights: Option<f64>,
    /// Least height of the trunk over the ground, m; not negative.
    pub clearance_m: f64,
    /// Shares of the joints' torque limits, rising: the least with which the task is solved.
    pub torque_shares: [f64; 3],
    /// Share of the motors' speeds.
    pub speed_share: f64,
}

impl Default for LimitsTable {
    fn default() -> Self {
        Self {
            friction: 0.6,
            friction_share: 0.75,
            force_weights: None,
            clearance_m: 0.03,
            torque_shares: [24.0 / 33.5, 28.0 / 33.5, 30.0 / 33.5],
            speed_share: 0.85,
        }
    }
}

/// Weights of the costs.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WeightsTable {
    /// Rigid body: angular velocity, s²/rad², of a turn about the level axis with most inertia; of others by their share of its energy.
    pub omega: f64,
    /// Rigid body: forces, N⁻².
    pub force: f64,
    /// Rigid body: rotation from its reference, rad⁻².
    pub rotation: f64,
    /// Whole body: distance from the reference, m⁻² and rad⁻².
    pub position: f64,
    /// Whole body: torques, (N m)⁻².
    pub torque: f64,
    /// Whole body: distance from the goal, m⁻² and rad⁻². An end a centimetre off costs 0.3, of the 3 to 100 that plans of A1 cost.
    pub goal: f64,
}

impl Default for WeightsTable {
    fn default() -> Self {
        Self {
            omega: 1e-2,
            force: 1e-5,
            rotation: 1.0,
            position: 1.0,
            torque: 1e-4,
            goal: 3000.0,
        }
    }
}

/// Why a task cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TaskError {
    /// Neither a built-in name nor a file.
    #[error("no task `{name}`: write the path of a TOML file, or one of {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The file cannot be read.
    #[error("{path}: {}", crate::file::told(.error))]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The file is not a task.
    #[error("{path}: {error}")]
    Toml {
        /// The file.
        path: PathBuf,
        /// Line, key, and what is accepted there.
        error: Box<toml::de::Error>,
    },
    /// A value that no task can have.
    #[error("{task}: {key}: {what}")]
    Value {
        /// The task.
        task: String,
        /// Its key in the file.
        key: String,
        /// What it must be.
        what: String,
    },
    /// The robot cannot be planned for.
    #[error("{task}: robot {robot}: {error}")]
    Robot {
        /// The task.
        task: String,
        /// The robot.
        robot: String,
        /// Why.
        error: Box<RobotError>,
    },
}

impl TaskFile {
    /// The task of this name, or in the file of this path, with the folder that its paths are seen from.
    ///
    /// # Errors
    /// [`TaskError`] names file, line, key and what is accepted there.
    pub fn load(name: &str) -> Result<(Self, PathBuf), TaskError> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(Path::new(name), text).map(|file| (file, PathBuf::new()));
        }
        let path = Path::new(name);
        if !name.ends_with(".toml") {
            return Err(TaskError::Unknown {
                name: name.to_owned(),
                known: BUILT_IN.map(|(name, _)| name).join(", "),
            });
        }
        let text = crate::file::read_text(path).map_err(|error| TaskError::File {
            path: path.to_owned(),
            error,
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::parse(path, &text).map(|file| (file, folder))
    }

    /// The task in this text; `path` is what errors call it.
    ///
    /// # Errors
    /// [`TaskError::Toml`] names line, key and what is accepted there.
    pub fn parse(path: &Path, text: &str) -> Result<Self, TaskError> {
        toml::from_str(text).map_err(|error| TaskError::Toml {
            path: path.to_owned(),
            error: Box::new(error),
        })
    }

    /// The robot that the file names; `folder` is where its path is seen from, `task` what errors call the task.
    ///
    /// # Errors
    /// [`TaskError::Robot`] says what is wrong with it.
    pub fn own_robot(&self, task: &str, folder: &Path) -> Result<Quadruped, TaskError> {
        let robot = match self.robot.as_str() {
            "a1" => Quadruped::a1(),
            name if Path::new(name).extension().is_none() && !folder.join(name).exists() => {
                Err(RobotError::Unknown)
            }
            path => Quadruped::load(&folder.join(path), &self.lock),
        };
        robot.map_err(|error| super::robot_error(task, Path::new(&self.robot), error))
    }
}

impl From<TaskError> for String {
    fn from(error: TaskError) -> Self {
        error.to_string()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{BUILT_IN, TaskFile};
    use std::path::Path;

    #[test]
    fn errors_name_file_line_key_and_what_is_accepted() {
        let (_, text) = BUILT_IN[0];
        for (from, to, told) in [
            (
                "goal_m",
                "goall_m",
                vec!["line 3", "goall_m", "`goal_m`", "`phase`"],
            ),
            (
                "guess_s = 0.5",
                "guess_s = \"x\"",
                vec!["line 8", "guess_s"],
            ),
            (
                "intervals",
                "knots",
                vec!["line 7", "knots", "`intervals`", "`turn_deg`"],
            ),
            ("max_s", "most", vec!["most", "`min_s`", "`max_s`"]),
        ] {
            let bad = text.replacen(from, to, 1);
            let error = TaskFile::parse(Path::new("my.toml"), &bad).unwrap_err();
            let message = error.to_string();
            for word in told.iter().chain(&["my.toml"]) {
                assert!(message.contains(word), "{word} missing in {message}");
            }
        }
    }
}
