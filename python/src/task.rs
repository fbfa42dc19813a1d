//! What is to be jumped.

use std::path::{Path, PathBuf};

use jump_planner::task::file::{BUILT_IN, TaskFile};
use jump_planner::task::{self, Task as Planned};
use pyo3::{Py, PyResult, Python, pyclass, pymethods};

use crate::arrays::{List, list};
use crate::coordinates::of_configuration;
use crate::errors::bad;
use crate::robot::Robot;

/// What is to be jumped, and by whom.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Task {
    file: TaskFile,
    pub(crate) task: Planned,
}

impl Task {
    fn of(
        name: &str,
        (file, folder): (TaskFile, PathBuf),
        robot: Option<&Py<Robot>>,
    ) -> PyResult<Self> {
        let robot = match robot {
            Some(robot) => robot.get().0,
            None => file.own_robot(name, &folder).map_err(bad)?,
        };
        let task = Planned::from_file(name, &file, robot).map_err(bad)?;
        Ok(Self { file, task })
    }

    /// The task of this name or path.
    pub(crate) fn named(name: &str, robot: Option<&Py<Robot>>) -> PyResult<Self> {
        let file = TaskFile::load(name).map_err(bad)?;
        Self::of(name, file, robot)
    }

    /// The same task for another robot, where one is given.
    pub(crate) fn for_robot(&self, robot: Option<&Py<Robot>>) -> PyResult<task::Task> {
        match robot {
            None => Ok(self.task.clone()),
            Some(robot) => {
                let robot = robot.get().0;
                Planned::from_file(&self.task.name, &self.file, robot).map_err(bad)
            }
        }
    }
}

#[pymethods]
impl Task {
    /// The built-in task of this name, or the task file of this path, for its own robot or another one.
    ///
    /// Raises BadInput that names file, line, key, and what is accepted there.
    #[staticmethod]
    #[pyo3(signature = (name, robot = None))]
    fn load(name: &str, robot: Option<Py<Robot>>) -> PyResult<Self> {
        Self::named(name, robot.as_ref())
    }

    /// The task in a text of a task file. `name` is what errors and plans call it; `folder` is where the path of its robot is seen from.
    ///
    /// Raises BadInput as load does.
    #[staticmethod]
    #[pyo3(signature = (text, robot = None, *, name = "task", folder = PathBuf::new()))]
    fn from_toml(
        text: &str,
        robot: Option<Py<Robot>>,
        name: &str,
        folder: PathBuf,
    ) -> PyResult<Self> {
        let file = TaskFile::parse(Path::new(name), text).map_err(bad)?;
        Self::of(name, (file, folder), robot.as_ref())
    }

    /// Names of the built-in tasks.
    #[staticmethod]
    fn built_in() -> Vec<&'static str> {
        BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// Its name, or path.
    #[getter]
    fn name(&self) -> &str {
        &self.task.name
    }

    /// Who jumps.
    #[getter]
    fn robot(&self) -> Robot {
        Robot(self.task.robot)
    }

    /// Where the robot stands at the start, shape (19,).
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &of_configuration(&self.task.start))
    }

    /// Wanted displacement of the base, world axes, m, shape (3,).
    #[getter]
    fn goal<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &<[f64; 3]>::from(self.task.goal))
    }

    /// Wanted heading at the end: the angle about the world's z, rad.
    #[getter]
    fn heading(&self) -> f64 {
        self.task.heading
    }

    fn __repr__(&self) -> String {
        format!("Task({:?}, {:?})", self.task.name, self.task.robot.name)
    }
}
