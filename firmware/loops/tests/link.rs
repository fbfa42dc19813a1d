//! A jump over a link: as it should be, with frames lost, repeated and damaged, and with the link cut.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    missing_docs,
    reason = "tests"
)]

use core::cell::RefCell;
use std::rc::Rc;

use jump_control::Phase;
use nalgebra::Vector3;
use saltus_loops::control::{Control, Pilot};
use saltus_loops::frame::{FRAME, Order, REPORT, Report};
use saltus_loops::link::{Bus, Link};
use saltus_loops::replay::replay;
use saltus_loops::shared::Shared;
use saltus_probe::flight::Flight;

/// Joint ticks per millisecond.
const RATIO: usize = 10;

/// The robot's side of the link: a simulated A1 that takes orders and reports.
struct Far {
    flight: Flight<f64>,
    /// Velocity of the base, world axes, over the last millisecond.
    velocities_w: [Vector3<f64>; RATIO],
    number: u16,
    ticks: usize,
    jump: bool,
    sent: Option<[u8; FRAME]>,
    /// The flight recorder's bytes, as they came.
    recording: Vec<u8>,
    /// What happens to report k.
    harm: fn(usize) -> Harm,
}

#[derive(Clone, Copy, PartialEq)]
enum Harm {
    None,
    Lost,
    Repeated,
    Damaged,
}

impl Far {
    /// 100 µs under an order, and the report of what came of it.
    fn exchange(&mut self, bytes: &[u8; FRAME]) {
        let order = Order::decode(bytes).unwrap();
        let (luggage, count) = &order.luggage;
        self.recording.extend_from_slice(&luggage[..*count]);
        self.flight.step(&order.torques.map(f64::from));
        let heard = self.flight.hear();
        let base = heard.measured.base;
        let now_w = base.rotation * heard.measured.base_velocity.linear;
        let slot = &mut self.velocities_w[self.ticks % RATIO];
        let felt_w = (now_w - core::mem::replace(slot, now_w)) / 1e-3 + Vector3::z() * 9.81;
        let single = |xs: [f64; 12]| xs.map(|x| x as f32);
        let harm = (self.harm)(self.ticks);
        self.ticks += 1;
        if harm != Harm::Repeated {
            self.number = self.number.wrapping_add(1);
        }
        let mut report = Report {
            number: self.number,
            jump: self.jump,
            joints: single(heard.measured.joints),
            joint_velocities: single(heard.measured.joint_velocities),
            // The mean over a millisecond of what is felt in a tenth of it.
            torques: single(heard.joint_torques.map(|x| x * RATIO as f64)),
            specific_force: (base.rotation.inverse() * felt_w).map(|x| x as f32).into(),
            angular_velocity: heard
                .measured
                .base_velocity
                .angular
                .map(|x| x as f32)
                .into(),
            foot_forces: heard.measured.foot_forces.map(|x| x as f32),
        }
        .encode();
        if harm == Harm::Damaged {
            report[self.ticks % REPORT] ^= 0x10;
        }
        let mut frame = [0; FRAME];
        frame[..REPORT].copy_from_slice(&report);
        self.sent = (harm != Harm::Lost).then_some(frame);
    }
}

/// This board's side.
struct Wire {
    far: Rc<RefCell<Far>>,
    came: [u8; FRAME],
}

impl Bus for Wire {
    fn take(&mut self) -> Option<&[u8; FRAME]> {
        self.came = self.far.borrow_mut().sent.take()?;
        Some(&self.came)
    }

    fn begin(&mut self, bytes: &[u8; FRAME]) -> bool {
        self.far.borrow_mut().exchange(bytes);
        true
    }
}

/// Stands for half a second, jumps, and stands again; where the jump is at the end, the robot, and the recording.
fn fly(harm: fn(usize) -> Harm) -> (Phase, Flight<f64>, Vec<u8>) {
    let far = Rc::new(RefCell::new(Far {
        flight: Flight::new(),
        velocities_w: [Vector3::zeros(); RATIO],
        number: 0,
        ticks: 0,
        jump: false,
        sent: None,
        recording: Vec::new(),
        harm,
    }));
    let wire = Wire {
        far: Rc::clone(&far),
        came: [0; FRAME],
    };
    let memory = Box::leak(Box::new(Pilot::<f64>::memory()));
    let mut pilot = Pilot::new(memory).unwrap();
    let mut shared = Shared::new(Link::new(wire), Pilot::joints());
    for k in 0..35_000 {
        far.borrow_mut().jump = k > 5_000;
        if let Some(heard) = shared.joint_tick() {
            pilot.tick(&heard);
            shared.give(&heard, pilot.command());
        }
    }
    let (flight, recording) = {
        let far = far.borrow();
        (far.flight.clone(), far.recording.clone())
    };
    (pilot.phase(), flight, recording)
}

/// Whether the robot stands on the floor behind its box, upright.
fn stands(flight: &mut Flight<f64>) -> bool {
    let base = flight.hear().measured.base;
    (base.rotation * Vector3::z()).z > 0.9 && base.translation.x < -0.3
}

#[test]
fn a_jump_over_the_link_lands_and_its_recording_replays() {
    let (phase, mut flight, recording) = fly(|_| Harm::None);
    assert!(stands(&mut flight), "{:?}", flight.hear().measured.base);
    assert!(matches!(phase, Phase::Landing | Phase::Stand), "{phase:?}");
    // The robot's side closes the recording behind the last whole record: it cannot know that more is to come.
    let cut = match replay::<f64, Pilot<f64>, 12>(&recording) {
        Err(saltus_loops::replay::Error::CutOff(at)) => at,
        other => panic!("{other:?}"),
    };
    assert!(recording.len() - cut < 600);
}

#[test]
fn lost_repeated_and_damaged_frames_are_survived() {
    let (phase, mut flight, _) = fly(|k| match k % 41 {
        0 | 7 | 8 => Harm::Lost,
        13 => Harm::Damaged,
        29 => Harm::Repeated,
        _ => Harm::None,
    });
    assert!(stands(&mut flight), "{:?}", flight.hear().measured.base);
    assert!(matches!(phase, Phase::Landing | Phase::Stand), "{phase:?}");
}

#[test]
fn a_cut_link_ends_in_damping() {
    let (phase, _, _) = fly(|k| if k > 4_000 { Harm::Lost } else { Harm::None });
    assert_eq!(phase, Phase::Abort);
    let (phase, _, _) = fly(|k| if k > 4_000 { Harm::Damaged } else { Harm::None });
    assert_eq!(phase, Phase::Abort);
}
