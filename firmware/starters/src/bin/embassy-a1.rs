//! A1's loops under Embassy, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod app {
    use core::cell::RefCell;

    use cortex_m::peripheral::scb::SystemHandler;
    use cortex_m_rt::{entry, exception};
    use embassy_executor::{Executor, InterruptExecutor};
    use embassy_sync::blocking_mutex::Mutex;
    use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
    use embassy_sync::signal::Signal;
    use jump_machine::Observation;
    use jump_machine::Workspace;
    use saltus_loops::boards::{Board, Mps};
    use saltus_loops::control::{Control, Jumper};
    use saltus_loops::firmware::start_clock;
    use saltus_loops::semihosting::write_out;
    use saltus_starters::device::Interrupt;
    use static_cell::StaticCell;

    type Shared = saltus_loops::shared::Shared<f64, <Mps as Board<f64, 12>>::Robot, 12>;

    static SHARED: Mutex<CriticalSectionRawMutex, RefCell<Option<&'static mut Shared>>> =
        Mutex::new(RefCell::new(None));
    /// What the control task is to hear; a newer one takes the place of one that it had no time for.
    static HEARD: Signal<CriticalSectionRawMutex, Observation<f64, 12, 4>> = Signal::new();
    static CONTROL: InterruptExecutor = InterruptExecutor::new();

    /// Runs `work` on what the loops share.
    fn with<O>(work: impl FnOnce(&mut Shared) -> O) -> Option<O> {
        SHARED.lock(|cell| cell.try_borrow_mut().ok()?.as_deref_mut().map(work))
    }

    /// Every 100 µs: encoders in, torques out; every tenth time the control task is given something to hear.
    #[exception]
    fn SysTick() {
        if let Some(heard) = with(Shared::joint_tick).flatten() {
            HEARD.signal(heard);
        }
    }

    #[unsafe(no_mangle)]
    extern "C" fn SPARE0() {
        // SAFETY: this is the interrupt that the executor was started with.
        unsafe { CONTROL.on_interrupt() }
    }

    /// A command for each thing heard.
    #[embassy_executor::task]
    async fn control_loop(control: &'static mut Jumper<f64>) {
        loop {
            let heard = HEARD.wait().await;
            control.tick(&heard);
            with(|shared| shared.give(&heard, control.command()));
        }
    }

    /// The flight recorder goes out when nothing else is to do.
    #[embassy_executor::task]
    async fn write_recording() {
        write_out(|out| with(|shared| shared.drain(out)).unwrap_or((0, true)))
    }

    #[entry]
    fn main() -> ! {
        static WORKSPACE: StaticCell<Workspace<f64, 12, 4>> = StaticCell::new();
        static MACHINE: StaticCell<Jumper<f64>> = StaticCell::new();
        static LOOPS: StaticCell<Shared> = StaticCell::new();
        static THREAD: StaticCell<Executor> = StaticCell::new();

        if let (Some(mut core), Some(control)) = (
            cortex_m::Peripherals::take(),
            Jumper::new(WORKSPACE.init(Workspace::new())),
        ) {
            let robot = <Mps as Board<f64, 12>>::robot(&mut core);
            let shared = LOOPS.init(Shared::new(robot, Jumper::joints()));
            SHARED.lock(|cell| cell.replace(Some(shared)));
            // SAFETY: no critical section relies on priorities: all of them mask every interrupt.
            unsafe {
                core.SCB.set_priority(SystemHandler::SysTick, 0x00);
                core.NVIC.set_priority(Interrupt::SPARE0, 0xe0);
            }
            if let Ok(task) = control_loop(MACHINE.init(control)) {
                CONTROL.start(Interrupt::SPARE0).spawn(task);
            }
            start_clock(&mut core.SYST, <Mps as Board<f64, 12>>::TIMER_HZ);
        }
        THREAD.init(Executor::new()).run(|spawner| {
            if let Ok(task) = write_recording() {
                spawner.spawn(task);
            }
        })
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
