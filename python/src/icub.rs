//! iCub's jump on the spot, paper B's: simulated, and the verdict on it.

use jump_lab::humanoid::execute::{self, Run};
use jump_lab::humanoid::judge::Judged;
use jump_lab::humanoid::log::Sample;
use jump_lab::humanoid::{JOINTS, Landing, ROBOT, Task};
use jump_lab::lab::{Lab, PlantArgument};
use numpy::PyArray1;
use pyo3::{Bound, PyAny, PyResult, Python, pyclass, pyfunction, pymethods};
use rbd_core::convert::base_to_pinocchio;
use rbd_core::{Model, Transform};

use crate::arrays::{List, Table, Tables, list, table, tables};
use crate::coordinates::joined;
use crate::errors::{bad, failed};
use crate::json::object;
use crate::run::{named, plant, simulator};

/// Numbers of a configuration.
const NQ: usize = 7 + JOINTS;
/// Numbers of a velocity.
const NV: usize = 6 + JOINTS;

/// iCub jumps on the spot in a simulator, lands, and is judged two seconds later. Takes some seconds, in which other threads of Python run;
/// Ctrl-C is heard after it.
///
/// `level` is of the push-off's program: "velocity" or "torque". `height` is what the centre of mass gains in flight, m; with `momentum`
/// the angular momentum is controlled; `torque_share` is how much of the joints' torque limits there is, above 0 and up to 1; `landing`
/// is "qp", one torque program through flight and landing, "hold", servos, or "stiff", the paper's own. `seed` and `plant` are as in
/// `run`, drawn from iCub's lab; `sim` is as there.
///
/// Raises BadInput that names the argument, and Error where the controller refuses the jump.
#[pyfunction]
#[pyo3(signature = (level = "torque", *, height = 0.04, momentum = true, torque_share = 1.0, landing = "qp", sim = "native", seed = 0, plant = None))]
#[allow(
    clippy::too_many_arguments,
    reason = "they are the options of the command, and Python names its arguments"
)]
pub(crate) fn run_icub(
    py: Python<'_>,
    level: &str,
    height: f64,
    momentum: bool,
    torque_share: f64,
    landing: &str,
    sim: &str,
    seed: u64,
    plant: Option<&str>,
) -> PyResult<IcubRecord> {
    let task = Task::named(&format!("icub/{level}"))
        .ok_or_else(|| bad(format!("level: must be velocity or torque, not `{level}`")))?;
    let task = Task {
        height,
        momentum,
        torque_share,
        landing: named::<Landing>("landing", landing)?,
        ..task
    };
    task.check().map_err(bad)?;
    let (sim, given) = (simulator(sim)?, self::plant(plant)?);
    let disturbance = PlantArgument::plant(given.as_ref(), Lab::Icub, seed);
    let run = py.detach(|| execute::run(&task, sim, &disturbance, seed, |_, _| {}));
    py.check_signals()?;
    let run = run.map_err(failed)?;
    let judged = Judged::of(&task, &run);
    Ok(IcubRecord { task, run, judged })
}

/// A run of iCub: one row per millisecond, and the verdict. Arrays are made anew at every access.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct IcubRecord {
    task: Task,
    run: Run,
    judged: Judged,
}

impl IcubRecord {
    /// A row of every sample.
    fn rows<'py, const K: usize>(
        &self,
        py: Python<'py>,
        row: impl Fn(&Sample) -> [f64; K],
    ) -> PyResult<Table<'py>> {
        table(py, K, self.run.samples.iter().map(row))
    }

    /// A number of every sample.
    fn column<'py>(&self, py: Python<'py>, number: impl Fn(&Sample) -> f64) -> List<'py> {
        PyArray1::from_iter(py, self.run.samples.iter().map(number))
    }
}

#[pymethods]
impl IcubRecord {
    /// Names of the joints, as q and tau have them, 23 of them.
    #[getter]
    fn joint_names(&self) -> Vec<&'static str> {
        Model::<f64, JOINTS>::joint_names(&ROBOT).to_vec()
    }

    /// Largest torques, N m, shape (23,): the share of the motors' that there was.
    #[getter]
    fn torque_limits<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.task.motors().map(|motor| motor.torque))
    }

    /// Times since the push-off began, s, shape (n,): negative before.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> List<'py> {
        self.column(py, |s| s.time)
    }

    /// Phases of the machine, n of them.
    #[getter]
    fn phases(&self) -> Vec<String> {
        let samples = self.run.samples.iter();
        samples.map(|s| format!("{:?}", s.phase)).collect()
    }

    /// Configurations, shape (n, 30): p, quaternion x y z w, joints.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NQ>(py, |s| {
            let rotation = s.orientation.to_rotation_matrix();
            let base = Transform::new(rotation, s.position);
            joined(&base_to_pinocchio(&base), &s.joints)
        })
    }

    /// Velocities, shape (n, 29): ṗ and ω in base axes, joints.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NV>(py, |s| {
            joined(&s.base_velocity.to_array(), &s.joint_velocities)
        })
    }

    /// Centre of mass in the world, m, shape (n, 3).
    #[getter]
    fn com<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<3>(py, |s| s.com.into())
    }

    /// Its velocity, world axes, m/s, shape (n, 3).
    #[getter]
    fn com_velocity<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<3>(py, |s| s.com_velocity.into())
    }

    /// Height of the centre of mass that the push-off's profile asks for, m, shape (n,).
    #[getter]
    fn planned_height<'py>(&self, py: Python<'py>) -> List<'py> {
        self.column(py, |s| s.wanted_height)
    }

    /// Angular momentum about the centre of mass, world axes, kg m²/s, shape (n, 3).
    #[getter]
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<3>(py, |s| s.momentum.into())
    }

    /// What the motors gave, N m, shape (n, 23).
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<JOINTS>(py, |s| s.torques)
    }

    /// Forces of the ground on the left and the right sole, world axes, N, shape (n, 2, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        let forces = self.run.samples.iter().flat_map(|s| s.forces_w);
        let numbers = forces.flat_map(<[f64; 3]>::from);
        tables(py, [2, 3], numbers.collect())
    }

    /// Height of the lowest corner of both soles, m, shape (n,).
    #[getter]
    fn clearance<'py>(&self, py: Python<'py>) -> List<'py> {
        self.column(py, |s| s.clearance)
    }

    /// The planned take-off, s.
    #[getter]
    fn takeoff(&self) -> f64 {
        self.run.takeoff
    }

    /// When both soles had left the ground, s.
    #[getter]
    fn contact_loss(&self) -> Option<f64> {
        self.run.contact_loss
    }

    /// When one touched it again, s.
    #[getter]
    fn touchdown(&self) -> Option<f64> {
        self.run.touchdown
    }

    /// What the centre of mass gained in flight, m.
    #[getter]
    fn com_gain(&self) -> f64 {
        self.judged.com_gain
    }

    /// Change of the base's pitch in flight, degrees.
    #[getter]
    fn pitch_change_deg(&self) -> f64 {
        self.judged.pitch_change
    }

    /// Whether nothing failed.
    #[getter]
    fn on_target(&self) -> bool {
        self.judged.verdict.on_target()
    }

    /// "target", or what failed first.
    #[getter]
    fn outcome(&self) -> &str {
        self.judged.verdict.outcome()
    }

    /// The verdict for people.
    #[getter]
    fn summary(&self) -> String {
        self.judged.verdict.first()
    }

    /// The verdict as a dictionary: "flight", "stand", "hardware", and "failures", first things first.
    #[getter]
    fn verdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.judged.verdict.json())
    }

    /// Whether the robot stands on its soles in the end.
    #[getter]
    fn stands(&self) -> bool {
        self.judged.upright
    }

    fn __len__(&self) -> usize {
        self.run.samples.len()
    }

    fn __repr__(&self) -> String {
        format!("IcubRecord({:?})", self.judged.verdict.first())
    }
}
