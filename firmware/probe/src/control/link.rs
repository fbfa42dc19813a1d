//! Both ends of a robot's link, and what robots as they are sold are told.

use jump_control::{Fault, JointCommand, JointGains, Phase};
use jump_machine::{JumpMachine, Observation, Tick};
use rbd_core::{Transform, Tree};
use robot_link::adapters::{mini_cheetah, unitree_go2};
use robot_link::packet::Packet;
use robot_link::{Board, Command, End, LIMIT, Pilot, State, pilot};
use state_est::{Estimator, Foot};

use super::Robot;
use crate::inputs::Stream;
use crate::{Numbers, Real, Recorder, Subject};

/// Time between two turns, ns.
const TURN: u64 = 1_000_000;

impl Numbers for Command<12> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        let JointCommand {
            position,
            velocity,
            feed_forward,
            gains,
        } = &self.0;
        (position, velocity, feed_forward).visit(take);
        gains.map(|gains| gains.stiffness).visit(take);
        gains.map(|gains| gains.damping).visit(take);
    }
}

/// A machine that goes where it is: what is measured here is not the machine.
struct Follower<T: Real>(JointCommand<T, 12>);

impl<T: Real> JumpMachine<T, 12, 4> for Follower<T> {
    type Work = ();

    fn tick(&mut self, _: T, observed: Option<&Observation<T, 12, 4>>) -> Tick<()> {
        if let Some(observed) = observed {
            let base = observed.measured.base.translation;
            self.0.position = observed.measured.joints;
            self.0.velocity = observed.measured.joint_velocities;
            self.0.feed_forward = core::array::from_fn(|_| base.z + observed.measured.age);
        }
        Tick {
            phase: Phase::Stand,
            work: (),
            fault: None,
            refusal: None,
        }
    }

    fn joint_tick(&mut self, _: &[T; 12], _: &[T; 12], _: T) -> [T; 12] {
        [T::ZERO; 12]
    }

    fn command(&self) -> &JointCommand<T, 12> {
        &self.0
    }

    fn phase(&self) -> Phase {
        Phase::Stand
    }

    fn fault(&self) -> Option<Fault> {
        None
    }
}

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, 12>>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let stream = &mut Stream::new(31);
    let estimator = Estimator::<T, 12, 4, 6> {
        feet: robot.feet.map(|frame| Foot {
            frame,
            radius: T::of(0.02),
        }),
        imu: Transform::IDENTITY,
        settings: state_est::Settings::new(),
    };
    let settings = pilot::Settings {
        base: robot.q.base,
        loaded: T::of(15.0),
        turns_per_command: 1,
    };
    let machine = Follower(JointCommand::damp(T::ONE));
    let mut pilot = Pilot::new(&robot.model, estimator, machine, settings);
    let mut board = Board::<12>::new(2.0);
    let mut bytes = [0; Command::<12>::LENGTH];
    for k in 0..3 {
        let now = k * TURN;
        let state = State {
            joints: robot.q.joints.map(|x| x.to_f64() as f32),
            joint_velocities: stream.array(1.0),
            joint_torques: stream.array(10.0),
            specific_force_i: [0.0, 0.0, 9.81],
            angular_velocity_i: stream.array(1.0),
            foot_forces: [30.0; 4],
            ..State::<12, 4>::ZERO
        };
        let input = (&mut board, &state, &mut bytes);
        let length = on.call("Board::say", input, |(board, state, bytes)| {
            f64::from(board.say(state, now, bytes).unwrap_or(0) as u32)
        });
        let input = (&mut pilot, bytes.get(..length as usize).unwrap_or_default());
        on.call("Pilot::hear", input, |(pilot, bytes)| {
            pilot.hear(bytes, now);
            pilot.is_told()
        });
        let input = (&mut pilot, &mut bytes);
        on.call("Pilot::turn", input, |(pilot, bytes)| {
            f64::from(pilot.turn(now, bytes).unwrap_or(0) as u32)
        });
        on.call("Board::hear", (&mut board, &bytes), |(board, bytes)| {
            board.hear(bytes, now).is_ok()
        });
        on.call("Board::command", &mut board, |board| {
            Command(board.command(now))
        });
    }
    on.call("Board::command late", &mut board, |board| {
        Command(board.command(10 * LIMIT))
    });
    adapters(on, stream);
}

/// What a Go2 and a Mini Cheetah are told, and hear.
fn adapters<T: Real, R: Recorder>(on: &mut Subject<'_, T, R>, stream: &mut Stream) {
    let command = Command(JointCommand {
        position: stream.array(1.0),
        velocity: stream.array(5.0),
        feed_forward: stream.array(20.0),
        gains: [JointGains {
            stiffness: 20.0,
            damping: 0.5,
        }; 12],
    });
    on.call("unitree_go2::low_cmd", &command, |command| {
        let image = unitree_go2::low_cmd(command);
        f64::from(unitree_go2::crc(&image))
    });
    let answers = on.call("mini_cheetah::spine_commands", &command, |command| {
        Frames(mini_cheetah::spine_commands(command, true))
    });
    let [first, second] = &answers.0;
    on.call("mini_cheetah::joints", [first, second], |answers| {
        mini_cheetah::joints(answers).is_some()
    });
}

/// Frames of bytes, of which the checksum tells enough.
struct Frames([[u8; mini_cheetah::FRAME]; 2]);

impl Numbers for Frames {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        for frame in &self.0 {
            take(f64::from(unitree_go2::crc(frame)));
        }
    }
}
