//! The nine problems on the single rigid body, judged against IPOPT's costs.

use crate::common::{assert_reaches, changed, mine};
use core::ops::ControlFlow;
use ocp_solver::Barrier;
use reference_problems::{Answer, File, SHIPPED};
use serde_json::json;

/// Cost that CasADi + IPOPT reach on the same problem.
const IPOPT: [(&str, f64); 9] = [
    ("lateral", 2.2332),
    ("a1/lateral-down", 2.4552),
    ("spin", 10.5365),
    ("diagonal", 7.7971),
    ("a1/barrel-roll", 40.6946),
    ("double_barrel", 89.8907),
    ("double_backflip", 65.3745),
    ("forward", 5.4518),
    ("barrel_box", 36.6729),
];

fn solve(file: &File, name: &str) -> Answer {
    let go = |_: &_| ControlFlow::Continue(());
    let name = file.pick(Some(name)).unwrap();
    file.solve_srb(name, Barrier::Portfolio, || 0.0, go)
        .unwrap()
}

#[test]
fn all_nine_reach_the_reference_cost_without_violation() {
    let file = File::parse(SHIPPED).unwrap();
    for (task, cost) in IPOPT {
        assert_reaches(&solve(&file, task), cost);
    }
}

#[test]
fn a_quarter_less_friction_and_a_half_turn_are_solved() {
    // Costs of IPOPT on the same problems.
    let slippery = changed(|file| file["constants"]["MU"] = 0.4.into());
    assert_reaches(&solve(&slippery, "forward"), 6.9209);
    let half_turn = changed(|file| file["tasks"]["spin"]["angle"] = core::f64::consts::PI.into());
    assert_reaches(&solve(&half_turn, "spin"), 63.4513);
}

#[test]
fn a_problem_file_with_other_numbers_is_solved() {
    let file = mine(|file| {
        file["tasks"]["mine"]["goal"] = json!([0.1, 0.1, 0.0]);
        file["constants"]["M"] = 14.0.into();
    });
    assert_eq!(file.pick(None), Ok("mine"));
    assert_reaches(&solve(&file, "mine"), f64::INFINITY);
}
