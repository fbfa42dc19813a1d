//! Laws that hold for every robot, on random trees of every joint kind.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

use crate::common::{CAP, Model, body, close, masked, model, rotation, size, state, vector};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use rbd_core::model::bodies_f32;
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AbaWorkspace, Axes, BaseBody, BaseKind, Body,
    BodyMotions, CentroidalDerivatives, CentroidalMap, ComJacobian, Configuration,
    DerivativesWorkspace, Effort, Force, Frame, FrameJacobian, Kinematics, Limbs, Link, MassMatrix,
    Motion, Posture, RneaDerivatives, TableModel, Tangent, Transform, Tree, aba, aba_derivatives,
    bias_accelerations, centroidal_bias, centroidal_derivatives, centroidal_map,
    centroidal_momentum_rate, centroidal_state, com_jacobian, com_motion, crba,
    forward_accelerations, forward_kinematics, forward_velocities, frame_jacobian, mass_solve,
    rnea, rnea_derivatives,
};

/// The first entries of a longer array.
fn first<const N: usize>(x: &[f64; CAP]) -> [f64; N] {
    core::array::from_fn(|i| x[i])
}

/// What the algorithms say about the first bodies of a robot in a table of `N`, in one list.
fn answers<const N: usize>(
    robot: &Model,
    q: &Configuration<f64, CAP>,
    motions: [Tangent<f64, CAP>; 2],
    count: usize,
) -> Vec<f64> {
    let rows = &robot.bodies()[..count];
    let model = TableModel::<f64, N>::new(robot.base_kind(), *robot.base(), rows).unwrap();
    let [v, a] = motions.map(|mut x| {
        x.joints[count..].fill(0.0);
        Tangent {
            base: x.base,
            joints: first::<N>(&x.joints),
        }
    });
    let q = Configuration {
        base: q.base,
        joints: first::<N>(&q.joints),
    };
    let posture = Posture::new(&model, &q);
    let tau = rnea(&model, &posture, &v, &a);
    let mut mass = MassMatrix::ZERO;
    crba(&model, &posture, &mut mass);
    let mut ws = DerivativesWorkspace::new();
    let mut inverse_dynamics = RneaDerivatives::ZERO;
    rnea_derivatives(&model, &posture, &v, &a, &mut ws, &mut inverse_dynamics);
    let mut forward_dynamics = AbaDerivatives::ZERO;
    let mut aba_ws = AbaDerivativesWorkspace::new();
    aba_derivatives(
        &model,
        &posture,
        &v,
        &tau,
        &mut aba_ws,
        &mut forward_dynamics,
    );
    let mut by = CentroidalDerivatives::ZERO;
    centroidal_derivatives(&model, &posture, &v, &a, &mut ws, &mut by);
    let efforts = [tau, mass.mul(&a), inverse_dynamics.change(&v, &a, &v)];
    let rates = [
        aba(&model, &posture, &v, &tau, &mut AbaWorkspace::new()),
        aba_ws.factors().solve(&tau),
        forward_dynamics.change(&a, &v, &tau),
    ];
    let mut out = Vec::new();
    for i in 0..6 + count {
        out.extend(efforts.map(|x| x.coordinate(i)));
        out.extend(rates.map(|x| x.coordinate(i)));
    }
    for columns in [
        by.momentum_by_position,
        by.rate_by_position,
        by.rate_by_velocity,
        by.map,
    ] {
        let all = columns.base.iter().chain(&columns.joints[..count]);
        out.extend(all.flat_map(|c| c.to_array()));
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn mass_matrix_is_made_of_rnea_columns(model in model(), (q, [v, a]) in state()) {
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        let bias = rnea(&model, &posture, &v, &Tangent::ZERO);
        let full = rnea(&model, &posture, &v, &a);
        let product = m.mul(&a) + bias;
        for i in 0..6 + CAP {
            prop_assert!(close(product.coordinate(i), full.coordinate(i), size(&full)), "row {i}");
        }
    }

    #[test]
    fn aba_inverts_rnea(model in model(), (q, [v, a]) in state()) {
        let posture = Posture::new(&model, &q);
        let (v, a) = (masked(&model, v), masked(&model, a));
        let tau = rnea(&model, &posture, &v, &a);
        let mut ws = AbaWorkspace::new();
        let mut back = aba(&model, &posture, &v, &tau, &mut ws);
        if model.base_kind() == BaseKind::Fixed {
            back.base = Motion::ZERO;
        }
        // The acceleration is only as good as the condition of M allows: judge it by its effort.
        let again = rnea(&model, &posture, &v, &back);
        for i in 0..6 + CAP {
            let (x, y) = (again.coordinate(i), tau.coordinate(i));
            prop_assert!((x - y).abs() <= 1e-9 * size(&tau).max(1.0), "row {i}: {x} {y}");
        }
    }

    /// A joint that carries no inertia at all does not accelerate, whatever drives it, and disturbs nothing else.
    #[test]
    fn a_joint_that_carries_nothing_stays_and_disturbs_nothing(
        robot in model(), (q, [v, drive]) in state(), (idle, _) in body(), on_base in any::<bool>(),
    ) {
        let count = robot.joint_count();
        let mut idle = Body { mass: 0.0, first: [0.0; 3], second: [0.0; 6], rotor_inertia: 0.0, ..idle };
        idle.parent = if on_base { Link::Base } else { Link::Joint(count - 1) };
        let rows = [&robot.bodies()[..count], &[idle]].concat();
        let model = Model::new(robot.base_kind(), *robot.base(), &rows).unwrap();
        let [v, drive] = [v, drive].map(|x| masked(&model, x));
        let tau = Effort { base: Force::new(drive.base.linear, drive.base.angular), joints: drive.joints };
        let posture = Posture::new(&model, &q);
        let mut ws = AbaWorkspace::new();
        let (with, without) = (aba(&model, &posture, &v, &tau, &mut ws), {
            let (mut v, mut tau) = (v, tau);
            (v.joints[count], tau.joints[count]) = (0.0, 0.0);
            aba(&robot, &Posture::new(&robot, &q), &v, &tau, &mut AbaWorkspace::new())
        });
        prop_assert_eq!(with, without);
        prop_assert_eq!(mass_solve(&model, &posture, &tau, &mut ws).joints[count], 0.0);
        let mut forward_dynamics = AbaDerivatives::ZERO;
        aba_derivatives(&model, &posture, &v, &tau, &mut AbaDerivativesWorkspace::new(), &mut forward_dynamics);
        prop_assert_eq!(forward_dynamics.acceleration.joints[count], 0.0);
        prop_assert_eq!(forward_dynamics.change(&drive, &v, &tau).joints[count], 0.0);
    }

    #[test]
    fn jacobians_carry_velocity_and_force(
        model in model(), (q, [v, a]) in state(), link in 0..2 * CAP, rot in rotation(), arm in vector(0.3),
    ) {
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &posture, &mut kinematics);
        let mut motions = BodyMotions::ZERO;
        forward_accelerations(&model, &posture, &v, &masked(&model, a), &mut motions);
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let row = |i: usize| [rot.matrix()[(i, 0)], rot.matrix()[(i, 1)], rot.matrix()[(i, 2)]];
        let frame = Frame { link, offset: arm.into(), rotation: [row(0), row(1), row(2)] };
        let pose = kinematics.frame(&frame);
        for axes in [Axes::Local, Axes::LocalWorldAligned, Axes::World] {
            let mut jac = FrameJacobian::ZERO;
            frame_jacobian(&model, &kinematics, &frame, axes, &mut jac);
            let direct = axes.motion(&pose, &motions.frame_velocity(&frame));
            let through = jac.mul(&v);
            for (x, y) in direct.to_array().into_iter().zip(through.to_array()) {
                prop_assert!(close(x, y, 30.0), "{axes:?}: {x} {y}");
            }
            // Power of a wrench is the same on both sides.
            let wrench = Force::new(arm, pose.translation);
            prop_assert!(close(through.dot(&wrench), v.dot(&jac.tr_mul(&wrench)), 100.0));
        }
        // J ν̇ + J̇ν is the acceleration.
        let mut bias = BodyMotions::ZERO;
        bias_accelerations(&model, &posture, &v, &mut bias);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::Local, &mut jac);
        let sum = jac.mul(&masked(&model, a)) + bias.frame_acceleration(&frame);
        for (x, y) in motions.frame_acceleration(&frame).to_array().into_iter().zip(sum.to_array()) {
            prop_assert!(close(x, y, 1e3), "{x} {y}");
        }
    }

    /// A joint moves what its speed reaches, its own link and those it carries; and what the base and all joints do one by one
    /// adds up to what they do together.
    #[test]
    fn a_joint_moves_the_links_that_its_speed_reaches(model in model(), (q, [v, _]) in state()) {
        let v = masked(&model, v);
        let posture = Posture::new(&model, &q);
        let mut all = BodyMotions::ZERO;
        bias_accelerations(&model, &posture, &v, &mut all);
        let mut sums = [Motion::ZERO; CAP];
        for i in 0..6 + CAP {
            let mut alone = BodyMotions::ZERO;
            forward_velocities(&model, &posture, &Tangent::unit(i), &mut alone);
            for (sum, motion) in sums.iter_mut().zip(alone.velocities) {
                *sum += motion * v.coordinate(i);
            }
            let Some(joint) = i.checked_sub(6) else { continue };
            prop_assert_eq!(alone.base_velocity, Motion::ZERO);
            prop_assert!(!model.moves(joint, Link::Base));
            for (link, motion) in alone.velocities.iter().enumerate() {
                prop_assert_eq!(model.moves(joint, Link::Joint(link)), *motion != Motion::ZERO, "{} {}", joint, link);
            }
        }
        for (sum, together) in sums.iter().zip(all.velocities) {
            for (x, y) in sum.to_array().into_iter().zip(together.to_array()) {
                prop_assert!(close(x, y, 1e3), "{x} {y}");
            }
        }
    }

    /// To the bit: room to spare in a robot's table changes nothing, nor does a table that is full.
    #[test]
    fn room_to_spare_changes_nothing(robot in model(), (q, [v, a]) in state()) {
        let motions = [masked(&robot, v), masked(&robot, a)];
        for capacity in [3, 4, 14] {
            let count = robot.joint_count().min(capacity);
            let ample = answers::<CAP>(&robot, &q, motions, count);
            let tight = match capacity {
                3 => answers::<3>(&robot, &q, motions, count),
                4 => answers::<4>(&robot, &q, motions, count),
                _ => answers::<14>(&robot, &q, motions, count),
            };
            prop_assert_eq!(ample, tight, "{} of {}", count, capacity);
        }
    }

    /// A robot in single precision moves as it does in double precision, to all but the last digits of single precision.
    #[test]
    fn a_robot_in_single_precision_is_the_same(model in model(), (q, [v, a]) in state()) {
        let count = model.joint_count();
        let (v, a) = (masked(&model, v), masked(&model, a));
        let rows = bodies_f32(model.bodies());
        let single = TableModel::<f32, CAP>::new(model.base_kind(), model.base().to_f32(), &rows[..count]).unwrap();
        let tau = rnea(&model, &Posture::new(&model, &q), &v, &a);
        let vector = |x: Vector3<f64>| x.map(|x| x as f32);
        let motion = |x: Motion<f64>| Motion::new(vector(x.linear), vector(x.angular));
        let tangent = |x: Tangent<f64, CAP>| Tangent { base: motion(x.base), joints: x.joints.map(|x| x as f32) };
        let rotation = Rotation3::from_matrix_unchecked(q.base.rotation.matrix().map(|x| x as f32));
        let q = Configuration {
            base: Transform::new(rotation, vector(q.base.translation)),
            joints: q.joints.map(|x| x as f32),
        };
        let rounded = rnea(&single, &Posture::new(&single, &q), &tangent(v), &tangent(a));
        for i in 0..6 + CAP {
            let (x, y) = (tau.coordinate(i), f64::from(rounded.coordinate(i)));
            prop_assert!((x - y).abs() <= 1e-4 * size(&tau).max(1.0), "row {i}: {x} {y}");
        }
    }

    #[test]
    fn ends_of_limbs_are_frames_seen_from_the_base(
        model in model(), (q, [v, _]) in state(), link in 0..2 * CAP, arm in vector(0.3),
    ) {
        let v = masked(&model, v);
        let link = if link < model.joint_count() { Link::Joint(link) } else { Link::Base };
        let frame = Frame { link, offset: arm.into(), ..Frame::IDENTITY };
        let limbs = Limbs::new(&model, &q, &[frame]);
        let (end, rot_wb) = (&limbs.ends[0], &q.base.rotation);
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(&model, &Posture::new(&model, &q), &mut kinematics);
        let mut jac = FrameJacobian::ZERO;
        frame_jacobian(&model, &kinematics, &frame, Axes::LocalWorldAligned, &mut jac);
        let pos_w = q.base.point(&end.position);
        prop_assert!((pos_w - kinematics.frame(&frame).translation).norm() < 1e-12);
        let still = Tangent { base: Motion::ZERO, ..v };
        prop_assert!((rot_wb * end.mul(&v.joints) - jac.mul(&still).linear).norm() < 1e-10);
        let mut torques = v.joints;
        end.add_tr_mul(&(rot_wb.inverse() * arm), &mut torques);
        let through = jac.tr_mul(&Force::new(arm, nalgebra::Vector3::zeros()));
        for ((x, before), y) in torques.iter().zip(v.joints).zip(through.joints) {
            prop_assert!(close(*x, before + y, 10.0), "{x} {before} {y}");
        }
    }

    #[test]
    fn centroidal_quantities_agree(model in model(), (q, [v, a]) in state()) {
        let (v, a) = (masked(&model, v), masked(&model, a));
        let posture = Posture::new(&model, &q);
        let mut map = CentroidalMap::ZERO;
        centroidal_map(&model, &posture, &mut map);
        let state = centroidal_state(&model, &posture, &v);
        let scale = size(&Effort { base: state.momentum_w, joints: [0.0; CAP] });
        for (x, y) in map.momentum(&v).to_array().into_iter().zip(state.momentum_w.to_array()) {
            prop_assert!(close(x, y, scale), "momentum {x} {y}");
        }
        let mut jac = ComJacobian::ZERO;
        let com = com_jacobian(&model, &posture, &mut jac);
        prop_assert!((com.position_w - state.com_w).norm() < 1e-12);
        prop_assert!((map.com_w - state.com_w).norm() < 1e-12);
        prop_assert!((jac.mul(&v) - state.com_velocity_w).norm() < 1e-10);
        let mut m = MassMatrix::ZERO;
        crba(&model, &posture, &mut m);
        prop_assert!(close(m.kinetic_energy(&v), state.kinetic_energy, state.kinetic_energy));
        // The rate of momentum is the sum of external forces but gravity.
        let rate = centroidal_momentum_rate(&model, &posture, &v, &a);
        let bias = centroidal_bias(&model, &posture, &v) + map.momentum(&a);
        let tau = rnea(&model, &posture, &v, &a);
        // A fixed base stands in the world: its weight is the ground's, not the robot's.
        let ground = if model.base_kind() == BaseKind::Fixed { model.base().mass } else { 0.0 };
        let weight = (map.mass + ground) * 9.81;
        let force_w = posture.base().rotation * tau.base.linear;
        for (x, y) in rate.to_array().into_iter().zip(bias.to_array()) {
            prop_assert!(close(x, y, size(&tau)), "rate {x} {y}");
        }
        prop_assert!(close(rate.linear.z, force_w.z - weight, size(&tau)));
        let com = com_motion(&model, &posture, &v, &a);
        prop_assert!((com.position_w - state.com_w).norm() < 1e-12);
        prop_assert!((com.velocity_w - state.com_velocity_w).norm() < 1e-10);
        let acceleration = rate.linear / map.mass;
        let near = 1e-10 * acceleration.norm().max(1e3);
        prop_assert!((com.acceleration_w - acceleration).norm() < near, "{}", com.acceleration_w);
        prop_assert!(close(rate.linear.x, force_w.x, size(&tau)));
    }
}

#[test]
fn a_force_on_a_lone_base_obeys_newton() {
    let base = BaseBody {
        mass: 2.0,
        first: [0.0; 3],
        second: [0.01, 0.02, 0.03, 0.0, 0.0, 0.0],
    };
    let row = Body {
        mass: 1e-3,
        second: [1e-9, 1e-9, 1e-9, 0.0, 0.0, 0.0],
        ..Body::EMPTY
    };
    let model = Model::new(BaseKind::Floating, base, &[row]).unwrap();
    let posture = Posture::new(&model, &Configuration::NEUTRAL);
    let effort = Effort {
        base: Force::from_array([0.0, 0.0, 4.0, 0.0, 0.0, 0.0]),
        joints: [0.0; CAP],
    };
    let a = aba(
        &model,
        &posture,
        &Tangent::ZERO,
        &effort,
        &mut AbaWorkspace::new(),
    );
    assert!((a.base.linear.z - (4.0 / 2.001 - 9.81)).abs() < 1e-12);
}
