//! A robot at the other end of a link that exchanges [frames](crate::frame) of fixed length, such as SPI with DMA.
//!
//! Nothing waits. A report that is late, repeated or damaged leaves the last one in force, with its age; after 5 ms the joints'
//! numbers are no numbers any more. Both are what the joint loop and the jump machine take for missing sensors.

use nalgebra::Vector3;
use saltus_probe::{Numbers, Real};

use crate::frame::{FRAME, LUGGAGE, Order, Report};
use crate::joints::PERIOD;
use crate::recorder::Recorder;
use crate::robot::Robot;

/// Joint ticks after which a report is worth nothing: 5 ms.
const STALE: u32 = 50;

/// What carries frames. No method waits.
pub trait Bus {
    /// The bytes of the exchange that has ended since the last call; `None` if none has.
    fn take(&mut self) -> Option<&[u8; FRAME]>;

    /// Begins an exchange that sends these bytes; false if the last one is still under way.
    fn begin(&mut self, bytes: &[u8; FRAME]) -> bool;
}

/// What the control loop hears of a robot with an IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensed<T: Real> {
    /// Joint positions, rad, and velocities, rad/s.
    pub joints: [[T; 12]; 2],
    /// Mean torques of the last millisecond, friction included, N m.
    pub joint_torques: [T; 12],
    /// Accelerometer, m/s², and gyroscope, rad/s, base axes.
    pub imu: [Vector3<T>; 2],
    /// Normal forces on the feet, N.
    pub foot_forces: [T; 4],
    /// Age of the report that this is from, s; infinite before the first.
    pub age: T,
    /// Whether the operator wants the jump.
    pub jump: bool,
}

impl<T: Real> Numbers for Sensed<T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.joints, self.joint_torques).visit(take);
        (self.imu, self.foot_forces).visit(take);
        (self.age, self.jump).visit(take);
    }
}

/// A robot behind a bus.
#[derive(Debug)]
pub struct Link<B> {
    bus: B,
    report: Option<Report>,
    /// Joint ticks since the report came.
    age: u32,
    /// Sum of reported torques since the control loop heard them last, and how many.
    joint_torques: ([f32; 12], u16),
    order: Order,
    /// Reports that were damaged or repeated, and orders that found the bus busy.
    pub lost: [u32; 2],
}

impl<B: Bus> Link<B> {
    /// Nothing heard and nothing said.
    #[must_use]
    pub const fn new(bus: B) -> Self {
        Self {
            bus,
            report: None,
            age: 0,
            joint_torques: ([0.0; 12], 0),
            order: Order {
                number: 0,
                torques: [0.0; 12],
                luggage: ([0; LUGGAGE], 0),
            },
            lost: [0; 2],
        }
    }

    /// What carries the frames.
    pub const fn bus(&mut self) -> &mut B {
        &mut self.bus
    }

    /// Takes what has come, if it is new and whole.
    fn listen(&mut self) {
        let Some(bytes) = self.bus.take() else { return };
        let last = self.report.map(|report| report.number);
        match Report::decode(bytes) {
            Ok(report) if last != Some(report.number) => {
                let (sum, count) = &mut self.joint_torques;
                for (sum, torque) in sum.iter_mut().zip(&report.torques) {
                    *sum += torque;
                }
                *count = count.saturating_add(1);
                (self.report, self.age) = (Some(report), 0);
            }
            _ => self.lost[0] = self.lost[0].saturating_add(1),
        }
    }

    /// The last report, unless it is worth nothing.
    fn fresh(&self) -> Option<&Report> {
        self.report.as_ref().filter(|_| self.age <= STALE)
    }
}

/// What a frame carries, as the loop's scalar.
fn number<T: Real>(x: f32) -> T {
    T::of(f64::from(x))
}

impl<T: Real, B: Bus> Robot<T, 12> for Link<B> {
    type Heard = Sensed<T>;

    fn encoders(&mut self) -> ([T; 12], [T; 12]) {
        self.listen();
        match self.fresh() {
            Some(report) => (
                report.joints.map(number),
                report.joint_velocities.map(number),
            ),
            None => ([T::NAN; 12], [T::NAN; 12]),
        }
    }

    fn sensors(&mut self) -> Sensed<T> {
        self.listen();
        let (sum, count) = core::mem::replace(&mut self.joint_torques, ([0.0; 12], 0));
        let age = T::of(f64::from(self.age) * PERIOD);
        let Some(report) = self.report else {
            return Sensed {
                joints: [[T::NAN; 12]; 2],
                joint_torques: [T::ZERO; 12],
                imu: [Vector3::zeros(); 2],
                foot_forces: [T::ZERO; 4],
                age: T::INFINITY,
                jump: false,
            };
        };
        Sensed {
            joints: [report.joints, report.joint_velocities].map(|xs| xs.map(number)),
            joint_torques: if count == 0 {
                report.torques.map(number)
            } else {
                sum.map(|x| number(x / f32::from(count)))
            },
            imu: [report.specific_force, report.angular_velocity]
                .map(|xs| Vector3::from(xs.map(number))),
            foot_forces: report.foot_forces.map(number),
            age,
            jump: report.jump,
        }
    }

    fn drive(&mut self, torques: &[T; 12]) {
        for (to, torque) in self.order.torques.iter_mut().zip(torques) {
            *to = torque.to_f64() as f32;
        }
        if self.bus.begin(&self.order.encode()) {
            self.order.number = self.order.number.wrapping_add(1);
            self.order.luggage.1 = 0;
        } else {
            self.lost[1] = self.lost[1].saturating_add(1);
        }
        self.age = self.age.saturating_add(1);
    }

    fn carry<const R: usize>(&mut self, recorder: &mut Recorder<R>) {
        let (bytes, count) = &mut self.order.luggage;
        // What a busy bus did not take goes first.
        if *count == 0 {
            *count = recorder.take(bytes);
        }
    }

    fn is_over(&self) -> bool {
        false
    }
}
