//! The bounds beside the solver.

use core::ops::ControlFlow;
use jump_planner::bounds::impossible;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use jump_planner::task::file::{BUILT_IN, TaskFile};
use ocp_solver::{Settings, Status};
use proptest::prelude::*;

/// Whether the solver finds a plan.
fn solves(task: &Task) -> bool {
    let mut settings = Settings::new();
    (settings.max_iterations, settings.restoration_iterations) = (150, 0);
    let plan = task.attempt(&settings, |_| ControlFlow::Continue(()));
    plan.is_ok_and(|plan| plan.status == Status::Solved)
}

fn task(name: &str, change: impl FnOnce(&mut Task)) -> Task {
    let mut task = Task::load(name).unwrap();
    change(&mut task);
    task
}

#[test]
fn tasks_that_are_solved_break_no_bound() {
    for (name, _) in BUILT_IN {
        assert_eq!(impossible(&Task::load(name).unwrap()), None, "{name}");
    }
}

/// One task per bound, a little beyond it: the bound says so, and the solver finds no plan either.
#[test]
#[ignore = "long: cargo xtask suites"]
fn the_solver_agrees_with_every_bound() {
    let cases = [
        (
            "durations",
            task("a1/lateral", |task| task.problem.max_total = 0.3),
        ),
        (
            "falling",
            task("a1/lateral", |task| {
                for phase in &mut task.problem.phases {
                    phase.contacts = [false; 4];
                }
            }),
        ),
        (
            "start",
            task("a1/lateral", |task| task.problem.clearance = 0.3),
        ),
        (
            "reach",
            task("a1/lateral", |task| task.problem.start_w.z += 0.2),
        ),
        (
            "hanging",
            task("a1/lateral", |task| {
                task.fix_timing(&[0.5, 2.0]).unwrap();
            }),
        ),
        (
            "goal",
            task("a1/lateral", |task| task.problem.goal_w.z = 0.05),
        ),
        (
            "sideways",
            task("a1/lateral", |task| task.problem.friction = 0.02),
        ),
        (
            "run-up",
            task("a1/lateral", |task| task.problem.goal_w.y += 5.0),
        ),
        (
            "free fall",
            task("a1/double-backflip", |task| {
                task.fix_timing(&[0.5, 0.33, 0.2]).unwrap();
            }),
        ),
        (
            "impulse",
            task("a1/lateral", |task| task.problem.max_force = 30.0),
        ),
        (
            "force",
            task("a1/lateral", |task| task.problem.goal_w.z += 2.2),
        ),
    ];
    for (name, task) in cases {
        let proof = impossible(&task);
        assert_eq!(proof.map(|proof| proof.bound), Some(name));
        assert!(!solves(&task), "{name}: the solver contradicts the bound");
    }
}

/// What is told of friction is the ground's, which a task gives, and not the share of it that a plan may use.
#[test]
fn the_friction_that_is_told_is_the_grounds() {
    let on = |friction: f64| {
        let mut file = TaskFile::load("a1/lateral").unwrap().0;
        file.limits.friction = friction;
        impossible(&Task::from_file("slippery", &file, Quadruped::a1().unwrap()).unwrap())
    };
    let proof = on(0.02).unwrap();
    assert_eq!(proof.bound, "sideways", "{proof}");
    assert!(proof.because.contains("friction of 0.020"), "{proof}");
    let least: f64 = proof
        .relaxation
        .rsplit(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!(on(least - 2e-3).is_some());
    assert_eq!(on(least + 1e-3), None);
}

/// A goal that friction and force alone would allow, but not within reach of feet that stand.
#[test]
fn speed_is_gained_where_feet_stand() {
    let far = task("a1/lateral", |task| task.problem.goal_w.y += 5.0);
    let proof = impossible(&far).unwrap();
    assert_eq!(proof.bound, "run-up", "{proof}");
    let nearer = proof.relaxation.split_whitespace().rev().nth(2).unwrap();
    let nearer: f64 = nearer.parse().unwrap();
    let near = task("a1/lateral", |task| {
        task.problem.goal_w.y += 5.0 - nearer - 2e-3;
    });
    assert_eq!(impossible(&near), None);
}

/// Where the feet come down is a matter of the legs' posture, which the rigid body does not have: onto a box the feet must come over its
/// edge, and off a box out of it, whichever foot is last.
#[test]
fn feet_land_beyond_the_edge_of_a_box() {
    let near = |name: &str, goal: [f64; 2]| {
        let mut file = TaskFile::load(name).unwrap().0;
        (file.goal_m[0], file.goal_m[1]) = (goal[0], goal[1]);
        let task = Task::from_file(name, &file, Quadruped::a1().unwrap()).unwrap();
        impossible(&task)
    };
    let onto = "tasks/extra/forward-onto-box.toml";
    let off = "a1/lateral-down";
    assert_eq!(near(onto, [0.6, 0.0]), None);
    assert_eq!(near(off, [0.0, 0.5]), None);
    for (name, goal, words) in [
        (onto, [0.3, 0.0], ["foot R", "in the air"]),
        (off, [0.0, 0.29], ["R comes down", "inside it"]),
        (off, [0.3, 0.29], ["foot", "inside it"]),
    ] {
        let proof = near(name, goal).unwrap();
        assert_eq!(proof.bound, "landing", "{proof}");
        for word in words {
            assert!(proof.because.contains(word), "{proof}");
        }
        assert!(proof.relaxation.contains("farther"));
    }
}

/// Power is a matter of the joints, which the rigid body does not have: the whole body must disagree with a plan of the body.
#[test]
fn weak_joints_cannot_lift() {
    let weak = task("a1/lateral", |task| {
        task.limits.torque_shares = [0.02; 3];
        task.problem.goal_w.z += 0.8;
    });
    assert_eq!(impossible(&weak).map(|proof| proof.bound), Some("power"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Random changes of the tasks, half of them far beyond what can be: whatever breaks a bound, the solver does not solve.
    #[test]
    #[ignore = "long: cargo xtask suites"]
    fn bounds_never_contradict_the_solver(
        (name, rise, ahead) in (0..BUILT_IN.len(), -1.6..1.6, -2.0..2.0),
        (friction, force, total) in (0.02..2.0, 0.2..2.0, 0.3..1.5),
    ) {
        let (name, _) = BUILT_IN[name];
        let task = task(name, |task| {
            let problem = &mut task.problem;
            problem.goal_w.z += rise;
            problem.goal_w.x += ahead;
            problem.friction *= friction;
            problem.max_force *= force;
            problem.max_total *= total;
            problem.min_total = problem.min_total.min(problem.max_total);
        });
        if let Some(proof) = impossible(&task) {
            prop_assert!(!solves(&task), "{name}: {proof:?}");
        }
    }
}
