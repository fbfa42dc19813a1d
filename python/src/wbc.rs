//! Whole-body control of a quadruped: tasks, and the program on torques.

use jump_planner::robot::Quadruped;
use jump_planner::{FOOT_COUNT as LEGS, JOINTS};
use nalgebra::Vector3;
use pyo3::types::PyAnyMethods;
use pyo3::{Bound, Py, PyAny, PyResult, Python, pyclass, pymethods};
use rbd_core::{Frame, Model, joint_friction};
use wbc_qp::{Contact, Extent, Gains, Horizon, Limit, Limited, Rank, Side, Snapshot, Task};

use crate::arrays::{List, Numbers, Table, list, matrix, numbers, table, vector};
use crate::coordinates::{NV, configuration, effort_of, of_effort, of_tangent, tangent};
use crate::errors::{bad, failed};
use crate::robot::Robot;

/// Force coordinates: every foot is a ball.
const FORCES: usize = 3 * LEGS;
/// Rows with slack that there is room for.
const SLACKS: usize = 8;
/// Variables, and rows: of contacts, of friction, of torques, and the user's.
const VARIABLES: usize = JOINTS + FORCES + SLACKS;
const ROWS: usize = FORCES + 4 * LEGS + JOINTS + 24;
/// Speed over which a joint's friction changes its sign, rad/s.
const STICTION: f64 = 0.1;

type Program = wbc_qp::TorqueQp<f64, JOINTS, FORCES, VARIABLES, ROWS>;
type Row = Task<f64, JOINTS, 1>;

/// Rows that are linear in a robot's motion: rate J v and acceleration J a + drift, of up to as many coordinates as one likes.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct WbTask(Vec<Row>);

impl WbTask {
    /// The rows of a task, one by one.
    fn of<const R: usize>(task: &Task<f64, JOINTS, R>) -> Self {
        Self((0..R).map(|i| task.select([i])).collect())
    }

    /// As many numbers as there are rows.
    fn numbers(&self, name: &str, x: &Numbers<'_>) -> PyResult<Vec<f64>> {
        numbers(name, x, self.0.len())
    }
}

#[pymethods]
impl WbTask {
    /// A task of one's own: `jacobian` J, shape (k, 18), over v as Robot tells; `drift`, the time derivative of J times v, and `rate`, J v,
    /// shape (k,), both zero where they are not given.
    #[new]
    #[pyo3(signature = (jacobian, drift = None, rate = None))]
    fn new(
        jacobian: Numbers<'_>,
        drift: Option<Numbers<'_>>,
        rate: Option<Numbers<'_>>,
    ) -> PyResult<Self> {
        let count = jacobian.as_array().shape().first().copied().unwrap_or(0);
        let rows = matrix("jacobian", &jacobian, [count, NV])?;
        let given = |name: &str, x: Option<Numbers<'_>>| {
            x.map_or_else(|| Ok(vec![0.0; count]), |x| numbers(name, &x, count))
        };
        let (drift, rate) = (given("drift", drift)?, given("rate", rate)?);
        let rows = rows.chunks(NV).zip(drift.iter().zip(&rate));
        Ok(Self(
            rows.map(|(row, (drift, rate))| Task {
                jacobian: [effort_of(row)],
                drift: [*drift],
                rate: [*rate],
            })
            .collect(),
        ))
    }

    /// J, shape (k, 18).
    #[getter]
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        let rows = self.0.iter();
        table(py, NV, rows.map(|row| of_effort(&row.jacobian[0])))
    }

    /// Its time derivative times v, shape (k,).
    #[getter]
    fn drift<'py>(&self, py: Python<'py>) -> List<'py> {
        list(
            py,
            &self.0.iter().map(|row| row.drift[0]).collect::<Vec<_>>(),
        )
    }

    /// J v now, shape (k,).
    #[getter]
    fn rate<'py>(&self, py: Python<'py>) -> List<'py> {
        list(
            py,
            &self.0.iter().map(|row| row.rate[0]).collect::<Vec<_>>(),
        )
    }

    /// The acceleration, shape (k,), that a spring and a damper ask for: stiffness times `error`, the wanted place less the actual one, and
    /// damping times `rate` less J v; 1/s² and 1/s. `rate`, the wanted one, is zero where it is not given.
    #[pyo3(signature = (error, stiffness, damping, rate = None))]
    fn feedback<'py>(
        &self,
        py: Python<'py>,
        error: Numbers<'py>,
        stiffness: f64,
        damping: f64,
        rate: Option<Numbers<'py>>,
    ) -> PyResult<List<'py>> {
        let error = self.numbers("error", &error)?;
        let rate = rate.map_or_else(
            || Ok(vec![0.0; self.0.len()]),
            |rate| self.numbers("rate", &rate),
        )?;
        let gains = Gains { stiffness, damping };
        let rows = self.0.iter().zip(error.iter().zip(&rate));
        let wanted = rows.map(|(row, (e, r))| row.acceleration([0.0], [*r], [*e], gains)[0]);
        Ok(list(py, &wanted.collect::<Vec<_>>()))
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }
}

/// Torques of a quadruped by a quadratic program: tasks that are weighed, held or kept in a range, under the equations of motion, friction
/// of the feet, and limits of torques and joints.
///
/// One program serves tick after tick, and begins each search where the last one ended: `begin`, then tasks and limits in any order, then
/// `solve`. Where everything together is impossible, first held tasks yield, then limits on motion, then contacts; torque limits and friction
/// always hold. It has room for 24 rows of one's own, and for 8 with slack.
///
/// Sizes are those of a robot with twelve joints, fixed when the package is built.
#[pyclass(module = "saltus")]
pub(crate) struct TorqueQp {
    robot: Quadruped,
    state: Box<Snapshot<f64, JOINTS>>,
    program: Box<Program>,
}

/// What a refused part of a program means here.
fn refused(error: wbc_qp::Error) -> pyo3::PyErr {
    match error {
        wbc_qp::Error::NoRoomForRows => bad("rows: more than 24 rows of one's own in a tick"),
        wbc_qp::Error::NoRoomForSlack => bad("rank: more than 8 rows with slack in a tick"),
        error => bad(error),
    }
}

#[pymethods]
impl TorqueQp {
    #[new]
    fn new(robot: Py<Robot>) -> Self {
        Self {
            robot: robot.get().0,
            state: Box::new(Snapshot::ZERO),
            program: Box::new(Program::new()),
        }
    }

    /// Begins a tick at a configuration and velocity, as Robot tells. `loads`, shape (4,), says how much each foot stands, in the order of
    /// Robot.foot_names: 1 on the ground, 0 in the air, between them to come and go without a step; `friction` is of the ground, which is
    /// level; `max_force` the largest normal force of a foot, N, by default twice the robot's weight.
    #[pyo3(signature = (q, v, loads = None, *, friction = 0.5, max_force = None))]
    fn begin(
        &mut self,
        q: Numbers<'_>,
        v: Numbers<'_>,
        loads: Option<Numbers<'_>>,
        friction: f64,
        max_force: Option<f64>,
    ) -> PyResult<()> {
        let (q, v) = (configuration("q", &q)?, tangent("v", &v)?);
        let loads = loads.map_or(Ok([1.0; LEGS]), |loads| vector("loads", &loads))?;
        if let Some(load) = loads.iter().find(|load| !(0.0..=1.0).contains(*load)) {
            return Err(bad(format!("loads: {load} is not from 0 to 1")));
        }
        if !(friction >= 0.0 && friction.is_finite()) {
            return Err(bad(format!(
                "friction: {friction} is no coefficient of friction"
            )));
        }
        let max_force = max_force.unwrap_or_else(|| 2.0 * 9.81 * self.robot.mass());
        self.state.update(&self.robot, &q, &v);
        let mut contacts = self.robot.feet.each_ref().map(|foot| {
            Contact::ball(
                foot,
                self.robot.foot_radius,
                Vector3::z(),
                friction,
                max_force,
            )
        });
        for (contact, load) in contacts.iter_mut().zip(loads) {
            contact.load = load;
        }
        let own = joint_friction(Model::limits(&self.robot), &v.joints, STICTION);
        let begun = self
            .program
            .begin(&self.robot, &self.state, &contacts, &own);
        begun.map_err(refused)
    }

    /// The centre of mass in the world, m: a task of three rows.
    fn com(&self) -> WbTask {
        WbTask::of(&self.state.com())
    }

    /// The linear and the angular momentum about the centre of mass, world axes: three rows each, N s and N m s as rates of what they
    /// change.
    fn momentum(&self) -> (WbTask, WbTask) {
        let state = &self.state;
        (
            WbTask::of(&state.linear_momentum()),
            WbTask::of(&state.angular_momentum()),
        )
    }

    /// Place and orientation of the trunk, world axes: six rows, linear before angular.
    fn trunk(&self) -> WbTask {
        WbTask::of(&self.state.frame_pose(&self.robot, &Frame::IDENTITY))
    }

    /// The centre of a foot's ball in the world, three rows; feet are counted as in Robot.foot_names.
    fn foot(&self, foot: usize) -> PyResult<WbTask> {
        let frame = self.robot.feet.get(foot);
        let frame = frame.ok_or_else(|| bad(format!("foot: {foot} is not from 0 to 3")))?;
        Ok(WbTask::of(&self.state.frame_position(&self.robot, frame)))
    }

    /// Adds half the sum of `weights` times the squared distance of the task's acceleration from `target`, both of shape (k,).
    fn minimise(
        &mut self,
        task: Py<WbTask>,
        target: Numbers<'_>,
        weights: Numbers<'_>,
    ) -> PyResult<()> {
        let task = task.get();
        let target = task.numbers("target", &target)?;
        let weights = task.numbers("weights", &weights)?;
        for (row, (target, weight)) in task.0.iter().zip(target.iter().zip(&weights)) {
            self.program.minimise(row, &[*target], &[*weight]);
        }
        Ok(())
    }

    /// Holds a task: its acceleration is `target`, shape (k,), before every cost.
    fn hold(&mut self, task: Py<WbTask>, target: Numbers<'_>) -> PyResult<()> {
        let task = task.get();
        let target = task.numbers("target", &target)?;
        for (row, target) in task.0.iter().zip(&target) {
            self.program.hold(row, &[*target]).map_err(refused)?;
        }
        Ok(())
    }

    /// Keeps a task's acceleration between `lower` and `upper`, shape (k,), which may be infinite. `rank` says how it gives way: "task"
    /// with the held tasks, "limit" with the limits on motion, or a number, the weight of a slack.
    #[pyo3(signature = (task, lower, upper, rank = None))]
    fn constrain(
        &mut self,
        task: Py<WbTask>,
        lower: Numbers<'_>,
        upper: Numbers<'_>,
        rank: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let task = task.get();
        let (lower, upper) = (
            task.numbers("lower", &lower)?,
            task.numbers("upper", &upper)?,
        );
        let rank = rank.map_or(Ok(Rank::Limit), |rank| rank_of(&rank))?;
        for (row, (low, high)) in task.0.iter().zip(lower.iter().zip(&upper)) {
            let added = self.program.constrain(row, &[*low], &[*high], rank);
            added.map_err(refused)?;
        }
        Ok(())
    }

    /// Adds half the sum of `weights` times the squared distance of the joints' accelerations from `target`, both of shape (12,).
    fn minimise_joints(&mut self, target: Numbers<'_>, weights: Numbers<'_>) -> PyResult<()> {
        let (target, weights) = (vector("target", &target)?, vector("weights", &weights)?);
        self.program.minimise_joints(&target, &weights);
        Ok(())
    }

    /// The same of the torques, N m.
    fn minimise_torques(&mut self, target: Numbers<'_>, weights: Numbers<'_>) -> PyResult<()> {
        let (target, weights) = (vector("target", &target)?, vector("weights", &weights)?);
        self.program.minimise_torques(&target, &weights);
        Ok(())
    }

    /// The same of the forces of the ground, N, `target` and `weights` of shape (4, 3).
    fn minimise_forces(&mut self, target: Numbers<'_>, weights: Numbers<'_>) -> PyResult<()> {
        let [target, weights] = [("target", &target), ("weights", &weights)].map(|(name, x)| {
            let mut out = [0.0; FORCES];
            for (to, from) in out.iter_mut().zip(matrix(name, x, [LEGS, 3])?) {
                *to = from;
            }
            Ok::<_, pyo3::PyErr>(out)
        });
        self.program.minimise_forces(&target?, &weights?);
        Ok(())
    }

    /// Keeps torques inside the motors' limits, or a `share` of them.
    #[pyo3(signature = (share = 1.0))]
    fn limit_torques(&mut self, share: f64) -> PyResult<()> {
        if !(share > 0.0 && share <= 1.0) {
            return Err(bad(format!("share: {share} is not above 0 and up to 1")));
        }
        let limits: &[_; JOINTS] = Model::<f64, JOINTS>::limits(&self.robot);
        let ranges = limits.each_ref().map(|limit| {
            let most = share * limit.effort;
            [-most, most]
        });
        self.program.limit_torques(&ranges).map_err(refused)
    }

    /// Keeps joints inside their ranges of position and speed: the distance to the end of a range may be used up in `position` seconds, that
    /// to the largest speed in `velocity`; no acceleration above `acceleration`, rad/s².
    #[pyo3(signature = (position = 0.04, velocity = 0.01, acceleration = 2000.0))]
    fn limit_joints(&mut self, position: f64, velocity: f64, acceleration: f64) {
        let horizon = Horizon {
            position,
            velocity,
            acceleration,
        };
        let limits = Model::limits(&self.robot);
        self.program.limit_joints(&self.state, limits, &horizon);
    }

    /// Ends a level of strict priority: costs go, limits and held tasks stay. Solve first, and hold the level's tasks at what they reached.
    fn next_level(&mut self) {
        self.program.next_level();
    }

    /// Solves the tick's program.
    ///
    /// Raises BadInput for numbers that are not finite, and Error where round-off ends even the last search.
    fn solve(&mut self) -> PyResult<TorqueAnswer> {
        let answer = self.program.solve().map_err(|error| match error {
            wbc_qp::Error::Unsolved(_) => failed(error),
            error => refused(error),
        })?;
        let joints = Model::<f64, JOINTS>::joint_names(&self.robot);
        let feet = core::array::from_fn(|leg| self.robot.place(leg));
        let lines = self.program.report(&answer, 1e-6);
        Ok(TorqueAnswer {
            limits: lines.map(|line| told(&line, joints, &feet)).collect(),
            answer,
        })
    }
}

/// How rows give way.
fn rank_of(rank: &Bound<'_, PyAny>) -> PyResult<Rank<f64>> {
    if let Ok(weight) = rank.extract::<f64>() {
        if weight > 0.0 && weight.is_finite() {
            return Ok(Rank::Slack(weight));
        }
    } else if let Ok(name) = rank.extract::<String>() {
        match name.as_str() {
            "task" => return Ok(Rank::Task),
            "limit" => return Ok(Rank::Limit),
            _ => {}
        }
    }
    let what = rank.str()?;
    Err(bad(format!(
        "rank: {what} is not task, limit or a weight above 0"
    )))
}

/// A line of a report.
fn told(line: &Limited<f64>, joints: &[&str; JOINTS], feet: &[&str; LEGS]) -> String {
    let joint = |i: usize| joints.get(i).copied().unwrap_or_default();
    let foot = |i: usize| feet.get(i).copied().unwrap_or_default();
    let what = match line.limit {
        Limit::Torque(i) => format!("torque of {}", joint(i)),
        Limit::Motion(i) => format!("motion of {}", joint(i)),
        Limit::NormalForce(i) => format!("normal force of {}", foot(i)),
        Limit::Cone(i) => format!("friction of {}", foot(i)),
        Limit::Contact(i) => format!("contact of {}", foot(i)),
        Limit::Row(i) => format!("row {i}"),
    };
    match line.extent {
        Extent::Held(Side::Lower) => format!("{what}: at its lower limit"),
        Extent::Held(Side::Upper) => format!("{what}: at its upper limit"),
        Extent::Missed(by) => format!("{what}: missed by {by:.3e}"),
    }
}

/// What a program on torques found.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct TorqueAnswer {
    answer: wbc_qp::TorqueAnswer<f64, JOINTS, FORCES>,
    limits: Vec<String>,
}

#[pymethods]
impl TorqueAnswer {
    /// Torques, N m, shape (12,): the command.
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.answer.torques)
    }

    /// Acceleration of the robot, shape (18,), in the coordinates of v.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &of_tangent(&self.answer.acceleration))
    }

    /// Forces of the ground on the feet, world axes, N, shape (4, 3).
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        table(py, 3, self.answer.forces.chunks(3))
    }

    /// What had to yield: "Nothing", "Tasks", "MotionLimits" or "Contacts", each with those before it.
    #[getter]
    fn yielded(&self) -> String {
        format!("{:?}", self.answer.yielded)
    }

    /// What limited the tick, in words: limits on which the answer lies, and what gave way by how much. Rows of one's own are counted from
    /// 0 in the order in which they were held or constrained.
    #[getter]
    fn limits(&self) -> Vec<String> {
        self.limits.clone()
    }

    /// Iterations of all searches.
    #[getter]
    fn iterations(&self) -> u32 {
        self.answer.iterations
    }

    fn __repr__(&self) -> String {
        format!(
            "TorqueAnswer({} iterations, {:?} yielded)",
            self.answer.iterations, self.answer.yielded
        )
    }
}
