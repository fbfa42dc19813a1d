//! The nine problems on the whole body, judged against IPOPT's costs.

use crate::common::{assert_reaches, mine};
use core::ops::ControlFlow;
use ocp_solver::Barrier;
use reference_problems::{Answer, File, SHIPPED, SrbMotion, shipped};

/// Cost that CasADi + IPOPT reach on the same problem, midpoint.
const IPOPT: [(&str, f64); 9] = [
    ("lateral", 2.170),
    ("lateral_down", 2.463),
    ("spin", 9.883),
    ("diagonal", 15.192),
    ("barrel", 8.307),
    ("double_barrel", 10.247),
    ("double_backflip", 18.243),
    ("forward", 10.716),
    ("barrel_box", 7.437),
];

fn solve(file: &File, name: &str, srb: &str) -> Answer {
    let go = |_: &_| ControlFlow::Continue(());
    let srb = SrbMotion::parse(srb).unwrap();
    file.solve_whole_body(name, &srb, Barrier::Portfolio, || 0.0, go)
        .unwrap()
}

#[test]
fn all_nine_reach_the_reference_cost_without_violation() {
    let file = File::parse(SHIPPED).unwrap();
    for (task, cost) in IPOPT {
        let answer = solve(&file, task, shipped(task).unwrap());
        assert_reaches(&answer, cost);
        assert!(answer.peaks.unwrap()[1] <= 33.5 + 1e-6, "{task}");
    }
}

#[test]
fn a_solution_in_the_checkers_layout_meets_the_equations_of_motion() {
    let file = File::parse(SHIPPED).unwrap();
    let file = solve(&file, "spin", shipped("spin").unwrap()).solution;
    assert_eq!(file["integ"], "mid");
    let sol = &file["sol"];
    let rows = |key: &str| sol[key].as_array().unwrap().len();
    assert_eq!(
        [rows("q"), rows("v"), rows("a"), rows("tau"), rows("F")],
        [90; 5]
    );
    // Yaw is the sixth coordinate of the checkers, and the one that spins: midpoint of the last interval.
    let yaw = sol["q"][89][5].as_f64().unwrap() + 0.005 * sol["v"][89][5].as_f64().unwrap();
    assert!((yaw - core::f64::consts::FRAC_PI_2).abs() <= 0.05 + 1e-6);
    // Over all feet and intervals the momentum that forces and gravity give is that of the motion.
    let x = |key: &str, k: usize, i: usize| sol[key][k][i].as_f64().unwrap();
    let force = |k: usize, foot: usize| sol["F"][k][foot][2].as_f64().unwrap();
    let forces = (0..90).flat_map(|k| (0..4).map(move |foot| force(k, foot)));
    let lift = forces.sum::<f64>() * 0.01 / 12.453 - 9.81 * 0.9;
    let fall = x("v", 89, 2) + 0.005 * x("a", 89, 2);
    // The legs rest in the end, so the trunk moves as the centre of mass does; the midpoint rule keeps the
    // momentum to second order.
    assert!((lift - fall).abs() < 3e-3, "{lift} {fall}");
}

#[test]
fn a_problem_file_is_planned_from_its_own_rigid_body() {
    let file = mine(|file| file["constants"]["TAU_MAX"] = 30.0.into());
    let go = |_: &_| ControlFlow::Continue(());
    let body = file.solve_srb("mine", Barrier::Portfolio, || 0.0, go);
    let answer = solve(&file, "mine", &body.unwrap().solution.to_string());
    assert_reaches(&answer, f64::INFINITY);
    assert!(answer.peaks.unwrap()[1] <= 30.0 + 1e-6);
}
