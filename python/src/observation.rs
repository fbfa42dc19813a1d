//! What the machine is told.

use jump_control::Measurement;
use jump_lab::quadruped::Observed;
use jump_planner::robot::State;
use jump_planner::{FOOT_COUNT, JOINTS};
use pyo3::{PyResult, Python, pyclass, pymethods};

use crate::arrays::{List, Numbers, list, vector};
use crate::coordinates::{measured, of_configuration, of_tangent, tangent};

/// What the machine is told in one tick.
///
/// Observation(q, v, foot_forces, joint_torques, age=0.0): where the robot is and how it moves, shapes (19,) and (18,) as Robot tells;
/// normal forces on the feet, N, shape (4,); mean torques of the joints since the last tick, friction included, N m, shape (12,); and the
/// age of the oldest of these numbers, s. An Estimator makes one from sensors. Numbers that are none are the machine's to find.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Observation(pub(crate) Observed);

#[pymethods]
impl Observation {
    #[new]
    #[pyo3(signature = (q, v, foot_forces, joint_torques, age = 0.0))]
    fn new(
        q: Numbers<'_>,
        v: Numbers<'_>,
        foot_forces: Numbers<'_>,
        joint_torques: Numbers<'_>,
        age: f64,
    ) -> PyResult<Self> {
        let (q, v): (State, _) = (measured("q", &q)?, tangent("v", &v)?);
        Ok(Self(Observed {
            measured: Measurement {
                base: q.base,
                base_velocity: v.base,
                joints: q.joints,
                joint_velocities: v.joints,
                foot_forces: vector::<FOOT_COUNT>("foot_forces", &foot_forces)?,
                age,
            },
            joint_torques: vector::<JOINTS>("joint_torques", &joint_torques)?,
        }))
    }

    /// Where the robot is, shape (19,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &of_configuration(&self.0.measured.configuration()))
    }

    /// How it moves, shape (18,).
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &of_tangent(&self.0.measured.velocity()))
    }

    /// Normal forces on the feet, N, shape (4,).
    #[getter]
    fn foot_forces<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.measured.foot_forces)
    }

    /// Mean torques since the last tick, N m, shape (12,).
    #[getter]
    fn joint_torques<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.joint_torques)
    }

    /// Age of the oldest number, s.
    #[getter]
    fn age(&self) -> f64 {
        self.0.measured.age
    }
}
