//! A1's loops under RTIC, in f64.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[rtic::app(device = saltus_starters::device, peripherals = false, dispatchers = [SPARE0])]
mod app {
    use jump_machine::Inputs;
    use landing::Workspace;
    use saltus_loops::boards::{Board, Mps};
    use saltus_loops::control::Control;
    use saltus_loops::firmware::{RING, write_out};
    use saltus_loops::joints::Joints;
    use saltus_loops::recorder::Recorder;
    use saltus_loops::robot::Robot;

    type A1 = <Mps as Board<f64>>::Robot;

    #[shared]
    struct Shared {
        joints: Joints<f64>,
        recorder: Recorder<RING>,
        over: bool,
    }

    #[local]
    struct Local {
        robot: A1,
        control: Option<Control<'static, f64>>,
    }

    #[init(local = [workspace: Workspace<f64, 12, 4> = Workspace::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let mut systick = cx.core.SYST;
        systick.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        systick.set_reload(<Mps as Board<f64>>::TIMER_HZ / 10_000 - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        let shared = Shared {
            joints: Joints::new(),
            recorder: Recorder::new(),
            over: false,
        };
        let local = Local {
            robot: <Mps as Board<f64>>::robot(),
            control: Control::new(cx.local.workspace),
        };
        (shared, local)
    }

    /// Every 100 µs: encoders in, torques out; every tenth time the control task is asked for a command.
    #[task(binds = SysTick, priority = 3, shared = [joints, recorder, over], local = [robot, ticks: u32 = 0])]
    fn joint_tick(cx: joint_tick::Context) {
        let joint_tick::LocalResources { robot, ticks, .. } = cx.local;
        let mut shared = (cx.shared.joints, cx.shared.recorder, cx.shared.over);
        shared.lock(|joints, recorder, over| {
            if *over {
                return;
            }
            if ticks.is_multiple_of(10) {
                // Refused while the last command is still being made: then the joints keep the one before.
                let _late = control_tick::spawn(robot.sensors()).is_err();
            }
            *ticks = ticks.wrapping_add(1);
            let heard = robot.encoders();
            let torques = joints.tick(&heard.0, &heard.1);
            recorder.record(b'j', joints.number, &heard, &torques);
            robot.drive(&torques);
            if robot.is_over() {
                *over = true;
                recorder.end();
            }
        });
    }

    /// Every millisecond, as long as the joint task leaves time: a command.
    #[task(priority = 1, shared = [joints, recorder], local = [control])]
    async fn control_tick(cx: control_tick::Context, heard: Inputs<f64, 12, 4>) {
        let Some(control) = cx.local.control else {
            return;
        };
        control.tick(&heard);
        let command = control.command();
        let mut shared = (cx.shared.joints, cx.shared.recorder);
        shared.lock(|joints, recorder| {
            recorder.record(b'c', joints.number, &heard, command);
            joints.give(command);
        });
    }

    /// The flight recorder goes out when nothing else is to do.
    #[idle(shared = [recorder, over])]
    fn idle(cx: idle::Context) -> ! {
        let idle::SharedResources {
            mut recorder,
            mut over,
            ..
        } = cx.shared;
        write_out(|out| {
            (&mut recorder, &mut over).lock(|recorder, over| {
                let count = recorder.take(out);
                (count, !(*over && count < out.len()))
            })
        })
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
