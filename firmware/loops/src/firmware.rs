//! Two interrupts and an idle loop.
//!
//! SysTick, at 10 kHz and above everything, reads encoders and drives the motors. Every tenth time it reads the other sensors and
//! pends `PendSV`, which is below everything: the 1 kHz control tick, which SysTick interrupts as often as it must. A command
//! is in force from the moment it is complete.

use core::cell::RefCell;

use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use saltus_probe::Real;

use crate::control::Control;
use crate::robot::Robot;
use crate::shared::Shared;

/// A place for what an interrupt owns.
pub type Slot<T> = Mutex<RefCell<Option<&'static mut T>>>;

/// A place for what the joint loop hands to the control loop.
pub type Mailbox<H> = Mutex<RefCell<Option<H>>>;

/// Runs `work` on what is in the slot, if it is there.
fn with<T, O>(slot: &'static Slot<T>, work: impl FnOnce(&mut T) -> O) -> Option<O> {
    interrupt::free(|token| {
        let mut slot = slot.borrow(token).try_borrow_mut().ok()?;
        slot.as_deref_mut().map(work)
    })
}

/// Puts something into its place; what was there is lost.
pub fn put<T>(place: &'static Mutex<RefCell<Option<T>>>, value: T) {
    interrupt::free(|token| {
        if let Ok(mut place) = place.borrow(token).try_borrow_mut() {
            *place = Some(value);
        }
    });
}

/// Takes what is in a place.
fn take<T>(place: &'static Mutex<RefCell<Option<T>>>) -> Option<T> {
    interrupt::free(|token| place.borrow(token).try_borrow_mut().ok()?.take())
}

/// The joint tick, at 10 kHz.
pub fn joint_tick<T: Real, R: Robot<T, N>, const N: usize>(
    shared: &'static Slot<Shared<T, R, N>>,
    mailbox: &'static Mailbox<R::Heard>,
) {
    if let Some(heard) = with(shared, Shared::joint_tick).flatten() {
        put(mailbox, heard);
        SCB::set_pendsv();
    }
}

/// The control tick, at 1 kHz, below the joint tick.
pub fn control_tick<T: Real, R: Robot<T, N>, C: Control<T, N, Heard = R::Heard>, const N: usize>(
    shared: &'static Slot<Shared<T, R, N>>,
    mailbox: &'static Mailbox<R::Heard>,
    control: &'static Slot<C>,
) {
    // Out of its slot while it works, so that interrupts stay enabled.
    let (Some(heard), Some(taken)) = (take(mailbox), take(control)) else {
        return;
    };
    taken.tick(&heard);
    with(shared, |shared| shared.give(&heard, taken.command()));
    put(control, taken);
}

/// Some bytes of the recorder, and whether more will come.
pub fn drain<T: Real, R: Robot<T, N>, const N: usize>(
    shared: &'static Slot<Shared<T, R, N>>,
    out: &mut [u8],
) -> (usize, bool) {
    with(shared, |shared| shared.drain(out)).unwrap_or((0, true))
}

/// An image: entry, interrupts and statics of a control loop for `N` joints in one scalar on one board.
#[macro_export]
macro_rules! image {
    ($T:ty, $N:literal, $Control:ty, $Board:ty) => {
        use core::cell::RefCell;

        use cortex_m::interrupt::Mutex;
        use cortex_m_rt::{entry, exception};
        use $crate::boards::Board;
        use $crate::control::Control;
        use $crate::firmware::{self, Mailbox, Slot};
        use $crate::shared::Shared;

        type Loops = Shared<$T, <$Board as Board<$T, $N>>::Robot, $N>;
        type Memory = <$Control as Control<$T, $N>>::Memory;

        static SHARED: Slot<Loops> = Mutex::new(RefCell::new(None));
        static CONTROL: Slot<$Control> = Mutex::new(RefCell::new(None));
        static HEARD: Mailbox<<$Control as Control<$T, $N>>::Heard> =
            Mutex::new(RefCell::new(None));

        #[entry]
        fn main() -> ! {
            let memory =
                cortex_m::singleton!(: Memory = <$Control as Control<$T, $N>>::memory());
            let control = memory.and_then(<$Control as Control<$T, $N>>::new);
            let control = control.and_then(|it| cortex_m::singleton!(: $Control = it));
            if let (Some(control), Some(mut core)) = (control, cortex_m::Peripherals::take()) {
                let robot = <$Board as Board<$T, $N>>::robot(&mut core);
                let joints = <$Control as Control<$T, $N>>::joints();
                if let Some(shared) = cortex_m::singleton!(: Loops = Shared::new(robot, joints)) {
                    firmware::put(&CONTROL, control);
                    firmware::put(&SHARED, shared);
                    firmware::start(&mut core, <$Board as Board<$T, $N>>::TIMER_HZ);
                }
            }
            <$Board as Board<$T, $N>>::idle(|out| firmware::drain(&SHARED, out))
        }

        #[exception]
        fn SysTick() {
            firmware::joint_tick(&SHARED, &HEARD);
        }

        #[exception]
        fn PendSV() {
            firmware::control_tick(&SHARED, &HEARD, &CONTROL);
        }

        #[exception]
        unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
            <$Board as Board<$T, $N>>::fault()
        }
    };
}

/// Starts the joint loop above everything and the control loop below everything.
pub fn start(core: &mut cortex_m::Peripherals, timer_hz: u32) {
    // SAFETY: no critical section relies on priorities: all of them mask every interrupt.
    unsafe {
        core.SCB.set_priority(SystemHandler::SysTick, 0x00);
        core.SCB.set_priority(SystemHandler::PendSV, 0xff);
    }
    start_clock(&mut core.SYST, timer_hz);
}

/// Lets SysTick interrupt at 10 kHz; its clock has `timer_hz`.
pub fn start_clock(timer: &mut SYST, timer_hz: u32) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(timer_hz / 10_000 - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
}

unsafe extern "C" {
    /// Defined nowhere: a reachable panic is a link error with this name.
    safe fn saltus_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    saltus_panic_is_reachable()
}
