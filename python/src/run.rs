//! A simulated run of a plan, and the verdict on it.

use core::str::FromStr;

use jump_control::Phase;
use jump_lab::Sim;
use jump_lab::lab::{Interface, Lab, PlantArgument};
use jump_lab::quadruped::Planned;
use jump_lab::quadruped::execute::{Run, Trial};
use jump_lab::quadruped::judge::Judged;
use jump_lab::quadruped::log::Sample;
use jump_lab::quadruped::measure::Measure;
use jump_planner::robot::State;
use jump_planner::{FOOT_COUNT, JOINTS, Velocity};
use numpy::PyArray1;
use pyo3::{Bound, Py, PyAny, PyResult, Python, pyclass, pyfunction, pymethods};
use rbd_core::{Motion, Transform};

use crate::arrays::{List, Table, Tables, table, tables};
use crate::coordinates::{NQ, NV, of_configuration, of_tangent};
use crate::errors::{bad, failed};
use crate::json::object;
use crate::mujoco::compile;
use crate::plan::Plan;

/// What differs from the plan in a run, and how its motors are commanded.
pub(crate) struct Conditions {
    pub(crate) sim: Sim,
    pub(crate) plant: Option<PlantArgument>,
    pub(crate) interface: Interface,
    pub(crate) without: Vec<Measure>,
}

/// A value by its name, with the argument's in front of what is wrong with it.
pub(crate) fn named<T: FromStr<Err = String>>(argument: &str, name: &str) -> PyResult<T> {
    name.parse()
        .map_err(|error| bad(format!("{argument}: {error}")))
}

/// A simulator by its name that is there: MuJoCo is that of Python's package.
pub(crate) fn simulator(name: &str) -> PyResult<Sim> {
    let sim = match named("sim", name)? {
        Sim::Mujoco(_) => Sim::Mujoco(compile),
        native @ Sim::Native => native,
    };
    sim.check().map_err(|error| bad(format!("sim: {error}")))?;
    Ok(sim)
}

/// What differs from the plan, by what the command line would take.
pub(crate) fn plant(text: Option<&str>) -> PyResult<Option<PlantArgument>> {
    text.map(|text| named("plant", text)).transpose()
}

impl Conditions {
    /// From what the command line would take.
    pub(crate) fn read(
        sim: &str,
        plant: Option<&str>,
        interface: &str,
        without: &[String],
    ) -> PyResult<Self> {
        let without = without.iter().map(|name| named("without", name));
        Ok(Self {
            sim: simulator(sim)?,
            plant: self::plant(plant)?,
            interface: named("interface", interface)?,
            without: without.collect::<PyResult<_>>()?,
        })
    }
}

/// Flies a plan in a simulator, from standing to two seconds after its touchdown, and judges the run. Takes about a second, in which other
/// threads of Python run; Ctrl-C is heard after it.
///
/// `seed` 0 is the nominal run; any other draws a lab that differs from the plan, as `saltus run --seed` does. `plant` says what differs
/// instead, as `--plant` does ("mass=0.9,ground=soft"); `interface` is "torque", "joint-pd" or "joint-pd@500"; `without` are measures of
/// the controller to do without. `sim` is "native" or "mujoco", the MuJoCo that the package `mujoco` has (`pip install mujoco`, 3.2.7 or
/// newer), in which a run takes twice as long (`python python/examples/costs.py`); its error in a step goes to sys.unraisablehook, and
/// this raises Error.
///
/// Raises BadInput that names the argument, and Error where the machine refuses the plan or MuJoCo the robot.
#[pyfunction]
#[pyo3(signature = (plan, *, sim = "native", seed = 0, plant = None, interface = "torque", without = Vec::new()))]
pub(crate) fn run(
    py: Python<'_>,
    plan: Py<Plan>,
    sim: &str,
    seed: u64,
    plant: Option<&str>,
    interface: &str,
    without: Vec<String>,
) -> PyResult<Record> {
    let conditions = Conditions::read(sim, plant, interface, &without)?;
    let planned = plan.get().0.clone();
    let trial = Trial {
        sim: conditions.sim,
        disturbance: PlantArgument::plant(conditions.plant.as_ref(), Lab::A1, seed),
        seed,
        interface: conditions.interface,
        without: &conditions.without,
    };
    let record = py.detach(|| Record::of(&planned, trial));
    py.check_signals()?;
    record.map_err(failed)
}

/// A run: one row per millisecond, and the verdict. Arrays are made anew at every access.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Record {
    run: Run,
    judged: Judged,
}

impl Record {
    fn of(planned: &Planned, trial: Trial<'_>) -> Result<Self, String> {
        let run = planned.run(trial)?;
        let judged = planned.judge(&run);
        Ok(Self { run, judged })
    }

    /// A row of every sample.
    fn rows<'py, const K: usize>(
        &self,
        py: Python<'py>,
        row: impl Fn(&Sample) -> [f64; K],
    ) -> PyResult<Table<'py>> {
        table(py, K, self.run.samples.iter().map(row))
    }
}

#[pymethods]
impl Record {
    /// Times of the plan, s, shape (n,): negative before the push-off.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> List<'py> {
        PyArray1::from_iter(py, self.run.samples.iter().map(|sample| sample.time))
    }

    /// Phases of the machine, as Machine.phase, n of them.
    #[getter]
    fn phases(&self) -> Vec<String> {
        let samples = self.run.samples.iter();
        samples
            .map(|sample| format!("{:?}", sample.phase))
            .collect()
    }

    /// Configurations, shape (n, 19), as Robot tells.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NQ>(py, |s| {
            let rotation = s.orientation.to_rotation_matrix();
            of_configuration(&State {
                base: Transform::new(rotation, s.position),
                joints: s.joints,
            })
        })
    }

    /// Velocities, shape (n, 18), as Robot tells.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<NV>(py, |s| {
            of_tangent(&Velocity {
                base: Motion::new(s.orientation.inverse() * s.velocity_w, s.omega_b),
                joints: s.joint_velocities,
            })
        })
    }

    /// Centre of mass in the world, m, shape (n, 3).
    #[getter]
    fn com<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<3>(py, |s| s.com.into())
    }

    /// What the motors gave, N m, shape (n, 12).
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<JOINTS>(py, |s| s.torques)
    }

    /// Forces of the ground on the feet, world axes, N, shape (n, 4, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        let feet = |s: &Sample| s.forces_w.into_iter().take(FOOT_COUNT);
        let forces = self.run.samples.iter().flat_map(feet);
        let numbers = forces.flat_map(<[f64; 3]>::from);
        tables(py, [FOOT_COUNT, 3], numbers.collect())
    }

    /// Joints of the plan at the same times, rad, shape (n, 12).
    #[getter]
    fn planned_joints<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        self.rows::<JOINTS>(py, |s| s.planned_joints)
    }

    /// Whether nothing failed.
    #[getter]
    fn on_target(&self) -> bool {
        self.judged.verdict.on_target()
    }

    /// "target", or what failed first, such as "stand.feet_m".
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

    /// When a foot touched the ground after the flight, s.
    #[getter]
    fn touchdown(&self) -> Option<f64> {
        self.run.first_contact
    }

    /// Why the machine gave up, where it did.
    #[getter]
    fn fault(&self) -> Option<String> {
        self.run.fault.map(|fault| fault.to_string())
    }

    /// Whether the robot stands on its feet in the end.
    #[getter]
    fn stands(&self) -> bool {
        self.judged.verdict.stands() && self.run.final_phase != Phase::Abort
    }

    fn __len__(&self) -> usize {
        self.run.samples.len()
    }

    fn __repr__(&self) -> String {
        format!("Record({:?})", self.judged.verdict.first())
    }
}
