//! What the joint loop and the control loop share.

use jump_control::JointCommand;
use saltus_probe::Real;

use crate::joints::Joints;
use crate::recorder::Recorder;
use crate::robot::Robot;

/// Bytes of the flight recorder.
pub const RING: usize = 64 * 1024;
/// Joint ticks per control tick.
const RATIO: u32 = 10;

/// The robot, the command in force and the flight recorder. Every method is short enough for a critical section.
#[derive(Debug)]
pub struct Shared<T: Real, R, const N: usize> {
    robot: R,
    joints: Joints<T, N>,
    recorder: Recorder<RING>,
    ticks: u32,
    over: bool,
}

impl<T: Real, R: Robot<T, N>, const N: usize> Shared<T, R, N> {
    /// Before the first tick.
    pub const fn new(robot: R, joints: Joints<T, N>) -> Self {
        Self {
            robot,
            joints,
            recorder: Recorder::new(),
            ticks: 0,
            over: false,
        }
    }

    /// One joint tick, every 100 µs: encoders in, torques out. Every tenth time the control loop is to tick, and this is what
    /// it is to hear.
    pub fn joint_tick(&mut self) -> Option<R::Heard> {
        if self.over {
            return None;
        }
        let sensors = self
            .ticks
            .is_multiple_of(RATIO)
            .then(|| self.robot.sensors());
        self.ticks = self.ticks.wrapping_add(1);
        let heard = self.robot.encoders();
        let torques = self.joints.tick(&heard.0, &heard.1);
        self.recorder
            .record(b'j', self.joints.number, &heard, &torques);
        self.robot.carry(&mut self.recorder);
        self.robot.drive(&torques);
        if self.robot.is_over() {
            self.over = true;
            self.recorder.end();
        }
        sensors
    }

    /// The command that the control loop made of what it heard: in force from now on.
    pub fn give(&mut self, heard: &R::Heard, command: &JointCommand<T, N>) {
        self.recorder
            .record(b'c', self.joints.number, heard, command);
        self.joints.give(command);
    }

    /// Some bytes of the recorder, and whether more will come.
    pub fn drain(&mut self, out: &mut [u8]) -> (usize, bool) {
        let count = self.recorder.take(out);
        (count, !(self.over && count < out.len()))
    }
}
