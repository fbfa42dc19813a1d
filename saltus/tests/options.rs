//! Options that do not apply to what is asked are refused, with what does, and nothing is left behind.

use core::time::Duration;
use std::fs;

/// A command line, and words that the answer must hold.
type Case = (&'static [&'static str], &'static [&'static str]);

const RUNS: &[Case] = &[
    (
        &["run", "a1/lateral", "--height", "0.1"],
        &["--height", "icub/velocity", "goal_m"],
    ),
    (
        &["run", "a1/lateral", "--no-momentum"],
        &["--no-momentum", "humanoid"],
    ),
    (
        &["run", "a1/lateral", "--torque-share", "1"],
        &["--torque-share", "humanoid"],
    ),
    (
        &["run", "a1/lateral", "--landing", "qp"],
        &["--landing", "humanoid"],
    ),
    (
        &["run", "icub/velocity", "--planner", "whole-body"],
        &["--planner", "quadruped", "--height"],
    ),
    (
        &["run", "icub/velocity", "--task", "a1/lateral"],
        &["--task", "quadruped"],
    ),
    (
        &["run", "icub/torque", "--interface", "joint-pd"],
        &["--interface", "torques"],
    ),
    (
        &["verdicts", "icub/velocity", "--interface", "joint-pd"],
        &["--interface", "torques"],
    ),
];

const PLANS: &[Case] = &[
    (
        &["plan", "a1/lateral", "--stage", "srb"],
        &["--stage", "cannot be used with"],
    ),
    (
        &["plan", "a1/lateral", "--barrier", "monotone"],
        &["--barrier", "cannot be used with"],
    ),
    (
        &["plan", "a1/lateral", "--guess-noise", "0.1"],
        &["--guess-noise", "cannot be used with"],
    ),
    (
        &["plan", "a1/lateral", "--seed", "2"],
        &["--seed", "cannot be used with"],
    ),
    (
        &["plan", "a1/lateral", "--repeat", "2"],
        &["--repeat", "cannot be used with"],
    ),
    (
        &["plan", "--reference", "spin", "--srb", "s.json"],
        &["--srb", "--stage whole-body"],
    ),
    (
        &["plan", "--reference", "spin", "--out", "new"],
        &["--out", "cannot be used with"],
    ),
    (
        &["plan", "--reference", "spin", "--robot", "r.urdf"],
        &["--robot", "cannot be used with"],
    ),
    (
        &["plan", "--reference", "spin", "--timing", "0.5,0.3"],
        &["--timing", "cannot be used with"],
    ),
    (
        &["plan", "--problem", "p.json", "--direct"],
        &["--direct", "cannot be used with"],
    ),
];

const OTHERS: &[Case] = &[
    (
        &["import", "r.urdf", "--package", "r"],
        &["--package", "--out"],
    ),
    (
        &["import", "r.urdf", "--rbd-core", "0.1"],
        &["--rbd-core", "--out"],
    ),
    (&["import", "r.urdf", "--member"], &["--member", "--out"]),
    (
        &["import", "r.urdf", "--licence", "MIT"],
        &["--licence", "--out"],
    ),
    (
        &["verdicts", "--ranges", "--json"],
        &["--ranges", "cannot be used with"],
    ),
    (
        &["verdicts", "--ranges", "a1/lateral"],
        &["--ranges", "cannot be used with"],
    ),
    (
        &["verdicts", "--agreement", "--sim", "native"],
        &["--agreement", "cannot be used with"],
    ),
    (
        &["plan", "--reference", "spin", "--guess-noise", "nan"],
        &["--guess-noise", "0 to 10"],
    ),
];

#[test]
fn options_that_do_not_apply_are_refused_with_what_does() {
    let folder = crate::command::folder("options");
    for (arguments, words) in [RUNS, PLANS, OTHERS].concat() {
        crate::refused::refused(Duration::from_secs(60), &folder, arguments, words);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}
