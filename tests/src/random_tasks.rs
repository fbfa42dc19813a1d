//! Jumps that nobody chose, for the planner.
//!
//! Every number is drawn evenly from its range, and nothing looks at whether the jump can be done: far goals, low friction and pushes
//! with the wrong pair of feet are among them. Only what a task file would be refused for is avoided: feet that land on an edge, goals that
//! hang in the air.

use jump_planner::task::file::{
    Across, BoxTable, LimitsTable, PhaseTable, TaskFile, TotalTable, TurnTable, WeightsTable,
};
use proptest::prelude::{Just, Strategy, prop_oneof};

/// Pairs of feet that push last: left, right, front, rear.
const PAIRS: [[&str; 2]; 4] = [["FL", "RL"], ["FR", "RR"], ["FL", "FR"], ["RL", "RR"]];

/// Where a jump goes, and over which edge.
type Way = ([f64; 3], Option<BoxTable>);

/// Task files for the robot of this name or URDF.
pub fn tasks(robot: &str) -> impl Strategy<Value = TaskFile> + use<> {
    let robot = robot.to_owned();
    let way = prop_oneof![2 => level(), 1 => over_edge(0.05..1.0), 1 => over_edge(-0.3..-0.05)];
    (way, turn(), pushes(), 0.4..1.0).prop_map(move |((goal_m, r#box), turn, phases, friction)| {
        TaskFile {
            robot: robot.clone(),
            lock: Vec::new(),
            goal_m,
            feet_m: None,
            turn,
            r#box,
            trunk_may_touch: false,
            phases,
            total: TotalTable::default(),
            limits: LimitsTable {
                friction,
                ..LimitsTable::default()
            },
            weights: WeightsTable::default(),
        }
    })
}

/// Up to 0.8 m in any direction over level ground.
fn level() -> impl Strategy<Value = Way> {
    (-180.0..180.0, 0.0..0.8).prop_map(|(toward, far): (f64, f64)| {
        let (sin, cos) = so3::math::sin_cos(toward.to_radians());
        ([far * cos, far * sin, 0.0], None)
    })
}

/// Off a box or onto one, far enough for all feet to stand beyond its edge, and up to 0.2 m aside.
fn over_edge(drop_m: core::ops::Range<f64>) -> impl Strategy<Value = Way> {
    let across = prop_oneof![
        (Just(Across::X), 0.5..0.9_f64),
        (Just(Across::Y), 0.4..0.8_f64)
    ];
    let side = prop_oneof![Just(1_i8), Just(-1)];
    (drop_m, across, side, -0.2..0.2, 0.02..0.07).prop_map(
        |(drop_m, (axis, far), side, aside, beyond)| {
            let along = f64::from(side) * far;
            let goal_m = match axis {
                Across::X => [along, aside, -drop_m],
                Across::Y => [aside, along, -drop_m],
            };
            let edge = BoxTable {
                drop_m,
                axis,
                side,
                beyond_feet_m: Some(beyond),
                distance_m: None,
            };
            (goal_m, Some(edge))
        },
    )
}

/// None, about the vertical by any angle, or over once, either way round.
fn turn() -> impl Strategy<Value = Option<TurnTable>> {
    let whole = prop_oneof![Just(360.0), Just(-360.0)];
    let flip = (
        prop_oneof![Just([1.0, 0.0, 0.0]), Just([0.0, 1.0, 0.0])],
        whole,
    );
    let spin = (Just([0.0, 0.0, 1.0]), -270.0..270.0);
    prop_oneof![
        4 => Just(None),
        3 => spin.prop_map(|(axis, angle_deg)| Some(TurnTable { axis, angle_deg })),
        3 => flip.prop_map(|(axis, angle_deg)| Some(TurnTable { axis, angle_deg })),
    ]
}

/// From four feet, or from four and then a pair.
fn pushes() -> impl Strategy<Value = Vec<PhaseTable>> {
    let phase = |feet: &[&str], intervals: usize, guess_s: f64| PhaseTable {
        feet: feet.iter().map(|foot| (*foot).to_owned()).collect(),
        intervals,
        guess_s,
        min_s: None,
        max_s: None,
        turn_deg: None,
    };
    let stand = move || phase(&["FL", "FR", "RL", "RR"], 50, 0.4);
    let fly = move || phase(&[], 40, 0.4);
    prop_oneof![
        Just(vec![stand(), fly()]),
        (0..PAIRS.len()).prop_map(move |i| vec![stand(), phase(&PAIRS[i], 30, 0.25), fly()]),
    ]
}
