//! Throw-away.
#![allow(missing_docs, clippy::all, clippy::pedantic, unused_crate_dependencies)]
use jump_lab::Sim;
use jump_lab::lab::{Interface, PlantArgument};
use jump_lab::quadruped::envelope::{Counts, Sample, trial};
use jump_lab::quadruped::execute::run_watched;
use jump_lab::quadruped::measure::Measure;
use jump_lab::quadruped::{Planned, State};
use jump_planner::Velocity;
use jump_planner::robot::Quadruped;
use jump_planner::state;
use jump_planner::task::Task;
use nalgebra::{Matrix3, Vector3};
use rbd_core::{CentroidalMap, Motion, Posture, Transform, centroidal_map, centroidal_state};

struct Cen {
    c: Vector3<f64>,
    v: Vector3<f64>,
    l: Vector3<f64>,
    r: nalgebra::Rotation3<f64>,
    i: Matrix3<f64>,
}
fn cen(robot: &Quadruped, q: &State, v: &Velocity) -> Cen {
    let p = Posture::new(robot, q);
    let s = centroidal_state(robot, &p, v);
    let mut m = CentroidalMap::ZERO;
    centroidal_map(robot, &p, &mut m);
    let i = m.locked_inertia_w;
    Cen {
        c: s.com_w,
        v: s.com_velocity_w,
        l: s.momentum_w.angular,
        r: q.base.rotation,
        i: Matrix3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz),
    }
}
fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|a| a * a).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let tasks = &a[1];
    let base: u64 = a[2].parse().unwrap();
    let n: u64 = a[3].parse().unwrap();
    let verbose = a.iter().any(|x| x == "-v");
    let plant: Option<PlantArgument> = a
        .iter()
        .position(|x| x == "--plant")
        .map(|i| a[i + 1].parse().unwrap());
    let sim = if a.iter().any(|x| x == "--native") {
        Sim::Native
    } else {
        "mujoco".parse().unwrap()
    };
    let without: Vec<Measure> = a
        .iter()
        .position(|x| x == "--without")
        .map(|i| a[i + 1].split(',').map(|w| w.parse().unwrap()).collect())
        .unwrap_or_default();
    let robot = Quadruped::a1().unwrap();
    for t in tasks.split(',') {
        let bytes = std::fs::read(format!("/tmp/labplans/{t}/plan.bin")).unwrap();
        let planned = Planned::open(&robot, &bytes, |name| Task::load(name)).unwrap();
        let (task, reference) = (&planned.task, &planned.reference);
        let probe_t = |dt: f64| {
            reference
                .nodes
                .iter()
                .find(|x| x.time >= reference.takeoff + dt - 1e-9)
                .unwrap()
        };
        let node = probe_t(0.03);
        let (q, v) = state(node);
        let plan = cen(&robot, &q, &v);
        let node0 = probe_t(0.0);
        let (q, v) = state(node0);
        let plan0 = cen(&robot, &q, &v);
        let tf = reference.touchdown - node.time;
        let mut out = vec![];
        let mut sats = [0; 3];
        let mut errs: [Vec<f64>; 9] = Default::default();
        for i in 0..n {
            let tr = trial(
                (base, i),
                plant.as_ref(),
                (sim, Interface::Torque),
                &without,
            );
            let tr = if plant.as_ref().is_some_and(|p| p.to_string().is_empty()) {
                jump_lab::quadruped::execute::Trial { seed: 0, ..tr }
            } else {
                tr
            };
            let run = run_watched(task, reference, tr, |_, _| {}, |_, _| {}, |_| {}).unwrap();
            let judged = planned.judge(&run);
            let at = |node: &jump_planner::Node, plan: &Cen| {
                run.samples
                    .iter()
                    .find(|s| s.time >= node.time - 5e-4)
                    .map(|s| {
                        let q = State {
                            base: Transform::new(s.orientation.to_rotation_matrix(), s.position),
                            joints: s.joints,
                        };
                        let v = Velocity {
                            base: Motion::new(q.base.rotation.inverse() * s.velocity_w, s.omega_b),
                            joints: s.joint_velocities,
                        };
                        let c = cen(&robot, &q, &v);
                        let late = s.time - node.time;
                        (
                            c.c - plan.c - plan.v * late,
                            c.v - plan.v - Vector3::z() * (-9.81 * late),
                            so3::log(&(c.r * plan.r.inverse())),
                            plan.i.try_inverse().unwrap() * (c.l - plan.l),
                        )
                    })
            };
            let (Some(e), Some(e0)) = (at(node, &plan), at(node0, &plan0)) else {
                out.push(Sample::new(i, &tr, &judged));
                continue;
            };
            let pp = e.0 + e.1 * tf;
            let f = judged.verdict.flight;
            let row = [
                e0.0.norm(),
                e0.1.norm(),
                e0.2.norm(),
                e0.3.norm(),
                e.1.norm(),
                e.3.norm(),
                pp.norm(),
                f.map_or(9.0, |f| f.position),
                f.map_or(180.0, |f| f.rotation),
            ];
            let sat = judged.verdict.hardware.saturation;
            if sat[0] > 0.010 {
                sats[0] += 1;
            }
            if sat[1] > 0.010 {
                sats[1] += 1;
            }
            if row[7] < 0.10 && row[8] < 10.0 && sat[0] <= 0.010 && sat[1] <= 0.010 {
                sats[2] += 1;
            }
            for (a, b) in errs.iter_mut().zip(row) {
                a.push(b);
            }
            let s = Sample::new(i, &tr, &judged);
            if verbose {
                println!(
                    "{i:3} {:34} p0 {:5.3} v0 {:5.3} th0 {:5.3} w0 {:5.2} | v30 [{:6.3} {:6.3} {:6.3}] th30 [{:6.3} {:6.3} {:6.3}] w30 [{:6.2} {:6.2} {:6.2}] | pred p {:5.3} | flight {:5.3} m {:5.1} deg",
                    s.outcome,
                    row[0],
                    row[1],
                    row[2],
                    row[3],
                    e.1.x,
                    e.1.y,
                    e.1.z,
                    e.2.x,
                    e.2.y,
                    e.2.z,
                    e.3.x,
                    e.3.y,
                    e.3.z,
                    row[6],
                    row[7],
                    row[8]
                );
            }
            out.push(s);
        }
        let c = Counts::of(&out);
        let _x = 0;
        let early = std::env::var("EARLY").is_ok();
        let good_flight = errs[7]
            .iter()
            .zip(&errs[8])
            .filter(|(p, r)| **p < 0.10 && **r < 10.0)
            .count();
        let med = |x: &[f64]| {
            let mut y = x.to_vec();
            y.sort_by(f64::total_cmp);
            y.get(y.len() / 2).copied().unwrap_or(f64::NAN)
        };
        println!(
            "{t:12} {:3}/{:3} fl {good_flight:3} sat {:2} {:2} EARLY-OK {:3} | rms p0 {:.3} v0 {:.3} th0 {:.3} w0 {:.2} | v30 {:.3} w30 {:.2} predp {:.3} | flight median {:.3} m {:.1} deg | {}",
            c.on_target,
            c.samples,
            sats[0],
            sats[1],
            sats[2],
            rms(&errs[0]),
            rms(&errs[1]),
            rms(&errs[2]),
            rms(&errs[3]),
            rms(&errs[4]),
            rms(&errs[5]),
            rms(&errs[6]),
            med(&errs[7]),
            med(&errs[8]),
            c.failures()
        );
    }
}
