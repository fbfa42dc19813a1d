//! Two interrupts and an idle loop.
//!
//! SysTick, at 10 kHz and above everything, reads encoders and drives the motors. Every tenth time it reads the other sensors and
//! pends `PendSV`, which is below everything: the 1 kHz control tick, which SysTick interrupts as often as it must. A command
//! is in force from the moment it is complete. The idle loop writes the flight recorder out.

use core::cell::RefCell;

use a1_model::A1Geared;
use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use cortex_m_semihosting::debug;
use cortex_m_semihosting::hio::hstdout;
use jump_machine::Inputs;
use rbd_core::Model;
use saltus_probe::flight::Planned;

use crate::control::Control;
use crate::joints::Joints;
use crate::recorder::Recorder;
use crate::robot::Robot;

/// Bytes of the flight recorder.
pub const RING: usize = 64 * 1024;

/// What both interrupts share, in short critical sections.
#[derive(Debug)]
pub struct Shared<T: Planned, R>
where
    A1Geared: Model<T, 12>,
{
    robot: R,
    joints: Joints<T>,
    recorder: Recorder<RING>,
    heard: Option<Inputs<T, 12, 4>>,
    ticks: u32,
    over: bool,
}

impl<T: Planned, R: Robot<T>> Shared<T, R>
where
    A1Geared: Model<T, 12>,
{
    /// Before the first tick.
    pub fn new(robot: R) -> Self {
        Self {
            robot,
            joints: Joints::new(),
            recorder: Recorder::new(),
            heard: None,
            ticks: 0,
            over: false,
        }
    }
}

/// A place for what an interrupt owns.
pub type Slot<T> = Mutex<RefCell<Option<&'static mut T>>>;

/// Runs `work` on what is in the slot, if it is there.
fn with<T, O>(slot: &'static Slot<T>, work: impl FnOnce(&mut T) -> O) -> Option<O> {
    interrupt::free(|token| {
        let mut slot = slot.borrow(token).try_borrow_mut().ok()?;
        slot.as_deref_mut().map(work)
    })
}

/// Puts something into its slot.
pub fn put<T>(slot: &'static Slot<T>, value: &'static mut T) {
    interrupt::free(|token| {
        if let Ok(mut slot) = slot.borrow(token).try_borrow_mut() {
            *slot = Some(value);
        }
    });
}

/// The joint tick, at 10 kHz.
pub fn joint_tick<T: Planned, R: Robot<T>>(shared: &'static Slot<Shared<T, R>>)
where
    A1Geared: Model<T, 12>,
{
    with(shared, |s| {
        if s.over {
            return;
        }
        if s.ticks.is_multiple_of(10) {
            s.heard = Some(s.robot.sensors());
            SCB::set_pendsv();
        }
        s.ticks = s.ticks.wrapping_add(1);
        let heard = s.robot.encoders();
        let torques = s.joints.tick(&heard.0, &heard.1);
        s.recorder.record(b'j', s.joints.number, &heard, &torques);
        s.robot.drive(&torques);
        if s.robot.is_over() {
            s.over = true;
            s.recorder.end();
        }
    });
}

/// The control tick, at 1 kHz, below the joint tick.
pub fn control_tick<T: Planned, R: Robot<T>>(
    shared: &'static Slot<Shared<T, R>>,
    control: &'static Slot<Control<'static, T>>,
) where
    A1Geared: Model<T, 12>,
{
    let Some(heard) = with(shared, |s| s.heard.take()).flatten() else {
        return;
    };
    // Out of its slot while it works, so that interrupts stay enabled.
    let taken = interrupt::free(|token| control.borrow(token).try_borrow_mut().ok()?.take());
    let Some(taken) = taken else { return };
    taken.tick(&heard);
    with(shared, |s| {
        let command = taken.command();
        s.recorder.record(b'c', s.joints.number, &heard, command);
        s.joints.give(command);
    });
    put(control, taken);
}

/// Some bytes of the recorder, and whether more will come.
pub fn drain<T: Planned, R: Robot<T>>(
    shared: &'static Slot<Shared<T, R>>,
    out: &mut [u8],
) -> (usize, bool)
where
    A1Geared: Model<T, 12>,
{
    with(shared, |s| {
        let count = s.recorder.take(out);
        (count, !(s.over && count < out.len()))
    })
    .unwrap_or((0, true))
}

/// An image: entry, interrupts and statics of the loops in one scalar on one board.
#[macro_export]
macro_rules! image {
    ($T:ty, $Board:ty) => {
        use core::cell::RefCell;

        use cortex_m::interrupt::Mutex;
        use cortex_m_rt::{entry, exception};
        use $crate::boards::Board;
        use $crate::control::Control;
        use $crate::firmware::{self, Shared, Slot};

        type Robot = <$Board as Board<$T>>::Robot;

        static SHARED: Slot<Shared<$T, Robot>> = Mutex::new(RefCell::new(None));
        static CONTROL: Slot<Control<'static, $T>> = Mutex::new(RefCell::new(None));

        #[entry]
        fn main() -> ! {
            let workspace =
                cortex_m::singleton!(: landing::Workspace<$T, 12, 4> = landing::Workspace::new());
            let control = workspace.and_then(Control::new);
            let control = control.and_then(|it| cortex_m::singleton!(: Control<'static, $T> = it));
            let robot = <$Board as Board<$T>>::robot();
            let shared = cortex_m::singleton!(: Shared<$T, Robot> = Shared::new(robot));
            if let (Some(control), Some(shared)) = (control, shared) {
                firmware::put(&CONTROL, control);
                firmware::put(&SHARED, shared);
                firmware::start(<$Board as Board<$T>>::TIMER_HZ);
            }
            firmware::write_out(|out| firmware::drain(&SHARED, out))
        }

        #[exception]
        fn SysTick() {
            firmware::joint_tick(&SHARED);
        }

        #[exception]
        fn PendSV() {
            firmware::control_tick(&SHARED, &CONTROL);
        }
    };
}

/// Starts SysTick at 10 kHz, above `PendSV`.
pub fn start(timer_hz: u32) {
    let Some(mut core) = cortex_m::Peripherals::take() else {
        return;
    };
    // SAFETY: no critical section relies on priorities: all of them mask every interrupt.
    unsafe {
        core.SCB.set_priority(SystemHandler::SysTick, 0x00);
        core.SCB.set_priority(SystemHandler::PendSV, 0xff);
    }
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(timer_hz / 10_000 - 1);
    core.SYST.clear_current();
    core.SYST.enable_interrupt();
    core.SYST.enable_counter();
}

/// The idle loop: what `drain` gives goes to the host; ends QEMU when nothing more comes.
pub fn write_out(mut drain: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
    let mut status = debug::EXIT_FAILURE;
    if let Ok(mut stream) = hstdout() {
        let mut buffer = [0; 4096];
        loop {
            let (count, more) = drain(&mut buffer);
            let bytes = buffer.get(..count).unwrap_or_default();
            if count > 0 && stream.write_all(bytes).is_err() {
                break;
            }
            if !more {
                status = debug::EXIT_SUCCESS;
                break;
            }
        }
    }
    loop {
        debug::exit(status);
    }
}

#[exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

unsafe extern "C" {
    /// Defined nowhere: a reachable panic is a link error with this name.
    safe fn saltus_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    saltus_panic_is_reachable()
}
