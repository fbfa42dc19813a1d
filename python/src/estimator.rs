//! The base from an IMU and the legs.

use jump_control::Measurement;
use jump_lab::quadruped::Observed;
use jump_planner::robot::{Quadruped, State};
use jump_planner::{FOOT_COUNT, JOINTS};
use pyo3::{Py, PyResult, Python, pyclass, pymethods};
use rbd_core::Transform;
use rbd_core::convert::base_from_pinocchio;
use state_est::{Estimate, Foot, Sample, Settings, Status};

use crate::arrays::{List, Numbers, list, vector};
use crate::coordinates::configuration;
use crate::errors::bad;
use crate::observation::Observation;
use crate::robot::Robot;

/// Its unknowns: place, velocity, and the feet.
const UNKNOWNS: usize = FOOT_COUNT + 2;

/// Estimates where the base is from an IMU, encoders and foot sensors, through flight and impact, at 1 kHz.
///
/// Estimator(robot, q, *, imu=(0, 0, 0, 0, 0, 0, 1), loaded=15.0): the robot stands still at `q`, shape (19,). `imu` is the pose of the
/// IMU in the base, position then quaternion x, y, z, w; `loaded` the force at which a foot certainly stands, N.
#[pyclass(module = "saltus")]
pub(crate) struct Estimator {
    robot: Quadruped,
    estimator: state_est::Estimator<f64, JOINTS, FOOT_COUNT, UNKNOWNS>,
    state: state_est::State<f64, FOOT_COUNT, UNKNOWNS>,
    loaded: f64,
    last: Option<Estimate<f64, FOOT_COUNT>>,
}

#[pymethods]
impl Estimator {
    #[new]
    #[pyo3(signature = (robot, q, *, imu = None, loaded = 15.0))]
    fn new(
        robot: Py<Robot>,
        q: Numbers<'_>,
        imu: Option<Numbers<'_>>,
        loaded: f64,
    ) -> PyResult<Self> {
        let robot = robot.get().0;
        let start: State = configuration("q", &q)?;
        let imu = match imu {
            None => Transform::IDENTITY,
            Some(pose) => base_from_pinocchio(&vector::<7>("imu", &pose)?)
                .map_err(|error| bad(format!("imu[3:7]: {error}")))?,
        };
        if !(loaded > 0.0 && loaded.is_finite()) {
            return Err(bad(format!("loaded: must be above 0, not {loaded}")));
        }
        let estimator = state_est::Estimator {
            feet: robot.feet.map(|frame| Foot {
                frame,
                radius: robot.foot_radius,
            }),
            imu,
            settings: Settings::new(),
        };
        Ok(Self {
            state: state_est::State::new(&estimator, &robot, &start),
            robot,
            estimator,
            loaded,
            last: None,
        })
    }

    /// One step of `dt` seconds, and what the machine is to be told of it.
    ///
    /// `specific_force`, shape (3,), is what the accelerometer says, IMU axes, m/s²: at rest it points up; `angular_velocity`, shape (3,), the
    /// gyroscope, rad/s; `joints` and `joint_velocities` the encoders, shape (12,); `foot_forces` on the feet, N, shape (4,);
    /// `joint_torques` the mean torques of the joints since the last step, friction included, N m, shape (12,).
    #[pyo3(signature = (specific_force, angular_velocity, joints, joint_velocities, foot_forces, joint_torques, dt = 1e-3))]
    #[allow(
        clippy::too_many_arguments,
        reason = "a robot has so many sensors, and Python names its arguments"
    )]
    fn step(
        &mut self,
        specific_force: Numbers<'_>,
        angular_velocity: Numbers<'_>,
        joints: Numbers<'_>,
        joint_velocities: Numbers<'_>,
        foot_forces: Numbers<'_>,
        joint_torques: Numbers<'_>,
        dt: f64,
    ) -> PyResult<Observation> {
        let foot_forces: [f64; FOOT_COUNT] = vector("foot_forces", &foot_forces)?;
        let sample = Sample {
            specific_force_i: vector::<3>("specific_force", &specific_force)?.into(),
            angular_velocity_i: vector::<3>("angular_velocity", &angular_velocity)?.into(),
            joints: vector("joints", &joints)?,
            joint_velocities: vector("joint_velocities", &joint_velocities)?,
            evidence: foot_forces.map(|force| (force / self.loaded).clamp(0.0, 1.0)),
        };
        let joint_torques = vector("joint_torques", &joint_torques)?;
        let estimate = self
            .estimator
            .step(&self.robot, &mut self.state, Some(&sample), dt);
        self.last = Some(estimate);
        let lost = estimate.status == Status::Lost;
        Ok(Observation(Observed {
            measured: Measurement {
                base: estimate.base,
                base_velocity: estimate.velocity,
                joints: sample.joints,
                joint_velocities: sample.joint_velocities,
                foot_forces,
                age: if lost { f64::INFINITY } else { 0.0 },
            },
            joint_torques,
        }))
    }

    /// One step of `dt` seconds in which nothing arrived: the estimate coasts for 20 ms, then it is lost.
    #[pyo3(signature = (dt = 1e-3))]
    fn coast(&mut self, dt: f64) {
        let estimate = self.estimator.step(&self.robot, &mut self.state, None, dt);
        self.last = Some(estimate);
    }

    /// How sure the last step was that each foot stands, 0 to 1, shape (4,).
    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> List<'py> {
        let none = [0.0; FOOT_COUNT];
        list(py, &self.last.map_or(none, |last| last.confidence))
    }

    /// "Good", "Coasting" or "Lost".
    #[getter]
    fn status(&self) -> String {
        let status = self.last.map_or(Status::Good, |last| last.status);
        format!("{status:?}")
    }

    /// The first thing that was wrong with the last sample.
    #[getter]
    fn fault(&self) -> Option<String> {
        let fault = self.last.and_then(|last| last.fault);
        fault.map(|fault| fault.to_string())
    }
}
