//! A1 hops on the spot: its whole body is planned, joints, torques and forces at once.
//!
//! `cargo run --release -p wb-opt --example hop`

use a1_model::{A1Reference, a1_reference::frame};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{SparseStage, Status};
use wb_opt::{BASE, Foot, Friction, Phase, Pose, Problem, Robot, State, Weights, row_capacity};

const N: usize = 18;
const NI: usize = row_capacity(N, 4, 4, 0, false);

/// Point feet under the hips.
fn feet() -> [Foot<f64>; 4] {
    let frames = [
        frame::FL_FOOT,
        frame::FR_FOOT,
        frame::RL_FOOT,
        frame::RR_FOOT,
    ];
    core::array::from_fn(|i| Foot {
        point: Robot::<f64, N>::point(&frames[i]),
        pos_wf: Vector3::new(
            if i < 2 { 0.18 } else { -0.18 },
            if i % 2 == 0 { 0.13 } else { -0.13 },
            0.0,
        ),
        radius: 0.0,
    })
}

fn main() -> Result<(), wb_opt::Error> {
    // A hop on the spot: 0.25 s on four feet, 0.15 s in the air.
    let joints = [0.0, 0.9, -1.8];
    let crouch = Pose::level(core::array::from_fn(|i| match i {
        2 => 0.25,
        0..BASE => 0.0,
        _ => joints[i % 3],
    }));
    let phases = [
        Phase {
            contacts: [true; 4],
            intervals: 25,
            dt: 0.01,
            weight: 1.0,
        },
        Phase {
            contacts: [false; 4],
            intervals: 15,
            dt: 0.01,
            weight: 1.0,
        },
    ];
    let reference = vec![crouch; 40];
    let problem = Problem {
        robot: Robot::on_free_base(&A1Reference),
        feet: feet(),
        clearances: &[],
        apart: &[],
        swing_height: -0.01,
        swing_rise: 0.0,
        edge: None,
        phases: &phases,
        reference: &reference,
        start: crouch,
        goal: crouch,
        goal_tolerance: [0.02; BASE],
        least_force: 0.0,
        release: f64::INFINITY,
        max_force: f64::INFINITY,
        landing_intervals: 5,
        friction_smoothing: 0.5,
        friction: Friction::pyramid(0.6),
        drift: 0.01,
        weights: Weights {
            position: 1.0,
            effort: 1e-4,
            goal: 10.0,
        },
    };
    let mut stages: Vec<SparseStage<f64, State<f64, N>, 36, 30, NI>> =
        vec![SparseStage::sparse(State::at_rest(crouch)); 41];
    let weight = Vector3::new(0.0, 0.0, 12.453 * 9.81 / 4.0);
    problem.write_guess(&mut stages, &vec![crouch; 41], |_, _| weight, || 0.0);
    let solution = problem.plan(&wb_opt::settings(), &mut stages, |_| {
        ControlFlow::Continue(())
    })?;
    println!(
        "{:?} after {} iterations",
        solution.status, solution.iterations
    );
    assert_eq!(solution.status, Status::Solved);
    let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    assert!(judged.max_violation < 2e-6 && judged.peak_effort <= 33.5 + 1e-6);
    println!(
        "peak torque {:.1} N m, violation {:.0e}",
        judged.peak_effort, judged.max_violation
    );
    for (k, stage) in stages.iter().enumerate().step_by(8) {
        println!(
            "{:.2} s: trunk at {:.3} m",
            k as f64 * 0.01,
            stage.state.q[2]
        );
    }
    Ok(())
}
