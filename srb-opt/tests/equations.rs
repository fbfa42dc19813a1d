//! Problem (2) of paper A as it is printed, in plain formulas, beside what the solver is given.

use crate::common::{NI, NU, NX, config, jump, nodes};
use nalgebra::{Matrix3, Rotation3, Vector3};
use ocp_solver::{Problem as Ocp, Values};
use proptest::prelude::*;
use srb_opt::{OMEGA, POSITION, ROTATION, State, VELOCITY};

/// Forces on the feet in contact, N: controls are in halves of the weight.
fn forces(k: usize, control: &[f64; NU]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let problem = jump();
    let unit = 0.5 * problem.mass * problem.gravity;
    let (_, phase) = problem.phase_of(k).unwrap();
    let on = (0..4).filter(|i| phase.contacts[*i]);
    on.zip(control.chunks(3))
        .map(|(i, u)| (problem.feet[i].pos_wf, Vector3::from_column_slice(u) * unit))
        .collect()
}

fn hat(w: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -w.z, w.y, w.z, 0.0, -w.x, -w.y, w.x, 0.0)
}

fn evaluate(
    k: usize,
    x: &State<f64, 4>,
    u: &[f64; NU],
    next: &State<f64, 4>,
) -> Values<f64, NX, NI> {
    let mut values = Values::new();
    let next = (k < jump().intervals()).then_some(next);
    jump().evaluate(k, x, u, next, &mut values);
    values
}

proptest! {
    #![proptest_config(config(20, 4))]

    /// (1a) and (1b) give the accelerations, (2b) steps with them, (1c), (2c) and (3) turn the body: the gaps to the next node are what is
    /// missing.
    #[test]
    fn the_body_moves_as_printed(stages in nodes(0.3)) {
        let problem = jump();
        for k in 0..problem.intervals() {
            let (x, u) = (&stages[k].state, &stages[k].control);
            let (phase, data) = problem.phase_of(k).unwrap();
            let dt = x.durations[phase] / data.intervals as f64;
            let rot = x.rot_wb;
            let mut acceleration = Vector3::new(0.0, 0.0, -problem.gravity);
            let mut moment = Vector3::zeros();
            for (foot, f) in forces(k, u) {
                acceleration += f / problem.mass;
                moment += (foot - x.pos_w).cross(&f);
            }
            let turning = problem.inertia_b * x.omega_b;
            let effort = rot.transpose() * moment - x.omega_b.cross(&turning);
            let alpha = problem.inertia_b.try_inverse().unwrap() * effort;
            let next = &stages[k + 1].state;
            let gap = evaluate(k, x, u, next).gap;
            for i in 0..3 {
                let moved = x.pos_w[i] + dt * x.vel_w[i] + 0.5 * dt * dt * acceleration[i];
                assert!((gap[POSITION + i] - (moved - next.pos_w[i])).abs() < 1e-12);
                let faster = x.vel_w[i] + dt * acceleration[i];
                assert!((gap[VELOCITY + i] - (faster - next.vel_w[i])).abs() < 1e-12);
                let turned = x.omega_b[i] + dt * alpha[i];
                assert!((gap[OMEGA + i] - (turned - next.omega_b[i])).abs() < 1e-9);
            }
            // The rotation's gap is carried by the next node: taken there without a step, it stands where (2c) leads with (3).
            let a = hat(&x.omega_b) * dt;
            let turn =
                Matrix3::identity() + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
            let carried =
                Ocp::<f64, NX, NU, NI>::retract(&problem, k + 1, next, &[0.0; NX], Some((x, u)));
            let gap = evaluate(k, x, u, &carried).gap;
            let missing = Vector3::from_column_slice(&gap[ROTATION..ROTATION + 3]);
            let reached = rot * turn * so3::exp(&-missing).matrix();
            assert!((reached - carried.rot_wb).amax() < 1e-9, "{k}");
        }
    }

    /// ε_Ω Ωᵀ Ω + ε_f fᵀ f + ε_R e_Rᵀ e_R with e_R = log(R_refᵀ R)ˇ and R_ref turned linearly from start to goal.
    #[test]
    fn the_cost_is_that_of_the_paper(stages in nodes(0.3), turn in prop::array::uniform3(-1.0..1.0_f64)) {
        let problem = jump();
        let last = problem.intervals() as f64;
        let turn = Vector3::from(turn);
        for k in 1..problem.intervals() {
            let mut step = [0.0; NX];
            step[ROTATION..ROTATION + 3].copy_from_slice(turn.as_slice());
            // A true rotation, off the reference.
            let mut x = stages[k].state;
            x.rot_wb =
                *Rotation3::from_scaled_axis(problem.axis * problem.reference_angle(k)).matrix();
            let x = Ocp::<f64, NX, NU, NI>::retract(&problem, k, &x, &step, None);
            assert!((problem.reference_angle(k) - problem.angle * k as f64 / last).abs() < 1e-12);
            let u = &stages[k].control;
            let squares: f64 = forces(k, u).iter().map(|(_, f)| f.norm_squared()).sum();
            let w = &problem.weights;
            let cost = w.omega * x.omega_b.norm_squared()
                + w.force * squares
                + w.rotation * turn.norm_squared();
            let found = evaluate(k, &x, u, &stages[k + 1].state).cost;
            assert!(
                (found - cost).abs() < 1e-5 * cost,
                "{k}: {found}, not {cost}"
            );
        }
    }

    /// (2a): legs reach their feet, corners keep clear of the ground, forces stay in pyramids and below their limit; (2d): durations.
    #[test]
    fn rows_are_the_constraints_of_the_paper(stages in nodes(0.3)) {
        let problem = jump();
        for k in 0..problem.intervals() {
            let (x, u) = (&stages[k].state, &stages[k].control);
            let rows = evaluate(k, x, u, &stages[k + 1].state).rows;
            let mut wanted = Vec::new();
            let forces = forces(k, u);
            if k > 0 {
                for (foot, _) in &forces {
                    let leg = x.rot_wb.transpose() * (foot - x.pos_w);
                    wanted.extend(leg.iter().copied());
                }
                let edge = problem.edge.unwrap();
                for corner in &problem.corners {
                    let at = x.pos_w + x.rot_wb * corner;
                    let past = so3::math::tanh((at.x - edge.distance) / edge.width);
                    wanted.push(at.z + 0.5 * edge.drop * (1.0 + past));
                }
            } else {
                wanted.extend(&x.durations[..problem.phase_count]);
                wanted.push(x.durations[..problem.phase_count].iter().sum());
            }
            let unit = 0.5 * problem.mass * problem.gravity;
            for (_, f) in &forces {
                let f = f / unit;
                let limit = problem.friction * f.z;
                let mut sides = [limit - f.x, limit + f.x, limit - f.y, limit + f.y, f.z];
                sides[..4].sort_by(f64::total_cmp);
                wanted.extend(sides);
            }
            let mut found = rows[..wanted.len()].to_vec();
            let first = wanted.len() - 5 * forces.len();
            found[first..]
                .chunks_mut(5)
                .for_each(|rows| rows[..4].sort_by(f64::total_cmp));
            for (i, (a, b)) in found.iter().zip(&wanted).enumerate() {
                assert!((a - b).abs() < 1e-9, "node {k}, row {i}: {a}, not {b}");
            }
        }
    }
}
