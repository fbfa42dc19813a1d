//! The machine that flies a plan, to be stepped from outside.

use jump_control::JointCommand;
use jump_lab::quadruped::Planned;
use jump_machine::Workspace;
use jump_machine::{Jump, Machine as Jumper, Settings, Tick as Ticked};
use jump_planner::robot::Quadruped;
use jump_planner::stored::Stored;
use jump_planner::{FOOT_COUNT, JOINTS};
use pyo3::{Py, PyResult, Python, pyclass, pymethods};
use self_cell::{MutBorrow, self_cell};

use crate::arrays::{List, Numbers, list, vector};
use crate::errors::{Refused, bad};
use crate::observation::Observation;

/// What the machine borrows.
struct Memory {
    robot: Quadruped,
    plan: Vec<u8>,
    workspace: MutBorrow<Workspace<f64, JOINTS, FOOT_COUNT>>,
}

/// The machine with its borrows.
type Borrowing<'m> = Jumper<'m, f64, Quadruped, JOINTS, FOOT_COUNT>;

self_cell!(
    /// The machine beside what it borrows.
    struct Cell {
        owner: Memory,
        #[not_covariant]
        dependent: Borrowing,
    }
);

/// The whole jump as one state machine: an observation in at 1 kHz, commands of the joints out. Plan.machine makes one.
///
/// Whatever comes in, what comes out is finite and inside the motors' limits; after a fault it is damping alone.
#[pyclass(module = "saltus")]
pub(crate) struct Machine(Cell);

impl Machine {
    /// A machine that flies this plan from `start` on.
    pub(crate) fn flying(planned: &Planned, start: f64) -> PyResult<Self> {
        let robot = planned.task.robot;
        let standing = &planned.task.start;
        let settings = Settings::new(
            &robot.build(standing),
            robot.feet,
            robot.drives(),
            standing.joints,
        );
        let memory = Memory {
            robot,
            plan: planned.reference.bytes.clone(),
            workspace: MutBorrow::new(Workspace::new()),
        };
        let cell = Cell::new(memory, |memory| {
            Jumper::new(&memory.robot, settings, memory.workspace.borrow_mut())
        });
        let mut machine = Self(cell);
        machine.arm(start)?;
        Ok(machine)
    }
}

#[pymethods]
impl Machine {
    /// Gives a standing robot the plan once more: it begins at `start`, s, on the clock of tick, and holds the plan's first node until then.
    ///
    /// Raises Refused where the robot does not stand, or the start is too near: nothing changes then.
    fn arm(&mut self, start: f64) -> PyResult<()> {
        self.0.with_dependent_mut(|memory, machine| {
            let stored = Stored::read(&memory.plan).map_err(bad)?;
            let jump = Jump::stored(&stored).map_err(bad)?;
            machine
                .arm(jump, start)
                .map_err(|refusal| Refused::new_err(refusal.to_string()))
        })
    }

    /// One tick of 1 kHz at the time `now`, s, on a clock that only goes forward. `observation` is what has arrived since the last tick;
    /// None is a sensor that said nothing: the last observation is used until it is 10 ms old.
    #[pyo3(signature = (now, observation = None))]
    fn tick(&mut self, now: f64, observation: Option<Py<Observation>>) -> Tick {
        let observed = observation.map(|told| told.get().0);
        self.0.with_dependent_mut(|_, machine| Tick {
            tick: machine.tick(now, observed.as_ref()),
            command: *machine.command(),
        })
    }

    /// The machine's own joint loop, for 10 kHz: torques for the motors, N m, shape (12,), from joint positions, rad, and velocities, rad/s,
    /// of now, `dt` seconds after the last. It slews torques and keeps to the motors' torque-speed lines.
    #[pyo3(signature = (joints, joint_velocities, dt = 1e-4))]
    fn joint_tick<'py>(
        &mut self,
        py: Python<'py>,
        joints: Numbers<'py>,
        joint_velocities: Numbers<'py>,
        dt: f64,
    ) -> PyResult<List<'py>> {
        let q = vector("joints", &joints)?;
        let qd = vector("joint_velocities", &joint_velocities)?;
        let tau = self
            .0
            .with_dependent_mut(|_, machine| machine.joint_tick(&q, &qd, dt));
        Ok(list(py, &tau))
    }

    /// Where the jump is: "Hold", "Stance", "Flight", "PreLanding", "Landing", "Stand" or "Abort".
    #[getter]
    fn phase(&self) -> String {
        self.0
            .with_dependent(|_, machine| format!("{:?}", machine.phase()))
    }

    /// Why the machine has aborted, if it has.
    #[getter]
    fn fault(&self) -> Option<String> {
        let fault = self.0.with_dependent(|_, machine| machine.fault());
        fault.map(|fault| fault.to_string())
    }

    /// Which feet are on the ground, as the machine believes.
    #[getter]
    fn contacts(&self) -> [bool; FOOT_COUNT] {
        self.0.with_dependent(|_, machine| *machine.contacts().0)
    }

    /// The command in force.
    #[getter]
    fn command(&self) -> Command {
        Command(self.0.with_dependent(|_, machine| *machine.command()))
    }
}

/// What came of a tick.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Tick {
    tick: Ticked,
    command: JointCommand<f64, JOINTS>,
}

#[pymethods]
impl Tick {
    /// Where the jump is, as Machine.phase.
    #[getter]
    fn phase(&self) -> String {
        format!("{:?}", self.tick.phase)
    }

    /// What was computed: "Cartesian", "Landing(…)" with the outcome of its program, or "Damping".
    #[getter]
    fn work(&self) -> String {
        format!("{:?}", self.tick.work)
    }

    /// Why the machine has aborted, if it has.
    #[getter]
    fn fault(&self) -> Option<String> {
        self.tick.fault.map(|fault| fault.to_string())
    }

    /// Why the jump was not begun, if it was not.
    #[getter]
    fn refusal(&self) -> Option<String> {
        self.tick.refusal.map(|refusal| refusal.to_string())
    }

    /// What the joints are to do until the next tick.
    #[getter]
    fn command(&self) -> Command {
        Command(self.command)
    }

    fn __repr__(&self) -> String {
        format!("Tick({:?}, {:?})", self.tick.phase, self.tick.work)
    }
}

/// What motor boards take: tau + kp (q - joints) + kd (dq - joint_velocities). All of shape (12,).
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Command(JointCommand<f64, JOINTS>);

#[pymethods]
impl Command {
    /// Wanted positions, rad.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.position)
    }

    /// Wanted velocities, rad/s.
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.velocity)
    }

    /// Stiffness, N m/rad.
    #[getter]
    fn kp<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.gains.map(|gains| gains.stiffness))
    }

    /// Damping, N m s/rad.
    #[getter]
    fn kd<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.gains.map(|gains| gains.damping))
    }

    /// Feed-forward torques, N m.
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> List<'py> {
        list(py, &self.0.feed_forward)
    }
}
