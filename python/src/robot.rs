//! A quadruped and its dynamics.

use std::path::PathBuf;

use jump_planner::JOINTS;
use jump_planner::robot::{Quadruped, State};
use pyo3::{PyResult, Python, pyclass, pymethods};
use rbd_core::{
    AbaWorkspace, JointLimits, MassMatrix, Model, Posture, Transform, aba, crba, difference,
    integrate, rnea,
};

use crate::arrays::{List, Numbers, Table, Tables, list, table, tables};
use crate::coordinates::{
    NQ, NV, configuration, effort, of_configuration, of_effort, of_tangent, tangent,
};
use crate::errors::bad;

/// A quadruped: a floating base and four legs of three joints. Leg i has joints 3 i to 3 i + 2, from the trunk down.
///
/// Coordinates are Pinocchio's, SI units throughout:
///
/// - q, shape (19,): position of the base in the world, m; its quaternion x, y, z, w; joints, rad.
/// - v, shape (18,): linear, then angular velocity of the base, both in base axes, m/s and rad/s; joints, rad/s.
/// - tau, shape (18,): force and moment on the base in base axes, N and N m; torques, N m.
///
/// Tables of a robot that was loaded stay in memory until the program ends.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Robot(pub(crate) Quadruped);

impl Robot {
    /// One number of every joint's limits.
    fn limits<'py>(&self, py: Python<'py>, of: impl Fn(&JointLimits<f64>) -> f64) -> List<'py> {
        let limits: &[JointLimits<f64>; JOINTS] = Model::limits(&self.0);
        list(py, &limits.each_ref().map(of))
    }
}

#[pymethods]
impl Robot {
    /// Unitree's A1 with its rotors, as it is built in.
    #[staticmethod]
    fn a1() -> PyResult<Self> {
        Quadruped::a1().map(Self).map_err(bad)
    }

    /// The robot of a URDF, or of a profile (.toml) that names one. `lock` are joints that do not move, as "JOINT=RAD".
    ///
    /// Raises BadInput that names what is missing or cannot be, and where.
    #[staticmethod]
    #[pyo3(signature = (path, lock = Vec::new()))]
    fn load(path: PathBuf, lock: Vec<String>) -> PyResult<Self> {
        let robot = Quadruped::load(&path, &lock);
        robot
            .map(Self)
            .map_err(|error| bad(format!("{}: {error}", path.display())))
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &'static str {
        self.0.name
    }

    /// Numbers of a configuration.
    #[getter]
    fn nq(&self) -> usize {
        NQ
    }

    /// Numbers of a velocity.
    #[getter]
    fn nv(&self) -> usize {
        NV
    }

    /// Names of the joints as in its URDF, in the order of q and v.
    #[getter]
    fn joint_names(&self) -> [&'static str; JOINTS] {
        *Model::<f64, JOINTS>::joint_names(&self.0)
    }

    /// Places of the feet, FL, FR, RL and RR, in the order of its legs.
    #[getter]
    fn foot_names(&self) -> [&'static str; 4] {
        core::array::from_fn(|leg| self.0.place(leg))
    }

    /// Mass, kg.
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass()
    }

    /// Length of a stretched leg from its second joint to the foot, m.
    #[getter]
    fn leg_length(&self) -> f64 {
        self.0.leg_length
    }

    /// Radius of the balls of the feet, m.
    #[getter]
    fn foot_radius(&self) -> f64 {
        self.0.foot_radius
    }

    /// Least joint positions, rad, shape (12,).
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.lower)
    }

    /// Largest joint positions, rad, shape (12,).
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.upper)
    }

    /// Largest torques, N m, shape (12,).
    #[getter]
    fn max_torque<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.effort)
    }

    /// Largest joint speeds, rad/s, shape (12,).
    #[getter]
    fn max_speed<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.speed)
    }

    /// Viscous friction of the joints, N m s/rad, shape (12,).
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.damping)
    }

    /// Coulomb friction of the joints, N m, shape (12,).
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> List<'py> {
        self.limits(py, |limit| limit.friction)
    }

    /// Inertia of the rotors as the joints feel it, kg m², shape (12,): what simulators call armature.
    #[getter]
    fn armature<'py>(&self, py: Python<'py>) -> List<'py> {
        let bodies = rbd_core::Tree::<f64, JOINTS>::bodies(&self.0);
        list(py, &bodies.each_ref().map(|body| body.rotor_inertia))
    }

    /// Limits that no motor has, in words: placeholders of the URDF, with which a plan may promise what the robot cannot do.
    #[getter]
    fn placeholders(&self) -> Vec<String> {
        self.0.placeholders()
    }

    /// A configuration, shape (19,), with the base at the origin and the legs near a standing posture.
    fn neutral<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &of_configuration(&self.0.near(Transform::IDENTITY)))
    }

    /// Inverse dynamics: tau, shape (18,), with which the robot accelerates by `a`, shape (18,): the derivative of v.
    fn rnea<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        v: Numbers<'py>,
        a: Numbers<'py>,
    ) -> PyResult<List<'py>> {
        let posture = Posture::new(&self.0, &configuration("q", &q)?);
        let tau = rnea(&self.0, &posture, &tangent("v", &v)?, &tangent("a", &a)?);
        Ok(list(py, &of_effort(&tau)))
    }

    /// Mass matrix M, shape (18, 18), symmetric: rnea(q, v, a) = M a + rnea(q, v, 0).
    fn crba<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> PyResult<Table<'py>> {
        let mut mass = MassMatrix::ZERO;
        crba(
            &self.0,
            &Posture::new(&self.0, &configuration("q", &q)?),
            &mut mass,
        );
        let dense = mass.to_dense::<NV>();
        table(
            py,
            NV,
            (0..NV).map(|i| dense.row(i).into_owned().data.0.concat()),
        )
    }

    /// Forward dynamics: the acceleration, shape (18,), under `tau`, shape (18,): the way back from rnea.
    fn aba<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        v: Numbers<'py>,
        tau: Numbers<'py>,
    ) -> PyResult<List<'py>> {
        let posture = Posture::new(&self.0, &configuration("q", &q)?);
        let (v, tau) = (tangent("v", &v)?, effort("tau", &tau)?);
        let a = aba(&self.0, &posture, &v, &tau, &mut AbaWorkspace::new());
        Ok(list(py, &of_tangent(&a)))
    }

    /// Centre of mass in the world, m, shape (3,).
    fn com<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> PyResult<List<'py>> {
        let com_w: [f64; 3] = self.0.com(&configuration("q", &q)?).into();
        Ok(list(py, &com_w))
    }

    /// Centres of the balls of the feet in the world, m, shape (4, 3).
    fn feet<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> PyResult<Table<'py>> {
        let poses = self.0.poses(&configuration("q", &q)?);
        let feet = self.0.feet.iter();
        let places = feet.map(|foot| <[f64; 3]>::from(poses.frame(foot).translation));
        table(py, 3, places)
    }

    /// Jacobians of the centres of the feet, shape (4, 6, 18): times v, linear then angular velocity of each foot in world axes
    /// (Pinocchio's LOCAL_WORLD_ALIGNED), m/s and rad/s.
    fn foot_jacobians<'py>(&self, py: Python<'py>, q: Numbers<'py>) -> PyResult<Tables<'py>> {
        let poses = self.0.poses(&configuration("q", &q)?);
        let dense = |foot| self.0.jacobian(&poses, foot).to_dense::<NV>().transpose();
        // Columns of the transposed are rows.
        let all = self
            .0
            .feet
            .iter()
            .flat_map(|foot| dense(foot).data.0.concat());
        tables(py, [6, NV], all.collect())
    }

    /// Where a constant velocity `v`, shape (18,), leads from `q` in unit time, shape (19,).
    fn integrate<'py>(
        &self,
        py: Python<'py>,
        q: Numbers<'py>,
        v: Numbers<'py>,
    ) -> PyResult<List<'py>> {
        let there = integrate(&configuration("q", &q)?, &tangent("v", &v)?);
        Ok(list(py, &of_configuration(&there)))
    }

    /// The constant velocity, shape (18,), that leads from `q0` to `q1` in unit time: the way back from integrate.
    fn difference<'py>(
        &self,
        py: Python<'py>,
        q0: Numbers<'py>,
        q1: Numbers<'py>,
    ) -> PyResult<List<'py>> {
        let (from, to): (State, State) = (configuration("q0", &q0)?, configuration("q1", &q1)?);
        Ok(list(py, &of_tangent(&difference(&from, &to))))
    }

    fn __repr__(&self) -> String {
        format!("Robot({:?}, {:.3} kg)", self.0.name, self.0.mass())
    }
}
