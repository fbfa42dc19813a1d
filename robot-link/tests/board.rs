//! The robot damps when it hears nothing, and keeps damping.

use jump_control::JointCommand;
use robot_link::packet::{Packet, decode};
use robot_link::{Board, Command, LIMIT, Peer, Refusal, State};

const DAMPING: f32 = 2.0;
const PERIOD: u64 = 1_000_000;

/// A controller and a robot that take turns of a millisecond without a delay.
struct Pair {
    controller: Peer<State<2, 1>>,
    board: Board<2>,
    now: u64,
}

impl Pair {
    fn new() -> Self {
        Self {
            controller: Peer::new(),
            board: Board::new(DAMPING),
            now: 0,
        }
    }

    /// The robot says its state, and is told a torque where the link is whole.
    fn turn(&mut self, torque: f32, is_whole: bool) -> Option<Refusal> {
        let mut out = [0; 512];
        let length = self.board.say(&State::<2, 1>::ZERO, self.now, &mut out);
        let _ = self.controller.hear(&out[..length.unwrap()], self.now);
        let mut command = JointCommand::damp(0.5);
        command.feed_forward = [torque; 2];
        let length = self.controller.say(&Command(command), self.now, &mut out);
        let refused = is_whole.then(|| self.board.hear(&out[..length.unwrap()], self.now).err());
        self.now += PERIOD;
        refused.flatten()
    }

    fn torque(&mut self) -> f32 {
        self.board.command(self.now).feed_forward[0]
    }
}

#[test]
fn a_board_damps_until_it_is_commanded() {
    let mut pair = Pair::new();
    assert_eq!(pair.board.command(0), JointCommand::damp(DAMPING));
    pair.now = 1000 * LIMIT;
    assert!(!pair.board.has_tripped());
    assert_eq!(pair.turn(3.0, true), None);
    assert!(pair.board.is_commanded());
    assert_eq!(pair.torque(), 3.0);
}

/// 10 ms without a command are borne, and not one more.
#[test]
fn silence_ends_in_damping_until_a_reset() {
    let mut pair = Pair::new();
    assert_eq!(pair.turn(3.0, true), None);
    for _ in 0..9 {
        pair.turn(3.0, false);
        assert_eq!(pair.torque(), 3.0);
    }
    pair.now += 1;
    assert_eq!(pair.board.command(pair.now), JointCommand::damp(DAMPING));
    assert!(pair.board.has_tripped());
    // The link is whole again: commands are heard, and not followed.
    assert_eq!(pair.turn(4.0, true), None);
    assert_eq!(pair.turn(4.0, true), None);
    assert_eq!(pair.board.command(pair.now), JointCommand::damp(DAMPING));
    let mut out = [0; State::<2, 1>::LENGTH];
    pair.board.say(&State::<2, 1>::ZERO, pair.now, &mut out);
    assert!(decode::<State<2, 1>>(&out).unwrap().1.tripped);
    pair.board.reset();
    assert_eq!(pair.board.command(pair.now), JointCommand::damp(DAMPING));
    pair.turn(5.0, true);
    assert_eq!(pair.torque(), 5.0);
}

/// A silence counts although nobody has asked for a command in it.
#[test]
fn a_silence_is_not_forgotten_by_the_next_command() {
    let mut pair = Pair::new();
    pair.turn(3.0, true);
    pair.now += 2 * LIMIT;
    pair.turn(4.0, true);
    pair.turn(4.0, true);
    assert!(pair.board.has_tripped());
}

/// What a caller has to keep: the README's numbers.
#[test]
fn the_ends_are_small() {
    let sizes = [
        size_of::<Board<12>>(),
        size_of::<Peer<State<12, 4>>>(),
        size_of::<Peer<Command<12>>>(),
    ];
    assert_eq!(sizes, [352, 280, 344]);
}
