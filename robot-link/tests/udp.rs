//! Both ends over UDP on the loopback, without a deadline: the ends' times are the test's own.

use core::time::Duration;

use jump_control::JointCommand;
use robot_link::{Board, Command, LIMIT, Peer, Refusal, State, UdpLink};

const TURN: u64 = 1_000_000;

/// What comes next; the loopback needs a moment on some systems.
fn next<'m>(link: &UdpLink, memory: &'m mut [u8]) -> Option<&'m [u8]> {
    for _ in 0..1000 {
        if let Some(length) = link.receive(memory).map(<[u8]>::len) {
            return memory.get(..length);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    None
}

#[test]
fn a_robot_follows_over_udp_and_damps_when_it_is_alone() {
    let [here, there] = [(); 2].map(|()| UdpLink::bind("127.0.0.1:0").unwrap());
    here.connect(there.address().unwrap()).unwrap();
    there.connect(here.address().unwrap()).unwrap();
    let mut controller = Peer::<State<12, 4>>::new();
    let mut board = Board::<12>::new(2.0);
    let (mut memory, mut out) = ([0; 512], [0; 512]);
    for k in 0..50_u16 {
        let now = u64::from(k) * TURN;
        let length = board.say(&State::<12, 4>::ZERO, now, &mut out).unwrap();
        there.send(&out[..length]);
        let heard = controller.hear(next(&here, &mut memory).unwrap(), now);
        assert_eq!(heard.err(), (k == 0).then_some(Refusal::Unproven));
        let mut command = JointCommand::damp(1.0);
        command.feed_forward = [f32::from(k); 12];
        let length = controller.say(&Command(command), now, &mut out).unwrap();
        here.send(&out[..length]);
        board.hear(next(&there, &mut memory).unwrap(), now).unwrap();
        assert_eq!(board.command(now), command);
    }
    drop(here);
    // Nobody hears it now, which is no error, and nothing comes.
    there.send(&out);
    assert!(there.receive(&mut memory).is_none());
    let now = 50 * TURN + LIMIT;
    assert_eq!(board.command(now), JointCommand::damp(2.0));
    assert!(board.has_tripped());
}
