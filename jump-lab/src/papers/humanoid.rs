//! Paper B: the jumps of iCub.

use super::{Row, Watch};
use crate::Sim;
use crate::humanoid::execute::{self, Run};
use crate::humanoid::judge::Judged;
use crate::humanoid::{GRAVITY, Landing, Task};
use crate::lab::Disturbance;
use core::ops::ControlFlow;
use jump_control::takeoff_speed;

fn run(task: &Task, sim: Sim) -> Result<Run, String> {
    execute::run(task, sim, &Disturbance::NOMINAL, 0, |_, _| {})
}

/// All rows.
pub(super) fn rows(sims: &[Sim], rows: &mut Vec<Row>, watch: &mut impl Watch) -> ControlFlow<()> {
    rows.extend(takeoff());
    for &sim in sims {
        for (name, item, theirs, com, soles) in [
            (
                "icub/velocity",
                "Fig. 2, velocity control",
                "3.5 cm, soles 3.7 cm",
                0.035,
                0.037,
            ),
            (
                "icub/torque",
                "Fig. 3, torque control",
                "1.6 cm, soles 2.3 cm",
                0.016,
                0.023,
            ),
        ] {
            watch.next(name)?;
            let row = Row::new('B', format!("{item}: height of 4 cm asked for"), theirs);
            let row = row.simulated(sim);
            let Some(task) = Task::named(name) else {
                continue;
            };
            let free = Task {
                momentum: false,
                ..task
            };
            match (run(&task, sim), run(&free, sim)) {
                (Ok(held), Ok(free)) => {
                    rows.extend(jump(row, &task, &held, &free, sim, [com, soles]));
                    let name = format!("{}-{}", name.replace('/', "-"), sim.name());
                    watch.pushed(&name, &task, sim, [&held, &free]);
                }
                (Err(error), _) | (_, Err(error)) => rows.push(row.failed(error)),
            }
        }
    }
    for &sim in sims {
        for name in ["icub/velocity", "icub/torque"] {
            watch.next("paper B's own landing")?;
            rows.extend(own_landing(name, sim));
        }
    }
    rows.push(
        Row::new(
            'B',
            "Fig. 4, the real robot",
            "3 cm by velocity; none by torque",
        )
        .unjudged(
            "no robot here",
            "quoted; simulation cannot judge a claim about hardware",
        ),
    );
    ControlFlow::Continue(())
}

/// III-F: minimum jerk in the air and stiff servos on the ground, as the paper lands.
fn own_landing(name: &str, sim: Sim) -> Option<Row> {
    let task = Task {
        landing: Landing::Stiff,
        ..Task::named(name)?
    };
    let row = Row::new(
        'B',
        format!("III-F, {name}: landing of the paper, minimum jerk and a stiff hold"),
        "lands",
    )
    .simulated(sim);
    Some(match run(&task, sim) {
        Ok(run) => {
            let verdict = Judged::of(&task, &run).verdict;
            let found = format!(
                "{}, asks for {:.1} of a torque limit",
                verdict.first(),
                run.landing_demand
            );
            row.ours(
                found,
                verdict.on_target(),
                "holds when the jump is on target",
            )
        }
        Err(error) => row.failed(error),
    })
}

/// II-D and III-A: figures without a simulator.
fn takeoff() -> Vec<Row> {
    let row = Row::new(
        'B',
        "II-D, III-A, Fig. 1, 5: take-off of a jump of 4 cm with a push-off of 11 cm",
        "0.89 m/s after 0.43 s",
    );
    let profile = Task::named("icub/velocity").map(|task| task.profile());
    vec![match profile {
        Some(Ok(profile)) => row.ours(
            format!("{:.3} m/s after {:.3} s", profile.speed, profile.duration),
            (profile.speed - 0.89).abs() < 0.01 && (profile.duration - 0.43).abs() < 0.01,
            "holds when both agree to a hundredth",
        ),
        Some(Err(error)) => row.failed(error),
        None => row.failed("no such task"),
    }]
}

/// The rows of one controller: height, take-off speed, rotation.
fn jump(row: Row, task: &Task, held: &Run, free: &Run, sim: Sim, theirs: [f64; 2]) -> Vec<Row> {
    let (ours, loose) = (Judged::of(task, held), Judged::of(task, free));
    let [com, soles] = theirs;
    let level = task.name();
    let ballistic = takeoff_speed(ours.com_gain, GRAVITY);
    let ratio = loose.locked_rotation / ours.locked_rotation;
    vec![
        row.ours(
            format!(
                "{:.2} cm, soles {:.2} cm, {}",
                ours.com_gain * 100.0,
                ours.sole_clearance * 100.0,
                ours.verdict.first()
            ),
            ours.com_gain >= com && ours.sole_clearance >= soles && ours.verdict.on_target(),
            "holds when the jump is at least as high as the paper's and on target",
        ),
        Row::new(
            'B',
            format!("II-D, {level}: v = √(2 g Δh)"),
            "no loss in flight",
        )
        .simulated(sim)
        .ours(
            format!(
                "{:.3} m/s at take-off, √(2 g Δh) = {ballistic:.3}",
                ours.takeoff_speed
            ),
            (ours.takeoff_speed - ballistic).abs() < 0.02,
            "holds within 0.02 m/s",
        ),
        Row::new(
            'B',
            format!("IV-C, Fig. 6, eq. (2), (4), (5), {level}: zero angular momentum"),
            "without the constraint the robot rotates in the air",
        )
        .simulated(sim)
        .ours(
            format!(
                "locked rotation {:.2}° with it, {:.1}° without",
                ours.locked_rotation, loose.locked_rotation
            ),
            ours.locked_rotation < 1.5 && ratio >= 4.0,
            "holds when it stays below 1.5° and is four times as large without",
        ),
    ]
}
