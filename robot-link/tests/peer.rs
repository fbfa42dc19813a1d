//! What is in force on a link that loses, repeats, delays, reorders and damages.

use jump_control::JointCommand;
use proptest::prelude::*;
use robot_link::packet::Packet;
use robot_link::{Command, LIMIT, Peer, Refusal, State, Tally};

type Controller = Peer<State<2, 1>>;
type Robot = Peer<Command<2>>;

/// Time between two packets of an end, ns.
const PERIOD: u64 = 1_000_000;

fn command(x: f32) -> Command<2> {
    let mut command = JointCommand::damp(1.0);
    command.feed_forward = [x; 2];
    Command(command)
}

fn said<Q: Packet, P: Packet>(from: &mut Peer<Q>, packet: &P, now: u64) -> Vec<u8> {
    let mut out = vec![0; P::LENGTH];
    from.say(packet, now, &mut out).unwrap();
    out
}

/// Both ends, each proven to the other; the controller's clock is `ahead` of the robot's.
fn met(ahead: u64) -> (Controller, Robot) {
    let (mut controller, mut robot) = (Peer::new(), Peer::new());
    let first = said(&mut robot, &State::<2, 1>::ZERO, 0);
    assert_eq!(controller.hear(&first, ahead), Err(Refusal::Unproven));
    assert!(controller.in_force(ahead).is_none());
    let answer = said(&mut controller, &command(0.0), ahead);
    assert!(robot.hear(&answer, 0).is_ok());
    let second = said(&mut robot, &State::<2, 1>::ZERO, 0);
    assert!(controller.hear(&second, ahead).is_ok());
    (controller, robot)
}

/// What a controller that nobody has spoken to says is not in force, and what answers it is: three packets, whoever begins.
#[test]
fn nobody_acts_on_what_has_no_age() {
    met(0);
    let (mut controller, mut robot) = (Controller::new(), Robot::new());
    let first = said(&mut controller, &command(1.0), 0);
    assert_eq!(robot.hear(&first, 0), Err(Refusal::Unproven));
    let state = said(&mut robot, &State::<2, 1>::ZERO, 0);
    assert!(controller.hear(&state, 0).is_ok());
    let second = said(&mut controller, &command(1.0), 0);
    assert!(robot.hear(&second, 0).is_ok());
}

/// An age needs no common clock: it is right to half of the round trip, which is measured.
#[test]
fn ages_and_round_trips_are_those_of_the_wire() {
    const AHEAD: u64 = 7_000_000_000_000;
    let (mut controller, mut robot) = met(AHEAD);
    // There 1 ms, held for 2 ms, back 3 ms.
    let out = said(&mut controller, &command(1.0), AHEAD + 10 * PERIOD);
    robot.hear(&out, 11 * PERIOD).unwrap();
    let back = said(&mut robot, &State::<2, 1>::ZERO, 13 * PERIOD);
    let now = AHEAD + 16 * PERIOD;
    let heard = controller.hear(&back, now).unwrap();
    assert_eq!((heard.round_trip, heard.stamp), (4 * PERIOD, 13 * PERIOD));
    assert_eq!(heard.age(now + PERIOD), 3 * PERIOD);
}

#[test]
fn the_same_again_and_the_older_are_counted_and_change_nothing() {
    let (mut controller, mut robot) = met(0);
    let packets: Vec<_> = (1..=4_u32)
        .map(|k| said(&mut controller, &command(k as f32), u64::from(k)))
        .collect();
    let mut hear = |k: usize| robot.hear(&packets[k], 5).err();
    assert_eq!([hear(0), hear(2)], [None, None]);
    assert_eq!(hear(2), Some(Refusal::Repeated));
    assert_eq!(hear(1), Some(Refusal::Overtaken));
    assert_eq!(hear(3), None);
    assert_eq!(robot.in_force(5).unwrap().packet, command(4.0));
    let counted = Tally {
        heard: 4,
        missed: 1,
        repeated: 1,
        overtaken: 1,
        said: 2,
        ..Tally::default()
    };
    assert_eq!(robot.tally(), &counted);
}

#[test]
fn nothing_old_is_ever_in_force() {
    let (mut controller, mut robot) = met(0);
    let old = said(&mut controller, &command(1.0), PERIOD);
    let sent = said(&mut controller, &command(2.0), PERIOD);
    // 10 ms late is the last that is heard; it is in force for 10 ms.
    assert_eq!(robot.hear(&old, LIMIT + PERIOD + 1), Err(Refusal::Late));
    assert!(robot.hear(&sent, LIMIT).is_ok());
    assert!(robot.in_force(2 * LIMIT).is_some());
    assert!(robot.in_force(2 * LIMIT + 1).is_none());
    // Heard once more after the silence it is as old as it is.
    assert_eq!(robot.hear(&sent, 3 * LIMIT), Err(Refusal::Late));
}

/// A controller that was started again, on a clock that went on, begins at number 0; the robot hears it after the silence.
#[test]
fn a_peer_that_begins_anew_is_heard_after_a_silence() {
    let (mut controller, mut robot) = met(0);
    for k in 1..5 {
        let told = said(&mut controller, &command(1.0), k);
        robot.hear(&told, k).unwrap();
    }
    let mut controller = Controller::new();
    let state = said(&mut robot, &State::<2, 1>::ZERO, 6);
    // It echoes the one before, and a while ago: that is as good.
    assert!(controller.hear(&state, 6).is_ok());
    let told = said(&mut controller, &command(2.0), 7);
    assert_eq!(robot.hear(&told, 7), Err(Refusal::Overtaken));
    let later = LIMIT + PERIOD;
    let state = said(&mut robot, &State::<2, 1>::ZERO, later);
    controller.hear(&state, later).unwrap();
    let told = said(&mut controller, &command(2.0), later);
    assert!(robot.hear(&told, later).is_ok());
}

#[test]
fn an_echo_of_the_future_is_not_ours() {
    let (mut controller, mut robot) = met(PERIOD);
    let told = said(&mut controller, &command(1.0), 2 * PERIOD);
    robot.hear(&told, PERIOD).unwrap();
    let state = said(&mut robot, &State::<2, 1>::ZERO, PERIOD);
    assert_eq!(controller.hear(&state, PERIOD), Err(Refusal::Foreign));
}

#[test]
fn a_command_that_is_no_number_is_refused() {
    let (mut controller, mut robot) = met(0);
    let mut odd = command(f32::NAN);
    let told = said(&mut controller, &odd, 1);
    assert_eq!(robot.hear(&told, 1), Err(Refusal::Number));
    odd = command(1.0);
    odd.0.gains[1].stiffness = -1.0;
    let told = said(&mut controller, &odd, 2);
    assert_eq!(robot.hear(&told, 2), Err(Refusal::Number));
    assert_eq!((robot.tally().damaged, robot.tally().heard), (2, 1));
}

/// What the air does to a packet.
#[derive(Clone, Copy, Debug)]
struct Fate {
    delays: [u64; 2],
    arrives: bool,
    twice: bool,
    flip: Option<usize>,
}

fn fates() -> impl Strategy<Value = Fate> {
    let delay = || 0..25 * PERIOD;
    let flip = proptest::option::weighted(0.1, 0..8 * Command::<2>::LENGTH);
    let flags = (
        proptest::bool::weighted(0.8),
        proptest::bool::weighted(0.2),
        flip,
    );
    ([delay(), delay()], flags).prop_map(|(delays, (arrives, twice, flip))| Fate {
        delays,
        arrives,
        twice,
        flip,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Whatever the air does: numbers in force only grow, none is older than it may be, nothing damaged is heard, and each packet that came
    /// is counted once.
    #[test]
    fn in_force_is_what_is_newest_and_young(fates in proptest::collection::vec(fates(), 1..120)) {
        let (mut controller, mut robot) = met(0);
        let mut air: Vec<(u64, u32, Vec<u8>)> = Vec::new();
        for (k, fate) in fates.iter().enumerate() {
            let k = u32::try_from(k).unwrap();
            let sent = u64::from(k) * PERIOD;
            // The controller always knows what the robot says, at once.
            let state = said(&mut robot, &State::<2, 1>::ZERO, sent);
            let _ = controller.hear(&state, sent);
            let mut told = said(&mut controller, &command(k as f32), sent);
            if let Some(bit) = fate.flip {
                told[bit / 8] ^= 1 << (bit % 8);
            }
            let times = if fate.arrives { 1 + usize::from(fate.twice) } else { 0 };
            for delay in &fate.delays[..times] {
                air.push((sent + delay, k, told.clone()));
            }
        }
        air.sort_by_key(|(arrives, ..)| *arrives);
        let (mut last, came) = (None, air.len());
        for (now, k, bytes) in air {
            let damaged = fates[k as usize].flip.is_some();
            if let Ok(heard) = robot.hear(&bytes, now) {
                prop_assert!(!damaged && last.is_none_or(|last| heard.number > last));
                prop_assert!(now - u64::from(k) * PERIOD <= LIMIT, "{} old", now);
                prop_assert_eq!(heard.packet, command(k as f32));
                last = Some(heard.number);
            }
        }
        let t = robot.tally();
        let counted = t.heard + t.repeated + t.overtaken + t.late + t.unproven + t.damaged;
        prop_assert_eq!(counted as usize, came + 1);
    }
}
