//! A plan as arrays.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use jump_control::container::{Container, PlanNode};
use jump_lab::quadruped::Planned;
use jump_planner::audit::Audit;
use jump_planner::robot::State;
use jump_planner::stored::{Stored, open};
use jump_planner::task::Task as Wanted;
use jump_planner::{FOOT_COUNT, JOINTS, Kept, file};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::types::PyBytes;
use pyo3::{Bound, Py, PyAny, PyResult, Python, pyclass, pymethods};
use serde_json::json;

use crate::arrays::{List, Table, Tables, list, table, tables};
use crate::coordinates::{NQ, NV, of_configuration, of_tangent};
use crate::errors::{bad, failed};
use crate::json::object;
use crate::machine::Machine;
use crate::robot::Robot;
use crate::task::Task;

/// A plan that passed its audit: nodes from the posture in which the robot waits to the touchdown.
///
/// Arrays have one row per node, and are made anew at every access. Torques, forces and contacts hold from their node to the next. The first node, at a time below zero,
/// is the posture that waits.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Plan(
    pub(crate) Arc<Planned>,
    /// Where a plan like this one can begin.
    pub(crate) Option<Arc<Kept>>,
);

/// A node as it is stored.
type Node = PlanNode<JOINTS, FOOT_COUNT>;

impl Plan {
    /// The plan in these bytes.
    pub(crate) fn of(task: Wanted, bytes: &[u8], kept: Option<Kept>) -> PyResult<Self> {
        let robot = task.robot;
        Planned::open(&robot, bytes, |_| Ok::<_, String>(task))
            .map(|planned| Self(Arc::new(planned), kept.map(Arc::new)))
            .map_err(bad)
    }

    /// The container around the bytes.
    fn stored(&self) -> PyResult<Stored<'_>> {
        open(&self.0.reference.bytes, &self.0.task.robot).map_err(failed)
    }

    /// A row of every node.
    fn rows<'py, const K: usize>(
        &self,
        py: Python<'py>,
        row: impl Fn(&jump_planner::Node) -> [f64; K],
    ) -> PyResult<Table<'py>> {
        table(py, K, self.0.reference.nodes.iter().map(row))
    }
}

/// Which feet stand at a node.
fn contacts(plan: &Stored<'_>, node: &Node) -> [bool; FOOT_COUNT] {
    let phase = plan.header().phases.get(usize::from(node.phase));
    core::array::from_fn(|foot| phase.is_some_and(|phase| (phase.contacts >> foot) & 1 == 1))
}

#[pymethods]
impl Plan {
    /// The plan in a file that save or `saltus plan --plan` wrote. The task is found by the name in the plan; give it where that is none
    /// of the built-in ones.
    ///
    /// Raises BadInput where the file is no plan, damaged, or of another robot or task.
    #[staticmethod]
    #[pyo3(signature = (path, task = None))]
    fn load(py: Python<'_>, path: PathBuf, task: Option<Py<Task>>) -> PyResult<Self> {
        let named = |error: String| bad(format!("{}: {error}", path.display()));
        let bytes = file::read(&path).map_err(|error| named(file::told(&error)))?;
        let task = match task {
            Some(task) => task.get().task.clone(),
            None => {
                let plan: Stored<'_> =
                    Container::read(&bytes).map_err(|error| named(error.to_string()))?;
                Wanted::load(plan.header().task)
                    .map_err(|error| named(format!("{error}; or give the plan's task")))?
            }
        };
        Self::of(task, &bytes, None).map_err(|error| named(error.value(py).to_string()))
    }

    /// Writes the plan where `saltus run --plan`, `saltus verify`, C and firmware read it.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        fs::write(&path, &self.0.reference.bytes)
            .map_err(|error| bad(format!("{}: {}", path.display(), file::told(&error))))
    }

    /// What save writes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.reference.bytes)
    }

    /// What it is a plan of.
    #[getter]
    fn robot(&self) -> Robot {
        Robot(self.0.task.robot)
    }

    /// Name of its task.
    #[getter]
    fn task_name(&self) -> &str {
        &self.0.task.name
    }

    /// Checksum of its bytes.
    #[getter]
    fn crc32(&self) -> PyResult<u32> {
        Ok(self.stored()?.checksum())
    }

    /// When the last foot leaves the ground, s.
    #[getter]
    fn takeoff(&self) -> f64 {
        self.0.reference.takeoff
    }

    /// From when on the legs are in their landing posture, s.
    #[getter]
    fn posing(&self) -> f64 {
        self.0.reference.posing
    }

    /// When it expects the ground, s.
    #[getter]
    fn touchdown(&self) -> f64 {
        self.0.reference.touchdown
    }

    /// Durations of the contact phases, s.
    #[getter]
    fn durations<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.reference.durations)
    }

    /// Joints in which the robot waits for the ground, rad, shape (12,).
    #[getter]
    fn landing_joints<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.reference.landing_joints)
    }

    /// Times of the nodes, s, shape (n,).
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> List<'py> {
        let nodes = self.0.reference.nodes.iter();
        PyArray1::from_iter(py, nodes.map(|node| node.time))
    }

    /// Configurations, shape (n, 19), as Robot tells.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NQ>(py, |node| {
            of_configuration(&State {
                base: node.base,
                joints: node.joints,
            })
        })
    }

    /// Velocities, shape (n, 18), as Robot tells.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NV>(py, |node| of_tangent(&jump_planner::state(node).1))
    }

    /// Torques, N m, shape (n, 12).
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<JOINTS>(py, |node| node.torques)
    }

    /// Forces of the ground on the feet, world axes, N, shape (n, 4, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        let forces = self.0.reference.nodes.iter().flat_map(|node| node.forces_w);
        let numbers = forces.flat_map(<[f64; 3]>::from);
        tables(py, [FOOT_COUNT, 3], numbers.collect())
    }

    /// Which feet stand, shape (n, 4).
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let plan = self.stored()?;
        let all: Vec<bool> = plan
            .nodes()
            .flat_map(|node| contacts(&plan, &node))
            .collect();
        PyArray1::from_vec(py, all).reshape([plan.count(), FOOT_COUNT])
    }

    /// Audits the plan anew: moves the robot by forward dynamics under the plan's torques and looks at every limit in every 0.1 ms.
    ///
    /// A dictionary: "passes", "complaint", errors of the flight, saturation, and "margins", the worst first.
    fn audit<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (plan, robot) = (self.stored()?, &self.0.task.robot);
        let audit = py.detach(|| Audit::of(robot, &plan)).map_err(failed)?;
        let mut details = audit.details(robot);
        details["passes"] = json!(audit.passes());
        details["complaint"] = json!(audit.complaint());
        object(py, &details)
    }

    /// The machine that flies this plan, armed: it holds the first node until the time `start`, s, on the clock of its ticks.
    #[pyo3(signature = (start = 0.0))]
    fn machine(&self, start: f64) -> PyResult<Machine> {
        Machine::flying(&self.0, start)
    }

    fn __len__(&self) -> usize {
        self.0.reference.nodes.len()
    }

    fn __repr__(&self) -> String {
        let reference = &self.0.reference;
        format!(
            "Plan({:?}, {:?}, takeoff {:.3} s, touchdown {:.3} s)",
            self.0.task.name, self.0.task.robot.name, reference.takeoff, reference.touchdown
        )
    }
}
