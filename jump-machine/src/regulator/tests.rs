//! The gains against a dense finite-horizon problem, and what is never asked for.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

mod along;

use a1_model::{A1, BUILD, FEET};
use jump_control::{Node, Plan, Torques};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use rbd_core::{Configuration, Frame, Limbs, Motion, Tangent, Transform, Tree, center_of_mass};
use so3::Scalar;

use super::body::Body;
use super::cost_to_go::{ANGULAR, Drift, ERRORS, MOMENTA, PLACE, ROTATION, VELOCITY};
use super::{COLUMNS, NODES_PER_TICK, Regulator, Weights, product};
use crate::Load;

const NODES: usize = 8;
const DT: f64 = 0.005;
/// Node of the take-off.
const TAKEOFF: usize = 3;
/// Height of loads, m.
const LOAD_HEIGHT: f64 = 0.07;
/// Forces of all feet at all nodes before it.
const INPUTS: usize = 12 * TAKEOFF;

fn feet<T: Scalar>() -> [Frame<T>; 4] {
    FEET.map(|foot| Frame {
        offset: foot.frame.offset.map(T::of),
        link: foot.frame.link,
        rotation: foot.frame.rotation.map(|row| row.map(T::of)),
    })
}

/// A push-off of two nodes with all feet and one with two, then a flight.
fn nodes<T: Scalar>() -> [Node<T, 12, 4>; NODES] {
    let of = T::of;
    let vector = |x: [f64; 3]| Vector3::from(x.map(of));
    core::array::from_fn(|i| {
        let t = DT * i as f64;
        let push = |foot: usize| {
            let on = i < TAKEOFF && (i < 2 || foot >= 2);
            let on = f64::from(u8::from(on));
            vector([4.0 * on, (foot as f64 - 3.0) * on, 60.0 * on])
        };
        let turned = vector([0.1 + 2.0 * t, 0.2, t - 0.3]);
        Node {
            time: of(t),
            base: Transform::new(so3::exp(&turned), vector([0.3 * t, 0.1, 0.25 + t])),
            base_velocity: Motion::new(vector([0.3, 0.1, 1.0]), vector([2.0, 0.5, 1.0])),
            joints: core::array::from_fn(|j| of([0.1, 0.9, -1.7][j % 3] - t * (j % 3) as f64)),
            joint_velocities: core::array::from_fn(|j| of(-((j % 3) as f64))),
            forces_w: core::array::from_fn(push),
            ..Node::ZERO
        }
    })
}

fn plan<T: Scalar>(nodes: &[Node<T, 12, 4>]) -> Plan<'_, T, 12, 4> {
    let time = |i: usize| T::of(DT * i as f64);
    let (takeoff, end) = (time(TAKEOFF), time(NODES - 1));
    Plan::new(nodes, takeoff, end, end, Torques::Hold).unwrap()
}

/// Least squares over all forces at once: normal equations of rows (g u − f)².
struct Dense {
    normal: SMatrix<f64, INPUTS, INPUTS>,
    side: SVector<f64, INPUTS>,
    /// The error at the node that is reached: `free` and `forced` times the forces.
    free: SVector<f64, ERRORS>,
    forced: SMatrix<f64, ERRORS, INPUTS>,
}

impl Dense {
    /// Adds |by (error rows from `first` on)|²/σ².
    fn add(&mut self, first: usize, by: &Matrix3<f64>, variance: f64) {
        let g = by * self.forced.fixed_rows::<3>(first);
        let f = by * self.free.fixed_rows::<3>(first);
        self.normal += g.transpose() * g / variance;
        self.side -= g.transpose() * f / variance;
    }

    fn add_errors(&mut self, sigmas: &[f64; 4], inverse_inertia: &Matrix3<f64>, share: f64) {
        for (sigma, first) in sigmas.iter().zip([PLACE, ROTATION, VELOCITY, ANGULAR]) {
            let by = if first == ANGULAR {
                *inverse_inertia
            } else {
                Matrix3::identity()
            };
            self.add(first, &by, sigma * sigma / share);
        }
    }

    /// The first node's best forces for the error x there, of a robot that carries `load`.
    fn forces(weights: &Weights<f64>, x: &SVector<f64, ERRORS>, load: f64) -> [Vector3<f64>; 4] {
        let mut dense = Self {
            normal: SMatrix::zeros(),
            side: SVector::zeros(),
            free: *x,
            forced: SMatrix::zeros(),
        };
        for (i, node) in nodes::<f64>().iter().enumerate() {
            let body = body(node);
            let inverse = &body.inverse_inertia_w;
            if i == TAKEOFF {
                dense.add_errors(&weights.takeoff, inverse, 1.0);
            }
            if i <= TAKEOFF {
                dense.add_errors(&weights.running, inverse, DT / weights.time);
            }
            if i + 1 == NODES {
                dense.add(PLACE, &Matrix3::identity(), square(weights.touchdown[0]));
                dense.add(ROTATION, &Matrix3::identity(), square(weights.touchdown[1]));
            }
            if i < TAKEOFF {
                dense.push(i, node, &body, weights);
            }
            let a = whole(&body.drift(DT));
            (dense.free, dense.forced) = (a * dense.free, a * dense.forced);
            let mut angular = dense.free.fixed_rows_mut::<3>(ANGULAR);
            angular += loaded(node) * load * DT;
        }
        let u = dense.normal.cholesky().unwrap().solve(&dense.side);
        core::array::from_fn(|foot| u.fixed_rows::<3>(3 * foot).into())
    }

    fn push(
        &mut self,
        i: usize,
        node: &Node<f64, 12, 4>,
        body: &Body<f64, 4>,
        weights: &Weights<f64>,
    ) {
        for (foot, force) in node.forces_w.iter().enumerate() {
            for axis in 0..3 {
                let column = 12 * i + 3 * foot + axis;
                if force.z == 0.0 {
                    // It has no effect and costs something.
                    self.normal[(column, column)] = 1.0;
                    continue;
                }
                for (k, effect) in body.push(foot, axis).iter().enumerate() {
                    self.forced[(ERRORS - MOMENTA + k, column)] += effect * DT;
                }
                let share = if axis == 2 {
                    weights.normal
                } else {
                    weights.tangential
                };
                let variance = square(share * force.z) * weights.time / DT;
                self.normal[(column, column)] += 1.0 / variance;
            }
        }
    }
}

fn configuration(node: &Node<f64, 12, 4>) -> Configuration<f64, 12> {
    Configuration {
        base: node.base,
        joints: node.joints,
    }
}

fn body(node: &Node<f64, 12, 4>) -> Body<f64, 4> {
    let limbs = (&mut { Limbs::ZERO }, LOAD_HEIGHT);
    Body::new(&A1, node, &feet(), limbs)
}

/// How fast the angular momentum of a node's robot grows beyond the plan's with a load of its own mass, whose acceleration is that of the whole: forces are
/// twice as large, and one half of them is what the load pushes back with.
fn loaded(node: &Node<f64, 12, 4>) -> Vector3<f64> {
    let limbs = Limbs::new(&A1, &configuration(node), &feet());
    let com_w = center_of_mass(&A1, &limbs.posture).position_w;
    let load_w = node.base.point(&Vector3::new(0.0, 0.0, LOAD_HEIGHT));
    let (mut planned, mut total) = (Vector3::zeros(), Vector3::zeros());
    for (end, force) in limbs.ends.iter().zip(&node.forces_w) {
        planned += (node.base.point(&end.position) - com_w).cross(force);
        total += force;
    }
    2.0 * planned - (load_w - com_w).cross(&total) - planned
}

/// A as one matrix.
fn whole(drift: &Drift<f64>) -> SMatrix<f64, ERRORS, ERRORS> {
    let mut a = SMatrix::<f64, ERRORS, ERRORS>::identity();
    let mut put = |row, column, block: &Matrix3<f64>| {
        a.fixed_view_mut::<3, 3>(row, column).copy_from(block);
    };
    put(PLACE, VELOCITY, &Matrix3::from_diagonal_element(drift.dt));
    put(ROTATION, ROTATION, &drift.turned);
    put(ROTATION, ANGULAR, &drift.turns);
    put(ANGULAR, PLACE, &drift.pushed);
    a
}

fn square(x: f64) -> f64 {
    x * x
}

/// Gains for a plan, over so many nodes at a time; the number of times.
fn prepare<T: Scalar>(regulator: &mut Regulator<T>, plan: &Plan<'_, T, 12, 4>, most: usize) -> usize
where
    A1: Tree<T, 12>,
{
    let weights = Weights::new(&BUILD.cast());
    regulator.begin(plan, &weights);
    let mut times = 0;
    while !regulator.is_ready() {
        let legs = (&feet(), &mut { Limbs::ZERO });
        regulator.advance((&A1, &weights), plan, legs, T::of(LOAD_HEIGHT), most);
        times += 1;
    }
    times
}

fn prepared() -> Regulator<f64> {
    let (nodes, mut regulator) = (nodes(), Regulator::new());
    prepare(&mut regulator, &plan(&nodes), usize::MAX);
    regulator
}

/// For errors of every kind the first forces are those of all forces chosen at once.
#[test]
fn riccatis_recursion_solves_the_dense_problem() {
    let (weights, regulator) = (Weights::new(&BUILD), prepared());
    let nodes = nodes::<f64>();
    let body = body(&nodes[0]);
    // The last one is the load.
    for k in 0..COLUMNS {
        let of = |row: usize| if row == k { 0.1 } else { 0.003 * row as f64 };
        let x: SVector<f64, ERRORS> = SVector::from_fn(|row, _| of(row));
        let load = of(ERRORS);
        let lambda = product(&regulator.gains[TAKEOFF - 1], &x.push(load));
        let dense = Dense::forces(&weights, &x, load);
        for (foot, wanted) in dense.iter().enumerate() {
            let slope = Vector3::from_fn(|axis, _| body.push(foot, axis).dot(&lambda));
            let per_cost = weights.per_cost(nodes[0].forces_w[foot].z);
            let force = -slope.component_mul(&per_cost);
            let off = (force - wanted).norm();
            // Gains are kept in single precision.
            assert!(off < 1e-5 * wanted.norm().max(1.0), "{k}: {force} {wanted}");
        }
    }
}

/// The bits of what is kept of a plan.
fn kept(regulator: &Regulator<f64>) -> impl Iterator<Item = u32> {
    let states = regulator.states.as_flattened().as_flattened();
    let gains = regulator.gains.as_flattened().as_flattened();
    states.iter().chain(gains).map(|x| x.to_bits())
}

/// Over however many nodes at a time, and after another plan was given up on the way, the same bits are kept.
#[test]
fn a_recursion_in_parts_is_the_recursion_at_once() {
    let (nodes, whole) = (nodes::<f64>(), prepared());
    let (plan, weights) = (plan(&nodes), Weights::new(&BUILD));
    assert!(kept(&whole).any(|bits| bits != 0));
    for most in 1..NODES {
        let mut regulator = Regulator::new();
        regulator.begin(&plan, &weights);
        let legs = (&feet(), &mut { Limbs::ZERO });
        regulator.advance((&A1, &weights), &plan, legs, LOAD_HEIGHT, 2);
        assert!(!regulator.is_ready());
        let times = prepare(&mut regulator, &plan, most);
        assert_eq!(times, NODES.div_ceil(most));
        assert!(kept(&regulator).eq(kept(&whole)), "{most} at a time");
    }
    assert_eq!(Regulator::ticks(&plan), NODES.div_ceil(NODES_PER_TICK));
}

/// Forces that are wanted at `time` of the plan for a robot that is there but turned and moved.
fn wanted<T: Scalar>(time: f64, turned: [f64; 3], faster: [f64; 3]) -> [Vector3<T>; 4]
where
    A1: Tree<T, 12>,
{
    carrying(0.0, time, turned, faster)
}

/// The same for one that carries this share of its mass.
fn carrying<T: Scalar>(load: f64, time: f64, turned: [f64; 3], faster: [f64; 3]) -> [Vector3<T>; 4]
where
    A1: Tree<T, 12>,
{
    let nodes = nodes::<T>();
    let (plan, mut regulator) = (plan(&nodes), Regulator::new());
    let weights = Weights::new(&BUILD.cast());
    prepare(&mut regulator, &plan, NODES_PER_TICK);
    let time = T::of(time);
    let node = plan.node_at(time, 0);
    let here = nodes[node];
    let q = Configuration {
        base: Transform::new(
            so3::exp(&Vector3::from(turned.map(T::of))) * here.base.rotation,
            here.base.translation,
        ),
        joints: here.joints,
    };
    let velocity = Tangent {
        base: Motion::new(
            here.base_velocity.linear
                + here.base.rotation.inverse() * Vector3::from(faster.map(T::of)),
            here.base_velocity.angular,
        ),
        joints: here.joint_velocities,
    };
    let limbs = Limbs::new(&A1, &q, &feet());
    let moments = [(node, time); 2];
    let load = Load {
        share: T::of(load),
        height: T::of(LOAD_HEIGHT),
    };
    regulator.forces(
        (&A1, &weights),
        &plan,
        moments,
        &velocity,
        (&limbs, &Vector3::zeros(), &load),
        (&here.base.rotation, &here.forces_w),
    )
}

#[test]
fn a_robot_on_its_plan_is_left_alone_in_both_precisions() {
    for i in 0..TAKEOFF {
        let forces = wanted::<f64>(DT * i as f64, [0.0; 3], [0.0; 3]);
        // What single precision makes of the states that are kept.
        assert!(forces.iter().all(|force| force.norm() < 1e-2), "{forces:?}");
        let forces = wanted::<f32>(DT * i as f64, [0.0; 3], [0.0; 3]);
        assert!(forces.iter().all(|force| force.norm() < 5e-2), "{forces:?}");
    }
}

#[test]
fn errors_are_answered_against_their_sense_by_the_feet_that_push() {
    let total = |forces: &[Vector3<f64>; 4]| forces.iter().sum::<Vector3<f64>>();
    assert!(total(&wanted(0.0, [0.0; 3], [0.0, 0.0, 0.1])).z < -5.0);
    assert!(total(&wanted(0.0, [0.0; 3], [0.0, -0.1, 0.0])).y > 5.0);
    // The left side, of feet 0 and 2, is too low: it pushes more.
    let rolled = wanted::<f64>(0.0, [-0.05, 0.0, 0.0], [0.0; 3]);
    assert!(
        rolled[0].z + rolled[2].z > rolled[1].z + rolled[3].z + 5.0,
        "{rolled:?}"
    );
    let single = wanted::<f32>(0.0, [-0.05, 0.0, 0.0], [0.0; 3]);
    for (one, two) in rolled.iter().zip(&single) {
        assert!((one - two.map(f64::from)).norm() < 0.1, "{one} {two}");
    }
    // The last interval has the rear feet alone.
    let rear = wanted::<f64>(DT * 2.0, [0.0; 3], [0.0, 0.0, 0.1]);
    assert_eq!(rear[..2], [Vector3::zeros(); 2]);
    assert!(rear[2].z < -1.0 && rear[3].z < -1.0, "{rear:?}");
}

/// A robot that carries something, and whose centre of mass moves as planned with it, is pushed as the dense problem has it that knows of the load alone.
#[test]
fn a_load_is_answered_before_it_is_seen() {
    let (share, node) = (0.1, nodes::<f64>()[0]);
    let limbs = Limbs::new(&A1, &configuration(&node), &feet::<f64>());
    let com_w = center_of_mass(&A1, &limbs.posture).position_w;
    let load_w = node.base.point(&(Vector3::z() * LOAD_HEIGHT));
    // On the vertical of the base through the model's centre of mass.
    let up_w = node.base.rotation * Vector3::z();
    let raised_w = up_w * (share / (1.0 + share) * (load_w - com_w).dot(&up_w));
    let omega_w = node.base.rotation * node.base_velocity.angular;
    let slower: [f64; 3] = (-omega_w.cross(&raised_w)).into();
    let dense = Dense::forces(&Weights::new(&BUILD), &SVector::zeros(), share);
    assert!(dense.iter().any(|force| force.norm() > 2.0), "{dense:?}");
    let found = carrying::<f64>(share, 0.0, [0.0; 3], slower);
    let single = carrying::<f32>(share, 0.0, [0.0; 3], slower);
    for ((found, single), wanted) in found.iter().zip(&single).zip(&dense) {
        assert!((found - wanted).norm() < 1e-2, "{found} {wanted}");
        assert!(
            (single.map(f64::from) - wanted).norm() < 0.1,
            "{single} {wanted}"
        );
    }
}

#[test]
fn nothing_is_wanted_in_flight_or_without_a_jump() {
    assert_eq!(
        wanted::<f64>(DT * 3.5, [0.1; 3], [0.3; 3]),
        [Vector3::zeros(); 4]
    );
    assert_eq!(
        wanted::<f64>(-1.0, [0.1; 3], [0.3; 3]),
        [Vector3::zeros(); 4]
    );
    assert_eq!(
        wanted::<f64>(f64::NAN, [0.1; 3], [0.3; 3]),
        [Vector3::zeros(); 4]
    );
}

#[test]
fn no_foot_is_asked_for_more_than_friction_or_less_than_its_least() {
    let (weights, planned) = (Weights::new(&BUILD), Vector3::new(20.0, 0.0, 100.0));
    let within = |change: [f64; 3]| weights.within_cone(&planned, &Vector3::from(change));
    assert_eq!(within([1.0, 2.0, 3.0]), Vector3::new(21.0, 2.0, 103.0));
    assert_eq!(within([0.0, 0.0, -300.0]).z, 30.0);
    let slides = within([0.0, 300.0, 0.0]);
    assert!((slides.xy().norm() - 50.0).abs() < 1e-12 && slides.y > slides.x);
    let air = Vector3::new(0.0, 0.0, 0.0);
    assert_eq!(weights.within_cone(&air, &Vector3::repeat(5.0)), air);
}

/// A small rotation of a body whose angular momentum is all in its legs, as in a gyroscope, turns on as the nonlinear equation ω = R I⁻¹ Rᵀ (L − R L) has it; an angular
/// momentum turns it by I⁻¹; and the planned forces turn a body that is aside about where it is.
#[test]
fn errors_go_on_as_those_of_a_body_that_turns() {
    let (mut body, small) = (body(&nodes()[0]), 1e-6);
    body.angular_w *= 12.0;
    let drift = body.drift(DT);
    let inverse = body.inverse_inertia_w;
    let part = (inverse * so3::hat(&body.angular_w) * DT).norm();
    assert!((0.05..0.3).contains(&part), "{part}");
    for axis in 0..6 {
        let unit = |of: usize| Vector3::from_fn(|row, _| f64::from(u8::from(of + row == axis)));
        // As much momentum as turns it by a radian in the time.
        let (turned, gained) = (unit(0), inverse.try_inverse().unwrap() * unit(3) / DT);
        let mut rotation = so3::exp(&(turned * small));
        let steps = 1000;
        for _ in 0..steps {
            let rate = |r: &nalgebra::Rotation3<f64>| {
                let left = body.angular_w + gained * small - r * body.angular_w;
                r * (inverse * (r.inverse() * left)) * (DT / f64::from(steps))
            };
            let middle = so3::exp(&(rate(&rotation) * 0.5)) * rotation;
            rotation = so3::exp(&rate(&middle)) * rotation;
        }
        let found = so3::log(&rotation) / small;
        let wanted = drift.turned * turned + drift.turns * gained;
        // What is left is of third order in the time.
        let left = part * part * if axis < 3 { part } else { 1.0 };
        let off = (found - wanted).norm();
        assert!(off < 0.3 * left, "{axis}: {off}");
    }
    let aside = Vector3::new(0.01, -0.02, 0.03);
    let moments = body.forces_w.iter().map(|force| (-aside).cross(force) * DT);
    let moment: Vector3<f64> = moments.sum();
    assert!((drift.pushed * aside - moment).norm() < 1e-12);
}
