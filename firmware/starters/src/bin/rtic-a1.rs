//! A1's loops under RTIC, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(
    clippy::result_large_err,
    reason = "RTIC gives back what a task that is busy was to hear"
)]

#[cfg(target_os = "none")]
#[rtic::app(device = saltus_starters::device, peripherals = false, dispatchers = [SPARE0])]
mod app {
    use jump_machine::Observation;
    use jump_machine::Workspace;
    use saltus_loops::boards::{Board, Mps};
    use saltus_loops::control::{Control, Jumper};
    use saltus_loops::firmware::start_clock;
    use saltus_loops::semihosting::write_out;

    type A1 = <Mps as Board<f64, 12>>::Robot;

    #[shared]
    struct Shared {
        loops: saltus_loops::shared::Shared<f64, A1, 12>,
    }

    #[local]
    struct Local {
        control: Option<Jumper<f64>>,
    }

    #[init(local = [workspace: Workspace<f64, 12, 4> = Workspace::new()])]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        let robot = <Mps as Board<f64, 12>>::robot(&mut cx.core);
        start_clock(&mut cx.core.SYST, <Mps as Board<f64, 12>>::TIMER_HZ);
        let loops = saltus_loops::shared::Shared::new(robot, Jumper::joints());
        let control = Jumper::new(cx.local.workspace);
        (Shared { loops }, Local { control })
    }

    /// Every 100 µs: encoders in, torques out; every tenth time the control task is asked for a command.
    #[task(binds = SysTick, priority = 3, shared = [loops])]
    fn joint_tick(mut cx: joint_tick::Context) {
        if let Some(heard) = cx.shared.loops.lock(|loops| loops.joint_tick()) {
            // Refused while the last command is still being made: then the joints keep the one before.
            let _late = control_tick::spawn(heard).is_err();
        }
    }

    /// Every millisecond, as long as the joint task leaves time: a command.
    #[task(priority = 1, shared = [loops], local = [control])]
    async fn control_tick(mut cx: control_tick::Context, heard: Observation<f64, 12, 4>) {
        if let Some(control) = cx.local.control {
            control.tick(&heard);
            cx.shared
                .loops
                .lock(|loops| loops.give(&heard, control.command()));
        }
    }

    /// The flight recorder goes out when nothing else is to do.
    #[idle(shared = [loops])]
    fn idle(mut cx: idle::Context) -> ! {
        write_out(|out| cx.shared.loops.lock(|loops| loops.drain(out)))
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
