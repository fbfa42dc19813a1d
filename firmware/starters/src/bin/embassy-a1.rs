//! A1's loops under Embassy, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod app {
    use core::cell::RefCell;

    use cortex_m::peripheral::scb::SystemHandler;
    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_rt::{entry, exception};
    use embassy_executor::{Executor, InterruptExecutor};
    use embassy_sync::blocking_mutex::Mutex;
    use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
    use embassy_sync::signal::Signal;
    use jump_machine::Inputs;
    use landing::Workspace;
    use saltus_loops::boards::{Board, Mps};
    use saltus_loops::control::Control;
    use saltus_loops::firmware::{RING, write_out};
    use saltus_loops::joints::Joints;
    use saltus_loops::recorder::Recorder;
    use saltus_loops::robot::Robot;
    use saltus_starters::device::Interrupt;
    use static_cell::StaticCell;

    struct Shared {
        robot: <Mps as Board<f64>>::Robot,
        joints: Joints<f64>,
        recorder: Recorder<RING>,
        ticks: u32,
        over: bool,
    }

    static SHARED: Mutex<CriticalSectionRawMutex, RefCell<Option<&'static mut Shared>>> =
        Mutex::new(RefCell::new(None));
    /// What the control task is to hear; a newer one takes the place of one that it had no time for.
    static HEARD: Signal<CriticalSectionRawMutex, Inputs<f64, 12, 4>> = Signal::new();
    static CONTROL: InterruptExecutor = InterruptExecutor::new();

    /// Runs `work` on what the loops share.
    fn with<O>(work: impl FnOnce(&mut Shared) -> O) -> Option<O> {
        SHARED.lock(|cell| cell.try_borrow_mut().ok()?.as_deref_mut().map(work))
    }

    /// Every 100 µs: encoders in, torques out; every tenth time the control task is given something to hear.
    #[exception]
    fn SysTick() {
        with(|s| {
            if s.over {
                return;
            }
            if s.ticks.is_multiple_of(10) {
                HEARD.signal(s.robot.sensors());
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

    #[unsafe(no_mangle)]
    extern "C" fn SPARE0() {
        // SAFETY: this is the interrupt that the executor was started with.
        unsafe { CONTROL.on_interrupt() }
    }

    /// A command for each thing heard.
    #[embassy_executor::task]
    async fn control_loop(control: &'static mut Control<'static, f64>) {
        loop {
            let heard = HEARD.wait().await;
            control.tick(&heard);
            let command = control.command();
            with(|s| {
                s.recorder.record(b'c', s.joints.number, &heard, command);
                s.joints.give(command);
            });
        }
    }

    /// The flight recorder goes out when nothing else is to do.
    #[embassy_executor::task]
    async fn write_recording() {
        write_out(|out| {
            with(|s| {
                let count = s.recorder.take(out);
                (count, !(s.over && count < out.len()))
            })
            .unwrap_or((0, true))
        })
    }

    #[entry]
    fn main() -> ! {
        static WORKSPACE: StaticCell<Workspace<f64, 12, 4>> = StaticCell::new();
        static MACHINE: StaticCell<Control<'static, f64>> = StaticCell::new();
        static LOOPS: StaticCell<Shared> = StaticCell::new();
        static THREAD: StaticCell<Executor> = StaticCell::new();

        let shared = LOOPS.init(Shared {
            robot: <Mps as Board<f64>>::robot(),
            joints: Joints::new(),
            recorder: Recorder::new(),
            ticks: 0,
            over: false,
        });
        SHARED.lock(|cell| cell.replace(Some(shared)));
        if let (Some(mut core), Some(control)) = (
            cortex_m::Peripherals::take(),
            Control::new(WORKSPACE.init(Workspace::new())),
        ) {
            // SAFETY: no critical section relies on priorities: all of them mask every interrupt.
            unsafe {
                core.SCB.set_priority(SystemHandler::SysTick, 0x00);
                core.NVIC.set_priority(Interrupt::SPARE0, 0xe0);
            }
            if let Ok(task) = control_loop(MACHINE.init(control)) {
                CONTROL.start(Interrupt::SPARE0).spawn(task);
            }
            core.SYST.set_clock_source(SystClkSource::Core);
            core.SYST
                .set_reload(<Mps as Board<f64>>::TIMER_HZ / 10_000 - 1);
            core.SYST.clear_current();
            core.SYST.enable_interrupt();
            core.SYST.enable_counter();
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
