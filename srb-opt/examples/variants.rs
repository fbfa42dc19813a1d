//! Solves many random jumps of the reference problem's form and says which fail.
//!
//! `cargo run --release -p srb-opt --features bench --example variants -- [how many] [first seed] [noisy guesses each]`
//! `… -- --file SEED` prints a jump as a problem file for `saltus plan --problem` and `tests/peers/srb_ratio.py`.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "a program for the host"
)]

#[path = "../tests/variants/mod.rs"]
mod variants;

use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{Settings, Stage, Status};
use srb_opt::State;
use srb_opt::onboard::{FEET, Jump, PHASES};
use srb_opt::{Phase, Reference};
use std::time::Instant;
use variants::{Draw, variant};

/// Offset of the leg's plane from the hip joint and its direction per leg, as in the reference problems.
const LINK: f64 = 0.0838;
const SIDE: [f64; FEET] = [1.0, -1.0, 1.0, -1.0];

type Stages = Vec<Stage<f64, State<f64, PHASES>, 16, 12, 40>>;

fn solve(
    jump: &Jump<f64>,
    stages: &mut Stages,
    noise: f64,
    seed: u64,
) -> (Status, f64, usize, usize, usize) {
    let mut draw = Draw(seed);
    jump.write_guess(stages, || {
        if noise > 0.0 {
            noise * draw.normal()
        } else {
            0.0
        }
    });
    let go = |_: &_| ControlFlow::Continue(());
    let found = jump.plan(&Settings::new(), stages, go).unwrap();
    let judged = jump.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    let honest = found.status != Status::Solved || judged.max_violation < 1e-6;
    assert!(
        honest,
        "called solved with violation {:e}",
        judged.max_violation
    );
    let work = found.factorisations;
    (
        found.status,
        judged.cost,
        found.iterations,
        found.restarts,
        work,
    )
}

/// The jump as a problem file, in the layout that `saltus plan --problem` and `tests/peers/srb_ratio.py` read.
fn problem_file(jump: &Jump<f64>) -> String {
    use core::fmt::Write as _;
    let phases = jump.used_phases();
    let feet = |flags: &[bool; FEET]| -> Vec<usize> { (0..FEET).filter(|i| flags[*i]).collect() };
    let list = |value: &dyn Fn(&Phase<f64, FEET>) -> f64| -> Vec<f64> {
        phases.iter().map(value).collect()
    };
    let stands: Vec<_> = phases.iter().map(|phase| feet(&phase.contacts)).collect();
    let counts: Vec<_> = phases.iter().map(|phase| phase.intervals).collect();
    let turns = match jump.reference {
        Reference::Linear => "null".to_owned(),
        Reference::PerPhase => format!("{:?}", list(&|phase| phase.reference_angle)),
    };
    let (drop, edge) = jump.edge.map_or((0.0, "null".to_owned()), |edge| {
        (
            edge.drop,
            format!("[{}, {:?}, {:?}]", edge.axis, edge.sign, edge.distance),
        )
    });
    let inertia: Vec<Vec<f64>> = (0..3)
        .map(|i| (0..3).map(|j| jump.inertia_b[(i, j)]).collect())
        .collect();
    let points = |points: &[Vector3<f64>]| -> Vec<Vec<f64>> {
        points.iter().map(|p| p.iter().copied().collect()).collect()
    };
    let feet0: Vec<_> = jump.feet.iter().map(|foot| foot.pos_wf).collect();
    let hips: Vec<_> = jump
        .feet
        .iter()
        .zip(SIDE)
        .map(|(foot, side)| foot.nominal_b - Vector3::y() * (side * LINK))
        .collect();
    let (low, high) = (jump.reach_lower, jump.reach_upper);
    let goal = jump.goal_w - jump.start_w;
    let mut out = String::from("{\"constants\": {");
    let _ = write!(
        out,
        "\"M\": {:?}, \"I_B\": {inertia:?}, \"G\": {:?}, \"L1\": {LINK:?}, \"HIP\": {:?}, \"SIDE\": {SIDE:?}, ",
        jump.mass,
        jump.gravity,
        points(&hips)
    );
    let _ = write!(
        out,
        "\"FEET0\": {:?}, \"CORNERS\": {:?}, \"Z0\": {:?}, ",
        points(&feet0),
        points(&jump.corners),
        jump.start_w.z
    );
    let _ = write!(
        out,
        "\"MU\": {:?}, \"FZ_MAX\": {:?}, \"REACH_X\": {:?}, \"REACH_Y\": {:?}, \"REACH_Z\": [{:?}, {:?}], ",
        jump.friction, jump.max_force, high.x, high.y, low.z, high.z
    );
    let _ = write!(
        out,
        "\"T_LO\": {:?}, \"T_HI\": {:?}, \"TTOT_LO\": {:?}, \"CLEAR\": {:?}, ",
        phases[0].min_duration, phases[0].max_duration, jump.min_total, jump.clearance
    );
    let _ = write!(
        out,
        "\"EPS_W\": {:?}, \"EPS_F\": {:?}, \"EPS_R\": {:?}, \"EPS_LOG\": {:?}, \"EDGE_W\": 0.03, \"TAU_MAX\": 33.5, \"QD_MAX\": 21.0}}, ",
        jump.weights.omega, jump.weights.force, jump.weights.rotation, jump.log_epsilon
    );
    let _ = write!(
        out,
        "\"tasks\": {{\"variant\": {{\"phases\": {stands:?}, \"N\": {counts:?}, \"T0\": {:?}, \"goal\": [{:?}, {:?}, {:?}], ",
        list(&|phase| phase.duration_guess),
        goal.x,
        goal.y,
        goal.z
    );
    let _ = write!(
        out,
        "\"axis\": [{:?}, {:?}, {:?}], \"angle\": {:?}, \"bp\": {turns}, \"box\": {drop:?}, \"edge\": {edge}, \"euler\": \"zyx\", \"ttot\": {:?}}}}}}}",
        jump.axis.x, jump.axis.y, jump.axis.z, jump.angle, jump.max_total
    );
    out
}

fn main() {
    if std::env::args().nth(1).as_deref() == Some("--file") {
        let seed = std::env::args().nth(2).unwrap().parse().unwrap();
        println!("{}", problem_file(&variant(seed).0));
        return;
    }
    let number = |i: usize, otherwise: u64| {
        std::env::args()
            .nth(i)
            .map_or(otherwise, |text| text.parse().unwrap())
    };
    let (count, first, noisy) = (number(1, 100), number(2, 1), number(3, 0));
    let (mut solved, mut restarted, mut iterations) = (0, 0, Vec::new());
    let (mut good, mut tries, mut factorisations) = (0, 0, 0);
    for seed in first..first + count {
        let (jump, text) = variant(seed);
        let mut stages: Stages = vec![Stage::new(State::new()); jump.intervals() + 1];
        let start = Instant::now();
        let (status, cost, steps, restarts, work) = solve(&jump, &mut stages, 0.0, 0);
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let durations = stages[0].state.durations;
        if status == Status::Solved {
            solved += 1;
            restarted += usize::from(restarts > 0);
            iterations.push(steps);
            factorisations += work;
        }
        let mut noise = String::new();
        if noisy > 0 && status == Status::Solved {
            let runs: Vec<_> = (1..=noisy)
                .map(|i| solve(&jump, &mut stages, 0.1, i))
                .collect();
            let found = runs
                .iter()
                .filter(|run| run.0 == Status::Solved)
                .map(|run| run.1);
            let best = found.fold(cost, f64::min);
            let reach = |run: &&(Status, f64, usize, usize, usize)| {
                run.0 == Status::Solved && run.1 <= 1.001 * cost
            };
            let reached = runs.iter().filter(reach).count();
            (good, tries) = (good + reached, tries + runs.len());
            noise = format!("; {reached}/{noisy} noisy, best {best:.4}");
            for run in runs.iter().filter(|run| !reach(run)) {
                noise += &format!(", {:?} {:.4} after {}", run.0, run.1, run.2);
            }
        }
        if status != Status::Solved || restarts > 0 || !noise.is_empty() {
            println!(
                "{seed}: {status:?} {steps} it ({restarts} restarts) {ms:.0} ms cost {cost:.4} T {durations:.3?}: {text}{noise}"
            );
        }
    }
    iterations.sort_unstable();
    let median = iterations.get(iterations.len() / 2).copied().unwrap_or(0);
    let most = iterations.last().copied().unwrap_or(0);
    println!(
        "{solved} of {count} solved, {restarted} of them after a restart; iterations {median} in the median, {most} at most; {:.1} factorisations in the mean",
        factorisations as f64 / f64::from(solved.max(1))
    );
    if tries > 0 {
        println!("{good} of {tries} noisy guesses reach the cost of the plain one");
    }
}
