//! A jump in real time over UDP: the simulated robot in one thread, the jump machine in another, and nothing but datagrams on the loopback between
//! them. Prints how punctual, how old and how lossy everything was, judges the jump, and replays the controller from its recording.
//!
//! `cargo run --release -p jump-lab --example real_time -- PLAN.bin [rate=1000|500] [seconds=60] [plant=loss=0.05,latency_ms=1] [cut=0.4]`
//!
//! PLAN.bin is what `saltus plan` writes for a built-in task; `plant` is that of `saltus run`, with what the link does; `cut` is the time of the
//! plan, in s, at which nothing gets through any more. Deadlines are the operating system's to keep: `chrt -f 50` before the program, where that is
//! allowed, makes it try harder.

use core::error::Error;
use core::time::Duration;
use jump_lab::Sim;
use jump_lab::lab::{Lab, PlantArgument};
use jump_lab::quadruped::Planned;
use jump_lab::quadruped::execute::Trial;
use jump_lab::quadruped::linked::{Glance, Linked, RobotEnd, Session, TURN, flown_again, prepared};
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use robot_link::recording::Recorded;
use robot_link::{End, UdpLink};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Nanoseconds between two looks of the robot at its socket.
const LOOK: u64 = 200_000;
/// Bytes that a turn leaves in the recording at most: a state and a command, and what stands around them.
const RECORD: u64 = 600;

/// What the command line says.
struct Arguments {
    plan: String,
    linked: Linked,
    seconds: f64,
    plant: Option<PlantArgument>,
}

impl Arguments {
    fn read() -> Result<Self, Box<dyn Error>> {
        let mut words = std::env::args().skip(1);
        let mut out = Self {
            plan: words.next().ok_or("which PLAN.bin?")?,
            linked: Linked {
                period_ms: 1,
                cut: None,
            },
            seconds: 60.0,
            plant: None,
        };
        for word in words {
            match word.split_once('=') {
                Some(("rate", "1000")) => out.linked.period_ms = 1,
                Some(("rate", "500")) => out.linked.period_ms = 2,
                Some(("seconds", value)) => out.seconds = value.parse()?,
                Some(("plant", value)) => out.plant = Some(value.parse()?),
                Some(("cut", value)) => out.linked.cut = Some(value.parse()?),
                _ => return Err(format!("`{word}`: see the head of this file").into()),
            }
        }
        Ok(out)
    }
}

/// A clock that only goes forward, for both ends, ns; and what each knows of the other's controller.
struct Shared {
    clock: Instant,
    glance: Mutex<Glance>,
}

impl Shared {
    fn now(&self) -> u64 {
        self.clock.elapsed().as_nanos() as u64
    }

    fn glance(&self) -> Glance {
        *self.glance.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the next deadline, and returns it: a period after the last, or after `now` where that is over.
    fn wait(&self, last: u64, period: u64, now: u64) -> u64 {
        let next = last + period;
        let deadline = if next > now { next } else { now + period };
        let left = deadline.saturating_sub(self.now());
        thread::sleep(Duration::from_nanos(left));
        deadline
    }
}

/// Times of one kind, ns.
struct Times {
    name: &'static str,
    all: Vec<u64>,
}

impl Times {
    fn new(name: &'static str, count: u64) -> Self {
        let all = Vec::with_capacity(count as usize);
        Self { name, all }
    }

    fn print(&mut self) {
        self.all.sort_unstable();
        let last = self.all.len().saturating_sub(1);
        let at = |share: f64| self.all.get((share * last as f64) as usize);
        let ms = [0.5, 0.99, 0.999, 1.0].map(|share| at(share).map_or(0.0, |t| 1e-6 * *t as f64));
        let [half, most, nearly, worst] = ms.map(|t| format!("{t:9.3}"));
        println!("{:34}{half}{most}{nearly}{worst}", self.name);
    }
}

/// The robot's thread: looks at its socket every [`LOOK`] until `end`, ns. Returns how late its plant was each time.
fn robot(
    end: u64,
    robot: &mut RobotEnd<'_>,
    link: &UdpLink,
    shared: &Shared,
) -> Result<Times, String> {
    let mut late = Times::new("robot's plant behind the clock", end / LOOK + 1);
    let mut deadline = shared.now();
    let mut memory = [0; 1024];
    while shared.now() < end {
        let (now, glance) = (shared.now(), shared.glance());
        late.all.push(now.saturating_sub(deadline));
        while let Some(bytes) = link.receive(&mut memory) {
            robot.hear(bytes, now, &glance);
        }
        robot.advance(now, &glance, |bytes| link.send(bytes))?;
        deadline = shared.wait(deadline, LOOK, now);
    }
    Ok(late)
}

/// The controller's thread: a turn per millisecond until `end`, ns. Returns how late turns were, how long they took, how old the states were and
/// their round trips, and when the machine gave up, ns.
fn controller(
    end: u64,
    session: &mut Recorded<'_, Session<'_>>,
    link: &UdpLink,
    shared: &Shared,
) -> Result<([Times; 4], Option<u64>), String> {
    let names = [
        "turn behind its deadline",
        "turn's length",
        "state's age at its turn",
        "round trip",
    ];
    let [mut late, mut long, mut old, mut around] =
        names.map(|name| Times::new(name, end / TURN + 1));
    let mut deadline = shared.now();
    let (mut memory, mut out, mut aborted) = ([0; 1024], [0; 1024], None);
    while shared.now() < end {
        let now = shared.now();
        late.all.push(now.saturating_sub(deadline));
        while let Some(bytes) = link.receive(&mut memory) {
            session.hear(bytes, now);
        }
        if let Some(length) = session.turn(now, &mut out) {
            link.send(&out[..length]);
        }
        let glance = session.end().glance(now)?;
        *shared.glance.lock().unwrap_or_else(PoisonError::into_inner) = glance;
        if glance.fault.is_some() {
            aborted = aborted.or(Some(now));
        }
        if let Some([age, round_trip]) = session.end().age(now) {
            old.all.push(age);
            around.all.push(round_trip);
        }
        long.all.push(shared.now() - now);
        deadline = shared.wait(deadline, TURN, now);
    }
    Ok(([late, long, old, around], aborted))
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments {
        plan,
        linked,
        seconds,
        plant,
    } = Arguments::read()?;
    let planned = Planned::open(&Quadruped::a1()?, &std::fs::read(plan)?, Task::load)?;
    let trial = Trial {
        disturbance: PlantArgument::plant(plant.as_ref(), Lab::A1, 0),
        seed: 1,
        ..Trial::nominal(Sim::Native)
    };
    let [up, down] = [UdpLink::bind("127.0.0.1:0")?, UdpLink::bind("127.0.0.1:0")?];
    up.connect(down.address()?)?;
    down.connect(up.address()?)?;
    let end = (1e9 * seconds) as u64;
    let shared = Shared {
        clock: Instant::now(),
        glance: Mutex::new(Glance::FIRST),
    };
    let mut controlled = None;
    let (mut late, flown) = thread::scope(|scope| {
        let robot = scope.spawn(|| {
            let mut simulated = RobotEnd::new(&planned, trial, linked)?;
            let late = robot(end, &mut simulated, &down, &shared)?;
            let (tally, tripped) = (*simulated.tally(), simulated.has_tripped());
            Ok::<_, String>((late, (simulated.finish(), tally, tripped)))
        });
        prepared(&planned, &trial, linked, |session| {
            let mut session = Recorded::new(session, (end / TURN * RECORD) as usize);
            let times = controller(end, &mut session, &up, &shared)?;
            let tally = *session.end().tally();
            controlled = Some((times, tally, session.finish()));
            Ok(())
        })?;
        robot
            .join()
            .map_err(|_| "the robot's thread has panicked".to_owned())?
    })?;
    let (run, heard_there, tripped) = flown;
    let ((mut times, aborted), heard_here, recording) =
        controlled.ok_or("nothing was controlled")?;
    println!(
        "{:34}{:>9}{:>9}{:>9}{:>9}",
        "ms", "50 %", "99 %", "99.9 %", "most"
    );
    times.iter_mut().chain([&mut late]).for_each(Times::print);
    println!(
        "controller: {heard_here:?}\nrobot: {heard_there:?}, watchdog {}",
        if tripped { "tripped" } else { "quiet" }
    );
    println!("the jump: {}", planned.judge(&run).verdict.first());
    let Glance {
        phase,
        fault,
        start,
    } = shared.glance();
    let given_up = aborted.zip(start).zip(fault).map(|((at, start), fault)| {
        let at = 1e-9 * at.wrapping_sub(start).cast_signed() as f64;
        format!(", given up at {at:.3} s: {fault}")
    });
    println!("in the end: {phase:?}{}", given_up.unwrap_or_default());
    let turns = flown_again(&planned, &trial, linked, &recording)?;
    println!(
        "replayed: {turns} turns say the recorded bits ({} MB)",
        recording.len() / 1_000_000
    );
    Ok(())
}
