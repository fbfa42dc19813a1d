//! A cable that is cut: half a second of commands at 1 kHz with every tenth packet lost, then nothing; the robot damps after 10 ms, and does not get up
//! when the cable is mended.
//!
//! `cargo run --release -p robot-link --example cut_cable`

use jump_control::JointCommand;
use robot_link::{Board, Command, LIMIT, Peer, State};

/// A turn of both ends, ns.
const TURN: u64 = 1_000_000;

fn main() {
    let mut controller = Peer::<State<12, 4>>::new();
    let mut robot = Board::<12>::new(2.0);
    let mut datagram = [0; 512];
    let mut tripped = None;
    for turn in 0..1000 {
        let now = turn * TURN;
        let is_cut = (500..800).contains(&turn);
        let arrives = !is_cut && turn % 10 != 7;
        let command = Command(JointCommand {
            feed_forward: [3.0; 12],
            ..JointCommand::damp(0.5)
        });
        let said = robot.say(&State::<12, 4>::ZERO, now, &mut datagram);
        if let (true, Some(length)) = (arrives, said) {
            let _ = controller.hear(&datagram[..length], now);
        }
        let said = controller.say(&command, now, &mut datagram);
        if let (true, Some(length)) = (arrives, said) {
            let _ = robot.hear(&datagram[..length], now);
        }
        let does = robot.command(now + TURN / 2);
        if robot.has_tripped() {
            tripped = tripped.or(Some(now));
        }
        assert_eq!(does.feed_forward[0] == 3.0, tripped.is_none());
    }
    let tripped = tripped.unwrap_or_default();
    println!("cut at 500 ms, damped from {} ms on", tripped / TURN);
    println!("{:?}", robot.tally());
    assert!((499 * TURN + LIMIT..501 * TURN + LIMIT).contains(&tripped));
}
