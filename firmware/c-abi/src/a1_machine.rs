//! A1: a whole jump, from standing to standing.

use core::ffi::{c_char, c_void};

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::container::GroundStep;
use jump_machine::Workspace;
use jump_machine::{Machine, Settings};
use rbd_core::Motor;

use crate::Status;
use crate::a1::SAFE_DAMPING;
use crate::codes::{Culprit, Phase};
use crate::machine::{self, Jumper, Observation, Tick, blame, not_armed, open, plain};
use crate::memory::{Resident, align, place, resident, result, size, status};
use crate::state::xyzw;

const N: usize = 12;
const F: usize = 4;

/// Legs without ground while no jump was armed yet: hip, thigh, calf, rad. The crouch in which A1's build is measured.
const WAITING: [f64; 3] = [0.0, 0.9, -1.8];

/// What a plan says about itself.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Plan {
    /// When the robot leaves the ground, s after the start.
    pub takeoff: f64,
    /// When it takes up its landing posture, s.
    pub posing: f64,
    /// When the plan expects the ground, s.
    pub touchdown: f64,
    /// Weight that it was planned for, N.
    pub weight: f64,
    /// Where the base is to be in the end, seen from where it started, world axes, m.
    pub goal_w: [f64; 3],
    /// Where it is to look then: the angle about the world's z, rad.
    pub heading: f64,
    /// Position of the base at the start, m.
    pub start_position_w: [f64; 3],
    /// Its orientation: a unit quaternion x, y, z, w.
    pub start_orientation_wb: [f64; 4],
    /// Joint positions at the start, rad.
    pub start_joints: [f64; 12],
    /// Joint positions in which the robot waits for the ground, rad.
    pub landing_joints: [f64; 12],
    /// By how much the ground is lower beyond the edge of a box, m; negative where the robot jumps up; 0 without a box.
    pub drop: f64,
    /// Distance of that edge from the origin towards the landing, m.
    pub edge: f64,
    /// The world's axis across the edge: 0 is x, 1 is y.
    pub edge_axis: u32,
    /// On which side of the edge it lands, ±1; 0 without a box.
    pub edge_side: i32,
    /// Number of nodes.
    pub nodes: u32,
    /// Name of the task, ended by a zero.
    pub task: [c_char; 256],
}

/// The machine; the landing's memory is lent to it.
struct A1Machine(Machine<'static, f64, A1Geared, N, F>);

impl Resident for A1Machine {
    const KIND: u64 = 0x6131_6a75_6d70;
    type Lent = Workspace<f64, N, F>;
}

impl Jumper<N, F> for A1Machine {
    const SAFE_DAMPING: f64 = SAFE_DAMPING;
    const MOTORS: &'static [Motor<f64>; N] = &MOTORS;
    type Machine = Machine<'static, f64, A1Geared, N, F>;

    fn machine(&mut self) -> &mut Self::Machine {
        &mut self.0
    }
}

/// Looks at every number of a plan, and says what it is. `culprit` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_plan_read(
    plan: *const u8,
    bytes: usize,
    about: *mut A1Plan,
    culprit: *mut Culprit,
) -> Status {
    status(blame(culprit, || {
        let out = result(about).map_err(plain)?;
        let (container, jump) = open::<_, N, F>(&A1Geared, plan, bytes)?;
        let header = container.header();
        let start = jump.plan.node(0).ok_or(plain(Status::PlanHeader))?;
        let step = header.ground;
        let GroundStep {
            drop,
            axis,
            distance,
            ..
        } = step.unwrap_or_default();
        let mut task = [0; 256];
        for (to, from) in task.iter_mut().zip(header.task.bytes()) {
            *to = from as c_char;
        }
        out.write(A1Plan {
            takeoff: jump.plan.takeoff,
            posing: jump.plan.posing,
            touchdown: jump.plan.touchdown,
            weight: f64::from(header.margins.weight),
            goal_w: header.goal_w.map(f64::from),
            heading: f64::from(header.heading),
            start_position_w: start.base.translation.into(),
            start_orientation_wb: xyzw(&start.base.rotation),
            start_joints: start.joints,
            landing_joints: jump.landing_joints,
            drop: f64::from(drop),
            edge: f64::from(distance),
            edge_axis: u32::from(axis),
            edge_side: step.map_or(0, |step| i32::from(step.side)),
            nodes: u32::from(header.nodes),
            task,
        });
        Ok(())
    }))
}

/// Bytes of the block of a machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_size() -> usize {
    size::<A1Machine>()
}

/// Alignment of the block of a machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_align() -> usize {
    align::<A1Machine>()
}

/// Initialises a machine in a block; `version` is `SALTUS_VERSION`. It stands, without a jump; until the first tick its joints are damped.
/// The way out of an abort, too.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
) -> Status {
    let fill = |workspace| {
        let feet = FEET.each_ref().map(|foot| foot.frame);
        let [hip, thigh, calf] = WAITING;
        let mut waiting = [0.0; N];
        for leg in waiting.as_chunks_mut::<3>().0 {
            *leg = [hip, thigh, calf];
        }
        let settings = Settings::new(&BUILD, feet, MOTORS, waiting);
        A1Machine(Machine::new(&A1Geared, settings, workspace))
    };
    status(place(memory, bytes, version, Workspace::new, fill))
}

/// Gives a standing robot a plan that begins at `start`, s, on the clock of `saltus_a1_machine_tick`; until then it holds the plan's first
/// node. The start must be at least 1.1 s after the last tick, and more ticks than half of the plan's nodes: in these the gains of the push-off are
/// computed. Where that shows only at the start, since ticks were missed or none had told the time, the robot goes on standing and the tick's refusal is `TooLate`. The plan is what `saltus plan` writes as `plan.bin`; version,
/// checksum, robot and every number of it are looked at, which takes as long as thirty ticks for 624 nodes. It is followed where it is: its bytes must
/// stay there, unchanged, until the machine has another plan or is initialised anew. If the status is not `Ok`, nothing changes; a culprit
/// that is not null then says what is to blame.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_arm(
    memory: *mut c_void,
    plan: *const u8,
    bytes: usize,
    start: f64,
    culprit: *mut Culprit,
) -> Status {
    status(blame(culprit, || {
        let A1Machine(machine) = resident(memory).map_err(plain)?;
        let (_, jump) = open(&A1Geared, plan, bytes)?;
        let armed = machine.arm(jump, start);
        armed.map_err(|refusal| plain(not_armed(refusal)))
    }))
}

/// One tick of 1 kHz at the time `now`, s, on a clock that only goes forward. `observation` is what has arrived since the last tick, null if
/// nothing: the last one is used until it is older than 10 ms. Whatever the status, `tick` holds a command that may be given to the joints
/// if it is neither null nor misaligned. `Aborted` says that joints are damped from now on, and the tick's fault why.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_tick(
    memory: *mut c_void,
    now: f64,
    observation: *const Observation<12, 4>,
    tick: *mut Tick<12>,
) -> Status {
    machine::tick::<A1Machine, N, F>(memory, now, observation, tick)
}

/// Torques of the twelve joints, N m, for 10 kHz, `dt` s after the last call, from their positions and velocities: inside what the motors can
/// do, and no faster than their drives. Damping alone once ticks have been missing for 5 ms, or an encoder is not finite; and where the block is no machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_joint_tick(
    memory: *mut c_void,
    joints: *const f64,
    joint_velocities: *const f64,
    dt: f64,
    torques: *mut f64,
) -> Status {
    machine::joint_tick::<A1Machine, N, F>(memory, joints, joint_velocities, dt, torques)
}

/// Where the jump is.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_machine_phase(memory: *mut c_void, phase: *mut Phase) -> Status {
    machine::phase::<A1Machine, N, F>(memory, phase)
}
