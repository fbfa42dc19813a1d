//! A jump to test with: a quarter turn of an A1-like body, four feet, flight.
#![allow(dead_code, reason = "every test file uses its own part")]

use nalgebra::{Matrix3, Vector3};
use srb_opt::{Edge, Foot, Phase, Problem, Reference, Weights};

pub(crate) const NX: usize = 16;
pub(crate) const NU: usize = 12;
pub(crate) const NI: usize = 40;

pub(crate) fn jump() -> Problem<f64, 4, 4> {
    let phase = |contacts, intervals, duration_guess| Phase {
        contacts,
        intervals,
        duration_guess,
        min_duration: 0.1,
        max_duration: 1.0,
        reference_angle: 0.0,
    };
    let feet = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| Foot {
        pos_wf: Vector3::new(0.18 * x, 0.13 * y, 0.0),
        nominal_b: Vector3::new(0.18 * x, 0.13 * y, 0.0),
    });
    let mut corners = [Vector3::zeros(); 8];
    for (i, corner) in corners.iter_mut().enumerate() {
        let side = |bit: usize| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
        *corner = Vector3::new(0.18 * side(0), 0.097 * side(1), 0.057 * side(2));
    }
    Problem {
        mass: 12.0,
        inertia_b: Matrix3::new(0.017, 0.001, 0.0, 0.001, 0.056, 0.002, 0.0, 0.002, 0.065),
        gravity: 9.81,
        feet,
        reach_lower: Vector3::new(-0.12, -0.10, -0.33),
        reach_upper: Vector3::new(0.12, 0.10, -0.10),
        friction: 0.6,
        max_force: 160.0,
        corners,
        clearance: 0.03,
        edge: Some(Edge {
            drop: 0.2,
            axis: 0,
            sign: 1.0,
            distance: 0.25,
            width: 0.03,
        }),
        phases: [
            phase([true; 4], 10, 0.4),
            phase([false, false, true, true], 6, 0.2),
            phase([false; 4], 8, 0.3),
            phase([false; 4], 0, 0.0),
        ],
        phase_count: 3,
        min_total: 0.5,
        max_total: 1.2,
        start_w: Vector3::new(0.0, 0.0, 0.25),
        goal_w: Vector3::new(0.4, -0.1, 0.05),
        axis: Vector3::z(),
        angle: 0.6,
        min_final_trace: 2.5,
        reference: Reference::Linear,
        weights: Weights {
            omega: 1e-2,
            force: 1e-5,
            rotation: 1.0,
        },
        log_epsilon: 1e-6,
    }
}
