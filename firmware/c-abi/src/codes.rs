//! What machines and estimators say, as numbers and as text.

use core::ffi::{CStr, c_char};

use jump_control::container::{ContainerError, VERSION as PLAN_VERSION};
use jump_machine::humanoid;

use crate::Status;

/// Where a jump is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Standing at the first node of the plan, before the start.
    Hold = 0,
    /// Pushing off.
    Stance = 1,
    /// In the air, on the way to the landing posture.
    Flight = 2,
    /// In the air, waiting for the ground.
    PreLanding = 3,
    /// On the ground again, taking up the impact.
    Landing = 4,
    /// At rest: a plan may be armed.
    Stand = 5,
    /// Joints are damped and nothing else, until the machine is initialised anew.
    Abort = 6,
}

/// What a tick of the machine computed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Joints damped, nothing else.
    Damping = 0,
    /// A1's feet pulled along the plan.
    Cartesian = 1,
    /// iCub's torques of holding still and pushing off, optimal.
    PushOff = 2,
    /// The same, not optimal: the last iterate, inside every limit.
    PushOffCapped = 3,
    /// A1's landing, with no foot in contact: nothing to solve.
    Airborne = 4,
    /// A1's forces of landing and standing, iCub's torques of flight, landing and standing, optimal.
    Landing = 5,
    /// The same, not optimal: the last iterate, inside every limit.
    LandingCapped = 6,
    /// A program of iCub's had no answer: the last command stays.
    Unsolved = 7,
}

/// Which rows of a program had to yield, so that the others hold. None of A1's can.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Yielded {
    /// None.
    Nothing = 0,
    /// Held tasks.
    Tasks = 1,
    /// Limits on the joints' motion, too.
    MotionLimits = 2,
    /// Contacts, too.
    Contacts = 3,
}

/// Why a machine has aborted.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It has not.
    None = 0,
    /// Position or velocity of a joint is not finite; the index says which.
    Joint = 1,
    /// Pose or velocity of the base is not finite, or its quaternion is not of length 1.
    Base = 2,
    /// Force of a foot is not finite; the index says which.
    Foot = 3,
    /// The observation is older than 10 ms, or its age is no age.
    Stale = 4,
    /// The clock stood still, went backwards, or is not a number.
    Clock = 5,
    /// One of the two loops did not run for 5 ms.
    Silent = 6,
    /// A controller's command was not finite.
    Command = 7,
    /// A controller's program had no answer for 5 ms.
    Unsolved = 8,
    /// Another fault of a newer machine.
    Other = 9,
}

/// Why the last jump was not begun; the robot goes on standing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It was begun, or there was none.
    None = 0,
    /// The robot does not stand.
    NotStanding = 1,
    /// The start is not a number, or too near.
    TooLate = 2,
    /// At the start a joint was not where the plan begins; the index says which.
    Posture = 3,
    /// The feet were not where the jump begins.
    Place = 4,
    /// Another reason of a newer machine.
    Other = 5,
    /// The base is tilted further than that of a robot on its feet.
    Tilted = 6,
}

/// Whether an estimate may be acted on.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateStatus {
    /// Fresh.
    Good = 0,
    /// Samples are missing, for a short time so far.
    Coasting = 1,
    /// They are missing for too long: the estimate stands still where it was.
    Lost = 2,
}

/// What was wrong with a sample.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleFault {
    /// Nothing.
    None = 0,
    /// There was none.
    Missing = 1,
    /// The time step is not positive, not a number, or too long: nothing was done.
    Step = 2,
    /// The accelerometer is not finite or beyond its range: the last value was used.
    Accelerometer = 3,
    /// The gyroscope is not finite or beyond its range: the last value was used.
    Gyroscope = 4,
    /// A joint is not finite: the feet that it moves were not used; the index says which.
    Joint = 5,
    /// The evidence of a foot is not a number: it was not used; the index says which.
    Evidence = 6,
    /// The numbers left the finite range: the last good state was restored.
    Diverged = 7,
    /// Another fault of a newer estimator.
    Other = 8,
}

/// What it is that makes a plan none: filled by calls that read one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Culprit {
    /// Name of the value, ended by a zero; empty where the status says it all.
    pub what: [c_char; 48],
    /// The node that it stands in, −1 for the header.
    pub node: i32,
    /// What was found: a length in bytes, a version, numbers of joints and feet (256 × joints + feet), or the hash of a robot.
    pub found: u64,
    /// What was expected.
    pub expected: u64,
}

impl Culprit {
    /// Nothing is wrong.
    pub(crate) const NONE: Self = Self {
        what: [0; 48],
        node: -1,
        found: 0,
        expected: 0,
    };

    fn numbers(found: u64, expected: u64) -> Self {
        Self {
            found,
            expected,
            ..Self::NONE
        }
    }

    fn named(what: &str, node: Option<u16>) -> Self {
        let mut culprit = Self {
            node: node.map_or(-1, i32::from),
            ..Self::NONE
        };
        // The last byte stays zero.
        let room = culprit.what.iter_mut().rev().skip(1).rev();
        for (to, from) in room.zip(what.bytes()) {
            *to = from as c_char;
        }
        culprit
    }
}

/// Why bytes are no plan for a robot with `joints` and `feet`.
pub(crate) fn no_plan(error: &ContainerError, [joints, feet]: [usize; 2]) -> (Status, Culprit) {
    let size = |joints: usize, feet: usize| (joints * 256 + feet) as u64;
    match *error {
        ContainerError::TooShort { needed, given } => (
            Status::PlanCutOff,
            Culprit::numbers(given as u64, needed as u64),
        ),
        ContainerError::NotAPlan => (Status::NotAPlan, Culprit::NONE),
        ContainerError::Version { found } => (
            Status::PlanVersion,
            Culprit::numbers(found.into(), PLAN_VERSION.into()),
        ),
        ContainerError::Checksum => (Status::PlanDamaged, Culprit::NONE),
        ContainerError::Size {
            joints: found_joints,
            feet: found_feet,
        } => (
            Status::PlanSize,
            Culprit::numbers(
                size(found_joints.into(), found_feet.into()),
                size(joints, feet),
            ),
        ),
        ContainerError::Robot { planned, given } => {
            (Status::PlanRobot, Culprit::numbers(planned, given))
        }
        ContainerError::Value { node, what } => (Status::PlanValue, Culprit::named(what, node)),
        // The others are a writer's.
        _ => (Status::PlanHeader, Culprit::NONE),
    }
}

impl From<jump_control::Phase> for Phase {
    fn from(phase: jump_control::Phase) -> Self {
        match phase {
            jump_control::Phase::Hold => Self::Hold,
            jump_control::Phase::Stance => Self::Stance,
            jump_control::Phase::Flight => Self::Flight,
            jump_control::Phase::PreLanding => Self::PreLanding,
            jump_control::Phase::Landing => Self::Landing,
            jump_control::Phase::Stand => Self::Stand,
            jump_control::Phase::Abort => Self::Abort,
        }
    }
}

/// What a tick computed, and how.
pub(crate) struct Worked {
    pub(crate) work: Work,
    pub(crate) iterations: u32,
    pub(crate) yielded: Yielded,
}

impl Worked {
    const fn plain(work: Work, iterations: u32) -> Self {
        Self {
            work,
            iterations,
            yielded: Yielded::Nothing,
        }
    }

    /// Of a program of iCub's; the works are those of its optimum and of what its cap ended.
    fn program(
        solved: Result<humanoid::Solved<f64>, wbc_qp::Error>,
        [optimal, capped]: [Work; 2],
    ) -> Self {
        let Ok(solved) = solved else {
            return Self::plain(Work::Unsolved, 0);
        };
        Self {
            work: if solved.capped { capped } else { optimal },
            iterations: solved.iterations,
            yielded: match solved.yielded {
                wbc_qp::Yielded::Nothing => Yielded::Nothing,
                wbc_qp::Yielded::Tasks => Yielded::Tasks,
                wbc_qp::Yielded::MotionLimits => Yielded::MotionLimits,
                wbc_qp::Yielded::Contacts => Yielded::Contacts,
            },
        }
    }
}

impl From<jump_machine::Work> for Worked {
    fn from(work: jump_machine::Work) -> Self {
        match work {
            jump_machine::Work::Cartesian => Self::plain(Work::Cartesian, 0),
            jump_machine::Work::Landing(landing::Outcome::Airborne) => {
                Self::plain(Work::Airborne, 0)
            }
            jump_machine::Work::Landing(landing::Outcome::Solved(count)) => {
                Self::plain(Work::Landing, count)
            }
            jump_machine::Work::Landing(landing::Outcome::Failed(_)) => {
                Self::plain(Work::LandingCapped, 0)
            }
            _ => Self::plain(Work::Damping, 0),
        }
    }
}

impl From<humanoid::Work<f64>> for Worked {
    fn from(work: humanoid::Work<f64>) -> Self {
        match work {
            humanoid::Work::PushOff(solved) => {
                Self::program(solved, [Work::PushOff, Work::PushOffCapped])
            }
            humanoid::Work::Landing(solved) => {
                Self::program(solved, [Work::Landing, Work::LandingCapped])
            }
            // Machines in C land by the program: servos have no work here.
            humanoid::Work::Servos | humanoid::Work::Damping => Self::plain(Work::Damping, 0),
        }
    }
}

/// A fault and the index of its joint or foot.
pub(crate) fn fault(fault: Option<jump_control::Fault>) -> (Fault, u32) {
    match fault {
        None => (Fault::None, 0),
        Some(jump_control::Fault::Joint(i)) => (Fault::Joint, i as u32),
        Some(jump_control::Fault::Base) => (Fault::Base, 0),
        Some(jump_control::Fault::Foot(i)) => (Fault::Foot, i as u32),
        Some(jump_control::Fault::Stale) => (Fault::Stale, 0),
        Some(jump_control::Fault::Clock) => (Fault::Clock, 0),
        Some(jump_control::Fault::Silent) => (Fault::Silent, 0),
        Some(jump_control::Fault::Command) => (Fault::Command, 0),
        Some(jump_control::Fault::Unsolved) => (Fault::Unsolved, 0),
        Some(_) => (Fault::Other, 0),
    }
}

/// A refusal and the index of its joint.
pub(crate) fn refusal(refusal: Option<jump_machine::Refusal>) -> (Refusal, u32) {
    match refusal {
        None => (Refusal::None, 0),
        Some(jump_machine::Refusal::NotStanding) => (Refusal::NotStanding, 0),
        Some(jump_machine::Refusal::Tilted) => (Refusal::Tilted, 0),
        Some(jump_machine::Refusal::TooLate) => (Refusal::TooLate, 0),
        Some(jump_machine::Refusal::Posture(joint)) => (Refusal::Posture, joint as u32),
        Some(jump_machine::Refusal::Place) => (Refusal::Place, 0),
        Some(_) => (Refusal::Other, 0),
    }
}

/// A sample's fault and the index of its joint or foot.
pub(crate) fn sample_fault(fault: Option<state_est::Fault>) -> (SampleFault, u32) {
    match fault {
        None => (SampleFault::None, 0),
        Some(state_est::Fault::Missing) => (SampleFault::Missing, 0),
        Some(state_est::Fault::Step) => (SampleFault::Step, 0),
        Some(state_est::Fault::Accelerometer) => (SampleFault::Accelerometer, 0),
        Some(state_est::Fault::Gyroscope) => (SampleFault::Gyroscope, 0),
        Some(state_est::Fault::Joint(i)) => (SampleFault::Joint, i as u32),
        Some(state_est::Fault::Evidence(i)) => (SampleFault::Evidence, i as u32),
        Some(state_est::Fault::Diverged) => (SampleFault::Diverged, 0),
        Some(_) => (SampleFault::Other, 0),
    }
}

/// Entry `code` of a table of texts.
fn text(texts: &'static [&'static CStr], code: u32) -> *const c_char {
    let text = usize::try_from(code).ok().and_then(|i| texts.get(i));
    text.copied().unwrap_or(c"unknown code").as_ptr()
}

/// What a `SaltusStatus` means: a text ended by a zero, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_status_text(status: u32) -> *const c_char {
    text(
        &[
            c"ok",
            c"a pointer is null",
            c"a pointer is not aligned for what it points to",
            c"the block is too small: ask for its size",
            c"the caller was compiled with another version of the header",
            c"the block was not initialised, or for another controller, or it was moved since",
            c"a number is not finite, or limits are inverted",
            c"the program was not solved",
            c"the plan is cut off: copy it again",
            c"not a plan: it does not begin with SLTS",
            c"a plan of another version of the format: plan again",
            c"the plan is damaged: its checksum does not fit; copy it again",
            c"a plan for a robot with other numbers of joints and feet",
            c"a plan for another robot of the same size",
            c"the plan's header contradicts its length",
            c"a value of the plan cannot be: plan again",
            c"the robot does not stand: wait until it does",
            c"the start is not a number, or too near: choose a later one",
            c"the machine has aborted: joints are damped",
        ],
        status,
    )
}

/// The name of a `SaltusPhase`: a text ended by a zero, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_phase_text(phase: u32) -> *const c_char {
    text(
        &[
            c"hold",
            c"stance",
            c"flight",
            c"pre-landing",
            c"landing",
            c"stand",
            c"abort",
        ],
        phase,
    )
}

/// What a `SaltusFault` means: a text ended by a zero, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_fault_text(fault: u32) -> *const c_char {
    text(
        &[
            c"no fault",
            c"joint: encoder not finite",
            c"base: pose or velocity not finite, or the quaternion not of length 1",
            c"foot: force not finite",
            c"observation too old",
            c"clock not going forward",
            c"control loop not running",
            c"command not finite",
            c"program without an answer for too long",
        ],
        fault,
    )
}

/// What a `SaltusRefusal` means: a text ended by a zero, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_refusal_text(refusal: u32) -> *const c_char {
    text(
        &[
            c"not refused",
            c"the robot does not stand: wait until it does",
            c"the plan came too late for its start: choose a later one",
            c"a joint is not where the plan begins: plan from where the robot stands",
            c"the feet are not where the jump begins: give it the place where the robot stands",
            c"another reason",
            c"the base is tilted: set the robot on its feet",
        ],
        refusal,
    )
}

/// What a `SaltusSampleFault` means: a text ended by a zero, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_sample_fault_text(fault: u32) -> *const c_char {
    text(
        &[
            c"no fault",
            c"no sample: coasting on the last one",
            c"time step not positive or too long: nothing was done",
            c"accelerometer not finite or out of range",
            c"gyroscope not finite or out of range",
            c"joint: encoder not finite, its feet are not used",
            c"foot: contact evidence is not a number",
            c"estimate left the finite range: last good one restored",
        ],
        fault,
    )
}
